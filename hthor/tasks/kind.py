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
from hthor.types import Goal, HouseSpec, Placement, Snapshot, TaskSpec

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
        t_star_base, t_star_slowness: T* is ``t_star_base`` [s] plus ``t_star_slowness`` times the least time; by
            default the least time itself.
    """

    name: str
    short: str
    crew: tuple[str, ...] = ("scout",)
    time_limit: float = rules.TIME_LIMIT_S
    t_star_base: float = 0.0
    t_star_slowness: float = 1.0

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
