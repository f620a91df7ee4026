"""The contract of a kind of task: its goals, its instruction, when it is done, and its least time.

One file in `hthor/tasks/kinds`, or a user's file, defines one kind as ``KIND``; the kind's name is the file's name.
Task generation asks a kind for goals and least times; the episode asks for progress, and whether the goal is met.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Protocol

from hthor import rules, seeds
from hthor.errors import HthorError
from hthor.types import Goal, HouseSpec, Phase, Placement, Snapshot, TaskSpec

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


class LeastTimes(Protocol):
    """The least time to meet a goal, as a function of the person's start."""

    def __call__(self, starts: ArrayLike, /) -> NDArray[np.float64]:
        """(N,) least times [s] for ``starts`` (N, 2) [m], house frame; inf for a start from which it is impossible."""
        ...


class TaskKind(ABC):
    """A kind of task.

    Attributes:
        name: the name of the kind and of its file, such as "mobile_manipulation".
        short: the kind's name in task ids, and the name of its suite if it has one.
        crew: names of the robots in a trial, unless the caller chooses other robots.
        time_limit: time limit of its tasks [s].
        intended_s: the sizes (`size_of`) intended for the easiest and the hardest task of a house [s]; a small house
            does not reach the latter.
        stop_s: how long whoever meets the goal has to stand still [s]; 0 if the goal is met at once.
        t_star_base, t_star_slowness: T* is ``t_star_base`` [s] plus ``t_star_slowness`` times the least time; by
            default the least time itself.
        medium_from, hard_from: scores (`hthor.tasks.generation.difficulty`) at which medium and hard tasks begin, so
            that each stratum has about a third of the kind's tasks.
    """

    name: str
    short: str
    crew: tuple[str, ...] = ("scout",)
    time_limit: float = rules.TIME_LIMIT_S
    intended_s: tuple[float, float] = (4.0, 20.5)
    stop_s: float = 0.0
    t_star_base: float = 0.0
    t_star_slowness: float = 1.0
    medium_from: float = 22.0
    hard_from: float = 29.0

    @abstractmethod
    def goals(self, house: HouseSpec) -> tuple[Goal, ...]:
        """The goals of this kind that are possible in the house, in a fixed order; empty when there are none."""

    @abstractmethod
    def objection(self, goal: Goal, house: HouseSpec) -> str:
        """Why the goal is not a valid goal of this kind in the house, in words; empty when it is valid."""

    @abstractmethod
    def instruction(self, goal: Goal, objects: tuple[Placement, ...]) -> str:
        """The sentence that tells the person and the robots the goal.

        Args:
            goal: what to do.
            objects: the arrangement at the start, including the goal's objects.
        """

    @abstractmethod
    def met(self, task: TaskSpec, snapshot: Snapshot, house: HouseSpec) -> bool:
        """Whether the goal is met; called at every tick of a trial.

        Args:
            task: the task.
            snapshot: the true state of the world at one tick: poses and positions [m] in the house frame.
            house: the task's house.
        """

    @abstractmethod
    def solved(self, goal: Goal, objects: tuple[Placement, ...], house: HouseSpec) -> bool:
        """Whether the arrangement at the start already meets the goal; such a task is not generated."""

    @abstractmethod
    def least_times(self, house: HouseSpec, objects: tuple[Placement, ...], goal: Goal) -> LeastTimes:
        """The least time to meet the goal from each start: a lower bound for every person and team.

        Args:
            house: the floor plan.
            objects: the arrangement at the start.
            goal: what to do.

        Returns:
            A function from starts (N, 2) [m] to times (N,) [s]; inf for a start from which it is impossible.
        """

    def draw(self, house: HouseSpec, root: int) -> tuple[Goal, tuple[Placement, ...]]:
        """A goal and an arrangement that does not meet it.

        By default, one of `goals`, all equally likely, and the six targets placed by the scene priors.

        Args:
            house: the floor plan.
            root: of all random draws (`hthor.seeds`); equal roots must give equal results.

        Raises:
            HthorError: when no task of this kind is possible in the house.
        """
        from hthor.tasks.arrangement.target_arrangement import arrange

        known = self.goals(house)
        if not known:
            raise HthorError(f"house '{house.id}' has nothing for a task of kind '{self.name}'")
        goal = known[seeds.choice([1.0] * len(known), root, "goal")]
        return goal, arrange(house, root, {goal.target: goal.destination})

    def phases(self, task: TaskSpec, house: HouseSpec, root: int) -> tuple[Phase, ...]:  # noqa: ARG002
        """What comes before a task of this kind, such as a tour of the house before things are moved; by default
        nothing.

        Args:
            task: the task as drawn, without phases. house: its house.
            root: of all random draws, the one that `draw` got.
        """
        return ()

    def told_goal(self, task: TaskSpec) -> Goal:
        """The goal as people and robots are told it, by default all of it.

        A job that they have to remember from an earlier phase has the relation "back", and neither destinations nor a
        place.
        """
        return task.goal

    def completed(self, task: TaskSpec, house: HouseSpec) -> TaskSpec:  # noqa: ARG002 - most kinds add nothing
        """A drawn task with what depends on its start poses, such as an instruction that describes the way."""
        return task

    def stopper(self, goal: Goal) -> str:  # noqa: ARG002 - the same for most goals
        """The seat that has to stand still for `stop_s` where `met` holds; empty for none."""
        return ""

    def doubt(self, task: TaskSpec, house: HouseSpec) -> float:  # noqa: ARG002 - only of kinds without objects
        """For a task that is not about objects: the share [0, 1] of wrong ways that somebody may take first."""
        return 0.0

    def size_of(
        self,
        house: HouseSpec,  # noqa: ARG002 - most kinds need only the least times
        objects: tuple[Placement, ...],  # noqa: ARG002
        goal: Goal,  # noqa: ARG002
        least: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """(N,) [s] The size of a task, by default its least time; generation draws tasks of different sizes.

        Args:
            least: (N,) least times [s] of the task from N starts.
        """
        return least

    def misfit(self, task: TaskSpec, house: HouseSpec) -> str:  # noqa: ARG002 - most kinds accept any
        """Why a valid task is still unsuitable, in words; empty when it is suitable. If not, generation draws again."""
        return ""

    def progress(self, task: TaskSpec, snapshot: Snapshot, house: HouseSpec) -> float:
        """The share of the goal that is met at the snapshot's tick, 0 to 1; arguments as for `met`."""
        return float(self.met(task, snapshot, house))

    def t_star(self, task: TaskSpec, house: HouseSpec) -> float:
        """T* [s] of a task, rounded to a millisecond; inf when it cannot be done.

        Of several people whose starts the task states, the one who needs the least time counts.
        """
        starts = [(pose.x, pose.y) for pose in (task.human_start, *task.other_human_starts)]
        return self.t_star_of(float(self.least_times(house, task.objects, task.goal)(starts).min()))

    def t_star_of(self, least: float) -> float:
        """T* [s] of a task that takes at least ``least`` [s], rounded to a millisecond; inf for inf."""
        return round(self.t_star_base + self.t_star_slowness * round(least, 3), 3) if math.isfinite(least) else math.inf

    def least(self, task: TaskSpec) -> float:
        """The least time [s] that a task's T* was computed from."""
        return round((task.t_star - self.t_star_base) / self.t_star_slowness, 3)


def target_of(goal: Goal, objects: tuple[Placement, ...]) -> Placement:
    """The placement of the goal's target."""
    return next(placement for placement in objects if placement.id == goal.target)


def kind_of(thing_id: str, house: HouseSpec) -> str:
    """The kind of the house's thing with this id, empty when there is no such thing."""
    for thing in house.things if thing_id else ():  # called at every tick of a trial
        if thing.id == thing_id:
            return thing.kind
    return ""
