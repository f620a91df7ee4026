"""Put the objects of a shuffled house back to where they were in a tour of the tidy house.

The first phase of a trial is the tour. Everybody looks around in the tidy house and keeps a record of their own. Once
all are ready, or at the phase's limit, things are shuffled while everybody goes back to their start, as in AI2-THOR's
rearrangement challenge. Of the goal, everybody learns only which objects it is about.

A task without phases hands the record of the tour out instead: the goal's jobs, as they are.

The jobs of the goal: one for every target, moved since or not. Nobody is told which targets were moved, except that the
target of the first job was::

    Job(target="mug", relation="on", destinations=("desk",), place=(5.2348, 8.1624, 0.79))

Moved targets and the places that they came from are within an arm's reach. A target is back when it rests on or in the
same thing within `hthor.tasks.subgoals.PLACE_M` of its recorded place. As in AI2-THOR's rearrangement challenge there
are two scores. The share fixed, `progress`, counts the moved targets that are back, less those that somebody displaced
since. Strict success, `met`, is that every target is in its place.
"""

import functools
import math
from collections.abc import Sequence

import msgspec

from hthor import catalog, seeds
from hthor.errors import HthorError
from hthor.tasks.arrangement.free_spots import find_spot, is_within_reach
from hthor.tasks.subgoals import JobKind
from hthor.types import Goal, HouseSpec, Job, Phase, Placement, TaskSpec, Thing

FEWEST, MOST = 2, 4
"""Least and greatest number of the six targets that are moved."""
MOVED_M = 1.5
"""Least distance on the plan of a moved target from its place."""
TIME_LIMIT_S = 180.0
"""Twice the usual limit: two to four objects have to be found and carried, not one."""
TOUR = "tour"
"""Name of the first phase."""
TOUR_LIMIT_S = 300.0
"""Time limit of the tour, our choice: long enough that most tours end because all are ready."""
TOUR_WORDS = "Look around and remember where things are. Later, some of them will be moved. Say when you are ready."
DEEP = frozenset({"sink"})
"""Nothing is moved out of these: people see into them from few places, so they hardly find the same spot again."""
_TRIES = 20


class RoomRearrangement(JobKind):
    """ "Some things were moved. Put everything back where it was." """

    name = "room_rearrangement"
    short = "rearrange"
    crew = ("tender",)
    time_limit = TIME_LIMIT_S
    medium_from, hard_from = 44.0, 55.0

    def instruction(self, goal: Goal, objects: tuple[Placement, ...]) -> str:
        first = catalog.kind(next(placement.kind for placement in objects if placement.id == goal.target))
        return f"Some things were moved, {first.definite} among them. Put everything back where it was."

    def draw(self, house: HouseSpec, root: int) -> tuple[Goal, tuple[Placement, ...]]:
        tidy, moved, own, objects = _scenes(house, root)
        return record(house, tidy, moved, own), objects

    def phases(self, task: TaskSpec, house: HouseSpec, root: int) -> tuple[Phase, ...]:  # noqa: ARG002
        """The tour of the tidy house."""
        tidy, _, _, _ = _scenes(house, root)
        return (Phase(name=TOUR, instruction=TOUR_WORDS, time_limit=TOUR_LIMIT_S, objects=tidy),)

    def told_goal(self, task: TaskSpec) -> Goal:
        """After a tour, only which objects there are."""
        if not task.phases:
            return task.goal
        jobs = tuple(Job(target=job.target, relation="back") for job in task.goal.jobs)
        return Goal(target=task.goal.target, relation="back", jobs=jobs)


@functools.lru_cache(maxsize=4)
def _scenes(house: HouseSpec, root: int) -> tuple[tuple[Placement, ...], str, int, tuple[Placement, ...]]:
    """The tidy house, one object that is moved, the root of its draw, and the shuffled house.

    Raises:
        HthorError: when the house has no room.
    """
    from hthor.tasks.arrangement.target_arrangement import arrange

    count = FEWEST + int(seeds.draw(root, "count") * (MOST - FEWEST + 1))
    for attempt in range(_TRIES):
        own = seeds.derive(root, "try", attempt)
        tidy = arrange(house, own)
        order = [tidy[number] for number in seeds.shuffled(len(tidy), own, "moved")]
        kinds = {thing.id: thing.kind for thing in house.things}
        moved = [one.id for one in order if kinds[one.support] not in DEEP and is_within_reach(house, one)][:count]
        objects = _shuffled(house, tidy, moved, own) if len(moved) == count else ()
        if objects:
            return tuple(tidy), moved[0], own, objects
    raise HthorError(f"house '{house.id}' has no room to shuffle {count} objects")


def record(house: HouseSpec, tidy: Sequence[Placement], first: str, root: int) -> Goal:
    """The record of a tour of the tidy house: each object's support and place, that of ``first`` at the head."""
    order = sorted(seeds.shuffled(len(tidy), root, "record"), key=lambda number: tidy[number].id != first)
    jobs = tuple(
        Job(target=one.id, relation=one.relation, destinations=(one.support,), place=one.position)
        for one in (tidy[number] for number in order)
    )
    kind = next(thing.kind for thing in house.things if thing.id == jobs[0].destinations[0])
    return Goal(target=jobs[0].target, relation=jobs[0].relation, destination=kind, jobs=jobs)


def _shuffled(house: HouseSpec, tidy: Sequence[Placement], moved: Sequence[str], root: int) -> tuple[Placement, ...]:
    """The tidy house with ``moved`` targets elsewhere, off all recorded places; empty when they find no room."""
    there = {one.id: one for one in tidy}
    for id in moved:
        home = there[id]

        def weigh(thing: Thing, home: Placement = home) -> float:
            return float(thing.id != home.support)

        others = [*tidy, *(there[other] for other in moved if there[other] not in tidy)]
        found = find_spot(house, id, home.kind, weigh, seeds.derive(root, "moved", id), others)
        if found is None or math.dist(found.position[:2], home.position[:2]) < MOVED_M:
            return ()
        there[id] = found
    # the relations "near" of the priors are no longer true
    return tuple(msgspec.structs.replace(there[one.id], near="") for one in tidy)


KIND = RoomRearrangement()
