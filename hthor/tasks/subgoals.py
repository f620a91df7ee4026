"""Kinds of task whose goal is a list of jobs, `Goal.jobs`: when a job is done, and the least time.

A job is done when its object is in nobody's hands and rests at one of its ``destinations``: on or in the thing with
that id, on or in a thing of that kind, or in the room with that id. If the job has an exact ``place``, the object must
also lie within `PLACE_M` of it on the plan, or within `TOGETHER_M` for an object that several bodies carry.

T* of a team is a lower bound for every team, whatever its robots and their starts: the time of the longest job, done by
a body that already stands next to its object, while others do the other jobs. It is a walk at `rules.PACE_M_S` along
the shortest path of the avatar from a cell within the avatar's reach of the object to a cell within reach of the
nearest destination, less the slack of the grid, plus `rules.HANDLING_S` each to pick, to place, and to open a closed
thing that contains the object. Bodies that carry together walk at `rules.HANDLE_PACE` of that pace. If the person
cannot walk to every object from the start, T* is infinite.
"""

import functools
import math
from abc import abstractmethod
from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hthor import catalog, rules
from hthor.geometry import plane
from hthor.tasks.arrangement.reachability import REACH_M, SLACK_M, Bools, ReachableFloor, Walk
from hthor.tasks.kind import LeastTimes, TaskKind, kind_of
from hthor.types import Goal, HouseSpec, Job, Placement, Snapshot, TaskSpec, Thing, ThingState, Vec2, Vec3

PLACE_M = 0.30
"""How far an object may lie from its exact place. A hand puts things on the free spot nearest to the intended one, and
a person remembers a spot to within about 0.1 m; but the other end of the same table does not count."""
TOGETHER_M = 0.75
"""The same for an object that several carry: it follows its leader like a trailer, and is put down where it is."""


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
        ground = ReachableFloor.of(house)
        there = {placement.id: placement for placement in objects}
        todo = jobs_left(goal, objects, house)
        longest = max((carrying_time(house, there[job.target], job) for job in todo), default=0.0)
        walks = [ground.walk([ground.touching(there[job.target])]) for job in todo]

        def times(starts: ArrayLike) -> NDArray[np.float64]:
            places = np.asarray(starts, dtype=float).reshape(-1, 2)
            reached = np.all([np.isfinite(walk.lengths(places)) for walk in walks], axis=0)
            return np.where(reached, longest, np.inf)

        return times


def is_done(job: Job, state: ThingState | None, house: HouseSpec) -> bool:
    """Whether the object rests at its destination, in nobody's hands; a search is never done."""
    if state is None or state.held_by or state.bearers or job.relation == "find":
        return False
    spare = TOGETHER_M if job.hands > 1 else PLACE_M
    if job.place is not None and math.dist(state.position[:2], job.place[:2]) > spare:
        return False
    if not job.destinations:
        return job.place is not None
    if job.relation == "at":
        rooms = [room for room in house.rooms if room.id in job.destinations]
        return any(plane.inside(state.position[:2], room.polygon) for room in rooms)
    return state.support in job.destinations or kind_of(state.support, house) in job.destinations


def jobs_left(goal: Goal, objects: tuple[Placement, ...], house: HouseSpec) -> tuple[Job, ...]:
    """The jobs that are not done in the arrangement."""
    lying = {
        one.id: ThingState(id=one.id, kind=one.kind, position=one.position, support=one.support) for one in objects
    }
    return tuple(job for job in goal.todo if not is_done(job, lying.get(job.target), house))


def max_bearers(destinations: Collection[str], house: HouseSpec) -> tuple[Thing, ...]:
    """The things of the house with these ids, or of these kinds."""
    wanted = frozenset(destinations)
    return tuple(thing for thing in house.things if thing.id in wanted or thing.kind in wanted)


def why_impossible(job: Job, house: HouseSpec) -> str:
    """Why the job cannot be done by any arrangement in the house; empty when it can be."""
    rooms = {room.id: room for room in house.rooms}
    if job.relation == "at":
        valid = set(rooms)
    else:
        things = [thing for thing in house.things if catalog.kind(thing.kind).receptacle]
        valid = {thing.id for thing in things} | {thing.kind for thing in things}
    # One destination has to be in the house; the others may be kinds that it lacks.
    if job.destinations and not valid.intersection(job.destinations):
        return f"has destinations {', '.join(job.destinations)}; the house has {', '.join(sorted(valid))}"
    if job.place is not None and not any(plane.inside(job.place[:2], room.polygon) for room in house.rooms):
        return f"has a place in no room: {job.place}"
    if not job.destinations and job.place is None and job.relation != "find":
        return "has neither destinations nor a place"
    return ""


def carrying_time(house: HouseSpec, placement: Placement, job: Job) -> float:
    """The least time [s] of one job for a body that stands next to the object; inf when it cannot be done."""
    lying = next((thing for thing in house.things if thing.id == placement.support), None)
    shut = placement.relation == "in" and lying is not None and catalog.kind(lying.kind).hides
    way, pace = carrying_way(house, placement, job), rules.PACE_M_S
    if job.hands > 1:  # by a handle, from farther away; and it may stop short of the place
        way -= catalog.kind(placement.kind).size[0] + TOGETHER_M
        pace *= rules.HANDLE_PACE
    return max(way, 0.0) / pace + (2 + shut) * rules.HANDLING_S


def carrying_way(house: HouseSpec, placement: Placement, job: Job) -> float:
    """The least way [m], less the grid's slack, from within reach of the object to a place to put it down."""
    ground = ReachableFloor.of(house)
    near, (ends, walk) = ground.touching(placement), _way(house, job.relation, job.destinations, job.place)
    if not (near.any() and ends.any()):
        return math.inf
    if (near & ends).any():
        return 0.0
    lengths = walk.lengths(ground.space.centres(_edge(near)))
    return max(float(lengths.min()) - SLACK_M, 0.0)


def _edge(mask: Bools) -> Bools:
    """The cells of a mask that have a neighbour outside it."""
    inner = mask[1:-1, 1:-1] & mask[:-2, 1:-1] & mask[2:, 1:-1] & mask[1:-1, :-2] & mask[1:-1, 2:]
    out = mask.copy()
    out[1:-1, 1:-1] &= ~inner
    return out


@functools.lru_cache(maxsize=64)
def _way(house: HouseSpec, relation: str, destinations: tuple[str, ...], place: Vec3 | None) -> tuple[Bools, Walk]:
    """The cells where the carrier of an object may stand when the job is done, and the walk there."""
    ground = ReachableFloor.of(house)
    mask = np.zeros(ground.space.free.shape, dtype=bool)
    if relation == "at" and place is not None:
        mask |= ground.touching(Placement(id="", kind="", position=place))
    elif relation == "at":
        rooms = [room.polygon for room in house.rooms if room.id in destinations]
        free = ground.space.free
        mask[free] = [_within(REACH_M, (x, y), rooms) for x, y in ground.space.centres(free)]
    else:
        for thing in max_bearers(destinations, house):
            mask |= ground.beside(thing)
    return mask, ground.walk([mask])


def _within(reach: float, point: Vec2, polygons: Sequence[Sequence[Vec2]]) -> bool:
    return any(plane.inside(point, one) or plane.distance_to_edge(point, one) <= reach for one in polygons)
