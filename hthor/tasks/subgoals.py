"""Kinds of task whose goal is a list of jobs, `Goal.jobs`.

The goal is met when every job is done (`hthor.tasks.jobs`). The least time is that of one person who knows all places
and does all jobs alone (`hthor.tasks.job_times`); a team can be faster.
"""

from abc import abstractmethod

import numpy as np
from numpy.typing import NDArray

from hthor.tasks import job_times
from hthor.tasks.jobs import is_done, jobs_left, why_impossible
from hthor.tasks.kind import LeastTimes, TaskKind
from hthor.types import Goal, HouseSpec, Placement, Snapshot, TaskSpec


class JobKind(TaskKind):
    """A kind whose goal is to do all jobs of a list, in any order. A subclass defines how a task is drawn.

    Progress is the share done of the jobs that were not done at the start; each job that was done at the start and has
    been undone subtracts one job, down to zero. The goal is met when no job is left.
    """

    @abstractmethod
    def draw(self, house: HouseSpec, root: int) -> tuple[Goal, tuple[Placement, ...]]: ...

    def goals(self, house: HouseSpec) -> tuple[Goal, ...]:
        """An example of the goals that can be drawn, if these depend on the objects."""
        return (self.draw(house, 0)[0],)

    def objection(self, goal: Goal, house: HouseSpec) -> str:
        if not goal.jobs:
            return f"has no jobs; a task of kind '{self.name}' is a list of them"
        first = goal.jobs[0]
        if (goal.target, goal.relation) != (first.target, first.relation):
            return f"target '{goal.target}' and relation '{goal.relation}' are not those of the first job"
        if len({job.target for job in goal.jobs}) < len(goal.jobs):
            return "has two jobs about the same object; one for each is allowed"
        return next(
            (f"jobs[{n}] {text}" for n, job in enumerate(goal.jobs) if (text := why_impossible(job, house))), ""
        )

    def met(self, task: TaskSpec, snapshot: Snapshot, house: HouseSpec) -> bool:
        return all(is_done(job, snapshot.things.get(job.target), house) for job in task.goal.jobs)

    def solved(self, goal: Goal, objects: tuple[Placement, ...], house: HouseSpec) -> bool:
        return not jobs_left(goal, objects, house)

    def progress(self, task: TaskSpec, snapshot: Snapshot, house: HouseSpec) -> float:
        first = len(jobs_left(task.goal, task.objects, house))
        now = sum(1 for job in task.goal.jobs if not is_done(job, snapshot.things.get(job.target), house))
        return max(0.0, (first - now) / first) if first else float(not now)

    def least_times(self, house: HouseSpec, objects: tuple[Placement, ...], goal: Goal) -> LeastTimes:
        return job_times.least_times(house, objects, jobs_left(goal, objects, house))

    def size_of(
        self, house: HouseSpec, objects: tuple[Placement, ...], goal: Goal, least: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """(N,) [s] The time of the longest job, for a body that stands next to its object: no team is faster."""
        there = {placement.id: placement for placement in objects}
        jobs = jobs_left(goal, objects, house)
        longest = max((job_times.carrying_time(house, there[job.target], job) for job in jobs), default=0.0)
        return np.full_like(least, longest)
