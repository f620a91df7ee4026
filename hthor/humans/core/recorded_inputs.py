"""Everything that a body was made to do in a trial: records it for the journal, and repeats the trial from it.

It is kept of people who drive, and of robots whose thinking takes time, which no log repeats by itself.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from msgspec import UNSET, Struct

from hthor.types import SUBTICKS, Action, Controls, Drive, Motion, Move, Observation, Rotate, Wait, merge_actions
from hthor.types.events import Acted, Event, Head, Inputs, JournalEntry, Shown, Stick

INPUT_UNIT = 1e-4
"""[m/s, rad] The unit of the set-points in the journal. Our choice: finer than any stick or headset measures."""
_BY_THE_EPISODE = (Stick, Head, Inputs, Acted)
"""Entries that the episode writes into journals by itself."""


class InputState(Struct, frozen=True, kw_only=True):
    """A copy of what an `InputRecorder` recorded."""

    inputs: tuple[int, ...]
    held: tuple[int, ...]
    acted: tuple[Acted, ...]


class InputRecorder:
    """Records what one body was made to do in one trial."""

    def __init__(self, seat: str) -> None:
        self.seat = seat
        self._inputs: list[int] = []
        self._held: list[int] = []  # the set-point that the body drives by
        self._acted: list[Acted] = []

    @property
    def drove(self) -> bool:
        """Whether the body drove at any time."""
        return bool(self._inputs)

    def motion(self, tick: int, step: int, motion: Motion) -> None:
        """Record a motion that begins after a step of a tick; only set-points are kept, as actions have the others."""
        if isinstance(motion, Drive):
            numbers = [round(value / INPUT_UNIT) for value in (motion.forward, motion.left, motion.yaw, motion.pitch)]
            if self._held != numbers:
                self._inputs += (tick, step, *numbers)
                self._held = numbers
        elif isinstance(motion, (Move, Rotate, Wait)):
            self._held = []

    def action(self, acted: Acted) -> None:
        """Record an action; one in the same step as the one before it counts together with that."""
        before = self._acted[-1] if self._acted else None
        if before is not None and (before.tick, before.early) == (acted.tick, acted.early):
            self._acted[-1] = merge_actions(before, acted)
        else:
            self._acted.append(acted)

    def entries(self) -> Iterator[Inputs | Acted]:
        """The entries for the journal.

        Actions that are mere set-points are left out, as `Inputs` has them, unless one replaced another motion.
        """
        if self._inputs:
            yield Inputs(tick=0, seat=self.seat, runs=tuple(self._inputs))
        of_tick = Counter(acted.tick for acted in self._acted)
        for acted in self._acted:
            timely = acted.seen is UNSET or acted.seen == acted.tick
            silent = acted.say is None and not acted.signals
            if not (isinstance(acted.motion, Drive) and timely and silent and of_tick[acted.tick] == 1):
                yield acted

    def save_state(self) -> InputState:
        """A copy of what was recorded."""
        return InputState(inputs=tuple(self._inputs), held=tuple(self._held), acted=tuple(self._acted))

    def load_state(self, state: InputState) -> None:
        """Continue from a copy."""
        self._inputs, self._held, self._acted = list(state.inputs), list(state.held), list(state.acted)


class RecordedInputs:
    """The inputs of one seat in one logged trial, which `frame` repeats.

    Args:
        seat: the seat. events, journal, ticks: the trial's, as in `hthor.episode.EpisodeLog`.

    Attributes:
        found: whether the journal has any inputs of the seat.
        own_journal: the entries of the seat that were not recorded by the episode itself.
    """

    def __init__(self, seat: str, events: Sequence[Event], journal: Sequence[JournalEntry], ticks: int) -> None:
        own = [entry for entry in journal if entry.seat == seat]
        inputs = [entry for entry in own if isinstance(entry, Inputs)]
        actions = [entry for entry in own if isinstance(entry, Acted)]
        self.found = bool(inputs or actions)
        self.own_journal = tuple(entry for entry in own if not isinstance(entry, _BY_THE_EPISODE))
        self._ticks = ticks
        self._steering = _steering(inputs)
        self._actions: dict[int, list[Acted]] = {}  # by the number of the step, of all steps of the trial
        for entry in actions:
            self._actions.setdefault(SUBTICKS * entry.tick - entry.early, []).append(entry)
        shown = {event.tick for event in events if isinstance(event, Shown) and event.seat == seat}
        self._observed = shown | {entry.seen for entry in actions if isinstance(entry.seen, int)}
        self._seen: dict[int, Observation] = {}

    def frame(self, controls: Controls) -> None:
        """Do what was done in this step; after the end of the log, stand still."""
        tick, step = controls.tick, controls.step
        if tick >= self._ticks:
            if (tick, step) == (self._ticks, 0):
                controls.submit(Action(motion=Wait()))
            return
        if step == 0 and tick in self._observed:
            self._seen[tick] = controls.observe()
        for acted in self._actions.get(SUBTICKS * tick + step, ()):
            action = Action(motion=acted.motion, say=acted.say, signals=acted.signals)
            controls.submit(action, self._seen[acted.seen] if isinstance(acted.seen, int) else None)
        for drive in self._steering.get((tick, step), ()):
            controls.steer(drive)


def _steering(inputs: Iterable[Inputs]) -> dict[tuple[int, int], list[Drive]]:
    """The set-points by tick and step; an entry has groups of six numbers."""
    steering: dict[tuple[int, int], list[Drive]] = {}
    for entry in inputs:
        for first in range(0, len(entry.runs), 6):
            tick, step, *numbers = entry.runs[first : first + 6]
            forward, left, yaw, pitch = (number * INPUT_UNIT for number in numbers)
            steering.setdefault((tick, step), []).append(Drive(forward=forward, left=left, yaw=yaw, pitch=pitch))
    return steering
