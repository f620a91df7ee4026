"""How much of a trial's goal is met, tick by tick."""

from collections.abc import Mapping

from hthor import rules
from hthor.tasks.kind import TaskKind
from hthor.types import HUMAN, Event, HouseSpec, Snapshot, TaskSpec, ThingState

_EVERY_TICKS = round(1.0 / rules.TICK_S)
"""Progress is computed at least this often."""


class GoalProgress:
    """The share of the goal that is met: ``value``, from 0 to 1, or None for task kinds that count no parts."""

    def __init__(self, kind: TaskKind, task: TaskSpec) -> None:
        counts = type(kind).progress is not TaskKind.progress
        self.value: float | None = 0.0 if counts else None
        self._kind, self._task, self._last = kind, task, round(task.time_limit / rules.TICK_S)
        self._things: Mapping[str, ThingState] | None = None

    def update(self, snapshot: Snapshot, house: HouseSpec, *, met: bool = False, has_events: bool) -> tuple[Event, ...]:
        """The event "progress" if the share changed.

        It is computed when an object changed, once a second, and at the end; not while an object is only carried.

        Args:
            met: the goal is met.
            has_events: something happened in this tick.
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
        return (Event(tick=snapshot.tick, seat=HUMAN, kind="progress", data={"value": share}),)
