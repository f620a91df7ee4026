"""Judges the goal of a trial by the true state of the world."""

from collections.abc import Mapping, Sequence

from msgspec import Struct

from hthor import plugins, rules
from hthor.episode.standstill import StandState, Standstill
from hthor.tasks.kind import TaskKind
from hthor.types import HUMAN, HouseSpec, Snapshot, TaskSpec, ThingState
from hthor.types.events import Event, Progress

_EVERY_TICKS = round(1.0 / rules.TICK_S)
"""[ticks] Progress is computed at least this often."""


class GoalState(Struct, frozen=True):
    """A copy of what a `GoalJudge` knows.

    ``current``: its progress is that of the world's present objects; ``last``: the last tick of the task; ``stand`` is
    the state of its `Standstill`, if the goal is met by standing still.
    """

    met: bool
    progress: float | None
    current: bool
    last: int
    stand: StandState = (None, 0)


class GoalJudge:
    """Whether the goal is met (``met``), and which share of it (``progress``).

    The share is from 0 to 1, and None for task kinds without partial goals. It is computed when an object changed, once
    a second, and at the end; not while an object is only carried.
    """

    def __init__(self, task: TaskSpec) -> None:
        self._kind: TaskKind = plugins.load("task kind", task.kind)
        self._task, self._last = task, 0
        self.met = False
        self.progress: float | None = None if type(self._kind).progress is TaskKind.progress else 0.0
        seat = self._kind.stopper(task.goal)
        self._stand = Standstill(seat, round(self._kind.stop_s / rules.TICK_S)) if seat else None
        self._things: Mapping[str, ThingState] | None = None

    def begin(self, snapshot: Snapshot, house: HouseSpec) -> tuple[Event, ...]:
        """Compute the progress before the first tick of the task; a goal is not met before something was done."""
        self._last = snapshot.tick + round(self._task.time_limit / rules.TICK_S)
        return self._update(snapshot, house, has_events=True) if self.progress is not None else ()

    def judge(self, snapshot: Snapshot, house: HouseSpec, *, has_events: bool) -> tuple[Event, ...]:
        """Judge the goal after a tick, but not before `begin`; the event "progress" if the share changed.

        Args:
            has_events: whether anything happened in this tick.
        """
        if not self._last:
            return ()
        self.met = self._kind.met(self._task, snapshot, house)
        if self._stand is not None:
            self._judge_stop(self._stand, snapshot)
        return self._update(snapshot, house, has_events=has_events) if self.progress is not None else ()

    def winner(self, snapshot: Snapshot, people: Sequence[str]) -> str:
        """Who met the goal: the person who has an object that was to be found in view, or who stopped at a place.

        The first person if nothing was to be found and nobody had to stop.
        """
        if self._stand is not None:
            return self._stand.seat
        wanted = {job.target for job in self._task.goal.todo if job.relation == "find"}
        return next((seat for seat in people if wanted & set(snapshot.in_view.get(seat, ()))), HUMAN)

    def _judge_stop(self, stand: Standstill, snapshot: Snapshot) -> None:
        """The goal is met only when the body that is in the right place has stood still for long enough."""
        if self.met:
            self.met = stand.lasts(snapshot)
        else:
            stand.leave()

    def _update(self, snapshot: Snapshot, house: HouseSpec, *, has_events: bool) -> tuple[Event, ...]:
        changed = snapshot.things is not self._things and (has_events or not any(snapshot.holding.values()))
        if not (self.met or changed or snapshot.tick % _EVERY_TICKS == 0 or snapshot.tick == self._last):
            return ()
        self._things = snapshot.things
        share = 1.0 if self.met else float(self._kind.progress(self._task, snapshot, house))
        share = round(min(1.0, max(0.0, share)), 4)
        if share == self.progress:
            return ()
        self.progress = share
        return (Progress(tick=snapshot.tick, seat=HUMAN, value=share),)

    def save_state(self, snapshot: Snapshot) -> GoalState:
        """A copy of what was judged; ``snapshot`` is that of the present tick."""
        stand = self._stand.state if self._stand is not None else (None, 0)
        return GoalState(self.met, self.progress, snapshot.things is self._things, self._last, stand)

    def load_state(self, state: GoalState, snapshot: Snapshot) -> None:
        """Continue from a copy, in a world with this snapshot."""
        self.met, self.progress, self._last = state.met, state.progress, state.last
        self._things = snapshot.things if state.current else None
        if self._stand is not None:
            self._stand.state = state.stand
