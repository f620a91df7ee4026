"""Repeats the inputs in a journal, step by step: those of a person who drives, or of a robot in real time."""

from collections.abc import Iterable, Sequence

from hthor.humans.core.behaviour_log import INPUT_UNIT
from hthor.types import SUBTICKS, Action, Controls, Drive, Observation, Wait
from hthor.types.events import Acted, Event, Head, Inputs, JournalEntry, Shown, Stick

_OF_RECORDER = (Stick, Head, Inputs, Acted)
"""Entries that the episode writes into journals by itself."""


class RecordedInputs:
    """The inputs of one seat in one logged trial.

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
        self.own_journal = tuple(entry for entry in own if not isinstance(entry, _OF_RECORDER))
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
