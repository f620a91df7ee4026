"""The contract of a kind of task: its goals, its instruction, when it is done, and the least time that it takes.

One file in `hthor/tasks/kinds`, or a file of the user's, defines one kind as ``KIND``; the kind's name is the file's.
Task generation asks a kind for goals and least times, the episode whether the goal is met and how far it is.
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
    """The least time to meet a goal, as a function of where the person starts."""

    def __call__(self, starts: ArrayLike, /) -> NDArray[np.float64]:
        """(N,) least times [s] for ``starts`` (N, 2) [m], house frame; inf where the goal cannot be met from."""
        ...


class TaskKind(ABC):
    """A kind of task.

    Attributes:
        name: the name of the kind and of its file, such as "mobile_manipulation".
        short: stands for the kind in task ids, and is the name of its own suite where it has one.
        crew: names of the robots in a trial, unless the caller chooses others.
        time_limit: of its tasks [s].
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
        """The goals of this kind that make sense in the house, in a fixed order; empty when there are none."""

    @abstractmethod
    def objection(self, goal: Goal, house: HouseSpec) -> str:
        """Why the goal is not a valid one of this kind in the house, in words; empty when it is."""

    @abstractmethod
    def instruction(self, goal: Goal, objects: tuple[Placement, ...]) -> str:
        """The sentence that the person and the robots are given.

        Args:
            goal: what to do.
            objects: the arrangement at the start, with the goal's objects among them.
        """

    @abstractmethod
    def met(self, task: TaskSpec, snapshot: Snapshot, house: HouseSpec) -> bool:
        """Whether the goal is met; asked at every tick of a trial.

        Args:
            task: the task.
            snapshot: the true state of the world at one tick: poses and positions [m] in the house frame.
            house: the task's house.
        """

    @abstractmethod
    def solved(self, goal: Goal, objects: tuple[Placement, ...], house: HouseSpec) -> bool:
        """Whether an arrangement meets the goal before anybody has moved; such a task is not generated."""

    @abstractmethod
    def least_times(self, house: HouseSpec, objects: tuple[Placement, ...], goal: Goal) -> LeastTimes:
        """The least time to meet the goal from each start: a lower bound that nobody can beat.

        Args:
            house: the floor plan.
            objects: the arrangement at the start.
            goal: what to do.

        Returns:
            A function from starts (N, 2) [m] to times (N,) [s]; inf where the goal cannot be met from.
        """

    def draw(self, house: HouseSpec, root: int) -> tuple[Goal, tuple[Placement, ...]]:
        """A goal and an arrangement that does not meet it.

        By default one of `goals`, each equally likely, and the six targets spread by the scene priors.

        Args:
            house: the floor plan.
            root: of all random draws (`hthor.seeds`); equal roots must give equal results.

        Raises:
            HthorError: when the house has nothing for a task of this kind.
        """
        from hthor.tasks.arrangement.target_arrangement import arrange

        known = self.goals(house)
        if not known:
            raise HthorError(f"house '{house.id}' has nothing for a task of kind '{self.name}'")
        goal = known[seeds.choice([1.0] * len(known), root, "goal")]
        return goal, arrange(house, root, {goal.target: goal.destination})

    def misfit(self, task: TaskSpec, house: HouseSpec) -> str:  # noqa: ARG002 - most kinds accept any
        """Why a valid task is not worth giving, in words; empty when it is. Task generation then draws again."""
        return ""

    def progress(self, task: TaskSpec, snapshot: Snapshot, house: HouseSpec) -> float:
        """The share of the goal that is met at the snapshot's tick, 0 to 1; arguments as for `met`."""
        return float(self.met(task, snapshot, house))

    def t_star(self, task: TaskSpec, house: HouseSpec) -> float:
        """T* [s] of a task, rounded to a millisecond; inf when it cannot be done."""
        times = self.least_times(house, task.objects, task.goal)([(task.human_start.x, task.human_start.y)])
        return self.t_star_of(float(times[0]))

    def t_star_of(self, least: float) -> float:
        """T* [s] of a task that takes at least ``least`` [s], rounded to a millisecond; inf for inf."""
        return round(self.t_star_base + self.t_star_slowness * round(least, 3), 3) if math.isfinite(least) else math.inf

    def least(self, task: TaskSpec) -> float:
        """The least time [s] that a task's T* stands for."""
        return round((task.t_star - self.t_star_base) / self.t_star_slowness, 3)


def target_of(goal: Goal, objects: tuple[Placement, ...]) -> Placement:
    """Where the goal's target is placed."""
    return next(placement for placement in objects if placement.id == goal.target)


def kind_of(thing_id: str, house: HouseSpec) -> str:
    """The kind of the house's thing with this id, empty when there is none."""
    for thing in house.things if thing_id else ():  # asked at every tick of a trial
        if thing.id == thing_id:
            return thing.kind
    return ""
