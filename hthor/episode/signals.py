"""What becomes of the signals of the seats."""

from collections.abc import Sequence

from hthor.comms.display import Displays
from hthor.episode.phases import PhaseClock
from hthor.episode.predictions import predicted
from hthor.types import Predict, Ready, Signal
from hthor.types.events import Event, Refused, SaidReady


class SignalReceiver:
    """Takes the seats' signals of one trial; one that is not possible is refused.

    Attributes:
        displays: what the people's displays show; it follows from the trial's ``events``.
    """

    def __init__(self, people: Sequence[str], events: Sequence[Event], phases: PhaseClock) -> None:
        self.displays = Displays(people, events)
        self._people, self._phases = tuple(people), phases
        self._predicted: dict[str, int] = {}  # the tick of each seat's last prediction

    def receive(self, tick: int, seat: str, signal: Signal) -> Sequence[Event]:
        """The events that a signal causes at ``tick``."""
        if isinstance(signal, Predict):
            return (self._predict(tick, seat, signal),)
        if isinstance(signal, Ready):
            return self._ready(tick, seat)
        return self.displays.show(tick, seat, signal)

    def _predict(self, tick: int, seat: str, signal: Predict) -> Event:
        """One prediction in a tick is enough, and keeps logs small."""
        if self._predicted.get(seat) == tick:
            return Refused(tick=tick, seat=seat, reason="only one prediction is taken in a tick")
        self._predicted[seat] = tick
        return predicted(tick, seat, signal, self._people)

    def _ready(self, tick: int, seat: str) -> Sequence[Event]:
        if self._phases.now is None:
            return (Refused(tick=tick, seat=seat, reason="this task has no further phase"),)
        return (SaidReady(tick=tick, seat=seat),) if self._phases.sign(seat) else ()
