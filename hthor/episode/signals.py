"""What becomes of the signals of the seats."""

import math
from collections.abc import Sequence

from hthor.comms.display import Displays
from hthor.episode.phases import PhaseClock
from hthor.episode.predictions import predicted
from hthor.types import Adapt, Predict, Ready, Signal
from hthor.types.events import Adapted, Event, Refused, SaidReady

_DIGITS = 6


class SignalReceiver:
    """Takes the seats' signals of one trial; one that is not possible is refused.

    Attributes:
        displays: what the people's displays show; it follows from the trial's ``events``.
    """

    def __init__(self, people: Sequence[str], events: Sequence[Event], phases: PhaseClock) -> None:
        self.displays = Displays(people, events)
        self._people, self._phases = tuple(people), phases
        self._predicted: dict[str, int] = {}  # the tick of each seat's last prediction
        self._adapted: dict[str, int] = {}

    def receive(self, tick: int, seat: str, signal: Signal) -> Sequence[Event]:
        """The events that a signal causes at ``tick``."""
        if isinstance(signal, Predict):
            return (self._predict(tick, seat, signal),)
        if isinstance(signal, Adapt):
            return (self._adapt(tick, seat, signal),)
        if isinstance(signal, Ready):
            return self._ready(tick, seat)
        return self.displays.show(tick, seat, signal)

    def _predict(self, tick: int, seat: str, signal: Predict) -> Event:
        """One prediction in a tick is enough, and keeps logs small."""
        if self._predicted.get(seat) == tick:
            return Refused(tick=tick, seat=seat, reason="only one prediction is taken in a tick")
        self._predicted[seat] = tick
        return predicted(tick, seat, signal, self._people)

    def _adapt(self, tick: int, seat: str, signal: Adapt) -> Event:
        if seat in self._people:
            return Refused(tick=tick, seat=seat, reason="only robots tell that they have adapted")
        if self._adapted.get(seat) == tick:
            return Refused(tick=tick, seat=seat, reason="only one adaptation is taken in a tick")
        if not 0.0 <= signal.divergence < math.inf:
            return Refused(tick=tick, seat=seat, reason="an adaptation's divergence is a number from 0 on")
        self._adapted[seat] = tick
        return Adapted(tick=tick, seat=seat, divergence=round(signal.divergence, _DIGITS))

    def _ready(self, tick: int, seat: str) -> Sequence[Event]:
        if self._phases.now is None:
            return (Refused(tick=tick, seat=seat, reason="this task has no further phase"),)
        return (SaidReady(tick=tick, seat=seat),) if self._phases.sign(seat) else ()
