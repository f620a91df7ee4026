"""The share of a goal that is met, as a trial goes on."""

from collections.abc import Mapping

from hthor import rules
from hthor.tasks.kind import TaskKind
from hthor.types import HUMAN, HouseSpec, Snapshot, TaskSpec, ThingState
from hthor.types.events import Event, Progress

_EVERY_TICKS = round(1.0 / rules.TICK_S)
"""[ticks] Progress is computed at least this often."""


class GoalProgress:
    """The share of the goal that is met: ``value``, from 0 to 1, or None for task kinds without partial goals."""

    def __init__(self, kind: TaskKind, task: TaskSpec) -> None:
        counts = type(kind).progress is not TaskKind.progress
        self.value: float | None = 0.0 if counts else None
        self._kind, self._task, self._last = kind, task, round(task.time_limit / rules.TICK_S)
        self._things: Mapping[str, ThingState] | None = None

    def update(self, snapshot: Snapshot, house: HouseSpec, *, met: bool = False, has_events: bool) -> tuple[Event, ...]:
        """The event "progress" if the share changed.

        It is computed when an object changed, once a second, and at the end; not while an object is only carried.

        Args:
            met: whether the goal is met.
            has_events: whether anything happened in this tick.
        """
        changed = snapshot.things is not self._things and (has_events or not any(snapshot.holding.values()))
        due = met or changed or snapshot.tick % _EVERY_TICKS == 0 or snapshot.tick == self._last
        if self.value is None or not due:
            return ()
        self._things = snapshot.things
        share = 1.0 if met else round(min(1.0, max(0.0, float(self._kind.progress(self._task, snapshot, house)))), 4)
        if share == self.value:
            return ()
        self.value = share
        return (Progress(tick=snapshot.tick, seat=HUMAN, value=share),)

    def save_state(self, snapshot: Snapshot) -> tuple[float | None, bool]:
        """The share, and whether it is that of the snapshot's objects."""
        return self.value, snapshot.things is self._things

    def load_state(self, state: tuple[float | None, bool], snapshot: Snapshot) -> None:
        """Continue from a saved state, in a world with this snapshot."""
        self.value, current = state
        self._things = snapshot.things if current else None
