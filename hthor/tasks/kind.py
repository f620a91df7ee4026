"""What a kind of task is: how it is told, when it is done, and the least time it takes."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from hthor import rules, seeds
from hthor.errors import HthorError
from hthor.types import Goal, HouseSpec, Placement, Snapshot, TaskSpec

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

LeastTimes = Callable[[Any], "NDArray[np.float64]"]
"""Maps starts (N, 2) [m] to least times (N,) [s]; inf where the goal cannot be met from."""


class TaskKind(ABC):
    """A kind of task. One file in ``hthor/tasks/kinds`` defines one as ``KIND``; its name is the file's.

    ``short`` is the word that stands for it in the ids of tasks, and names its own suite where it has one. ``crew``
    names the robots' bodies that a trial has unless its caller says otherwise; ``time_limit`` [s] is its tasks'.
    T* is ``t_star_base`` [s] and ``t_star_slowness`` times the least time; unless a kind says otherwise, just that.
    """

    name: str
    short: str
    crew: tuple[str, ...] = ("scout",)
    time_limit: float = rules.TIME_LIMIT_S
    t_star_base: float = 0.0
    t_star_slowness: float = 1.0

    @abstractmethod
    def goals(self, house: HouseSpec) -> tuple[Goal, ...]:
        """Every goal of the benchmark that makes sense in the house, in a fixed order."""

    @abstractmethod
    def objection(self, goal: Goal, house: HouseSpec) -> str:
        """What is wrong with a goal of this kind in the house, in words; empty when nothing is."""

    @abstractmethod
    def instruction(self, goal: Goal, objects: tuple[Placement, ...]) -> str:
        """The sentence that the person and the robots are given."""

    @abstractmethod
    def met(self, task: TaskSpec, snapshot: Snapshot, house: HouseSpec) -> bool:
        """Whether the goal is met at the snapshot's tick; ``house`` is the task's, loaded by its name when absent."""

    @abstractmethod
    def solved(self, goal: Goal, objects: tuple[Placement, ...], house: HouseSpec) -> bool:
        """Whether the arrangement meets the goal before anybody has moved."""

    @abstractmethod
    def least_times(self, house: HouseSpec, objects: tuple[Placement, ...], goal: Goal) -> LeastTimes:
        """The least time as a function of where the person starts: nobody can be faster."""

    def draw(self, house: HouseSpec, root: int) -> tuple[Goal, tuple[Placement, ...]]:
        """A goal and an arrangement that does not meet it, drawn from ``root``.

        Raises:
            HthorError: when the house has nothing for a task of this kind.
        """
        from hthor.tasks.arrangement.target_arrangement import arrange

        known = self.goals(house)
        if not known:
            raise HthorError(f"house '{house.id}' has nothing for a task of kind '{self.name}'")
        goal = known[seeds.choice([1.0] * len(known), root, "goal")]
        return goal, arrange(house, root, {goal.target: goal.destination})

    def misfit(self, task: TaskSpec, house: HouseSpec) -> str:  # noqa: ARG002 - most kinds take any
        """Why a task that can be run is not worth giving, in words, or nothing; a suite's maker then draws again."""
        return ""

    def progress(self, task: TaskSpec, snapshot: Snapshot, house: HouseSpec) -> float:
        """The share of the goal that is met at the snapshot's tick, from 0 to 1."""
        return float(self.met(task, snapshot, house))

    def t_star(self, task: TaskSpec, house: HouseSpec) -> float:
        """T* [s] of a task, rounded to a millisecond; inf when it cannot be done."""
        times = self.least_times(house, task.objects, task.goal)([(task.human_start.x, task.human_start.y)])
        return self.judged(float(times[0]))

    def judged(self, least: float) -> float:
        """T* [s] of a task that takes at least ``least`` [s], rounded to a millisecond."""
        return round(self.t_star_base + self.t_star_slowness * round(least, 3), 3) if math.isfinite(least) else math.inf

    def least(self, task: TaskSpec) -> float:
        """The least time [s] that a task's T* stands for."""
        return round((task.t_star - self.t_star_base) / self.t_star_slowness, 3)
