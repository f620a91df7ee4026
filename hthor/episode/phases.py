"""The phases of a trial: which one it is in, who is ready for the next, and how the scene changes between two."""

import math
from collections.abc import Sequence

import msgspec
from msgspec import Struct

from hthor import rules
from hthor.episode.goal_judge import GoalJudge
from hthor.episode.recording.rest_time import RestTime
from hthor.episode.trial_world import TrialWorld
from hthor.types import HUMAN, Phase, TaskSpec
from hthor.types.events import Event, PhaseBegan


class PhaseState(Struct, frozen=True):
    """A copy of what a `PhaseClock` knows."""

    number: int
    began: int
    ready: tuple[str, ...]


class PhaseClock:
    """The phases of one trial. In a task without phases, the task itself begins at tick 0.

    Phases change only at ticks whose poses are logged, so that a log can be cut between two phases.

    Args:
        task: the task with its phases. goal, rest: what counts from the beginning of the task itself.

    Attributes:
        number: how many phases are over. began: the tick at which the present phase began.
        now: the present phase; None in the task itself. name: its name; empty in the task itself.
        ready: the seats that are ready for the next phase.
        end: the tick at which the trial's time is over; infinite before the task itself.
    """

    def __init__(self, task: TaskSpec, goal: GoalJudge, rest: RestTime) -> None:
        self._task, self._goal, self._rest = task, goal, rest
        self.ready: tuple[str, ...] = ()
        self.load_state(PhaseState(0, 0, ()))

    @property
    def arrangement(self) -> TaskSpec:
        """The task with the objects of the present phase."""
        return self._task if self.now is None else msgspec.structs.replace(self._task, objects=self.now.objects)

    def begin(self, world: TrialWorld) -> list[Event]:
        """The events at the beginning of a phase; in the task itself, counting and judging begin."""
        events: list[Event] = []
        if self._task.phases:
            events.append(PhaseBegan(tick=world.tick, seat=HUMAN, name=self.name))
        if self.now is None:
            self._rest.restart(world.tick)
            events += self._goal.begin(world.snapshot(), world.house)
        return events

    def advance(self, world: TrialWorld, seats: Sequence[str]) -> Sequence[Event]:
        """Begin the next phase if the present one is over: its time is, or all ``seats`` are ready; the events."""
        before, tick = self.now, world.tick
        if before is None or tick % rules.LOG_EVERY_TICKS:
            return ()
        if tick < self.began + round(before.time_limit / rules.TICK_S) and not set(seats) <= set(self.ready):
            return ()
        self.load_state(PhaseState(self.number + 1, tick, ()))
        if before.restarts:
            world.restart(self.arrangement)
        else:
            world.rearrange(before.objects, self.arrangement.objects)
        return self.begin(world)

    def sign(self, seat: str) -> bool:
        """Note that a seat is ready; returns whether that is news."""
        if seat in self.ready:
            return False
        self.ready = (*self.ready, seat)
        return True

    def save_state(self) -> PhaseState:
        """A copy of what is known."""
        return PhaseState(self.number, self.began, self.ready)

    def load_state(self, state: PhaseState) -> None:
        """Continue from a copy."""
        self.number, self.began, self.ready = state.number, state.began, state.ready
        phases = self._task.phases
        self.now: Phase | None = phases[self.number] if self.number < len(phases) else None
        self.name = "" if self.now is None else self.now.name
        limit = round(self._task.time_limit / rules.TICK_S)
        self.end: float = self.began + limit if self.now is None else math.inf
