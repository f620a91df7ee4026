"""Put objects that are out of place where common sense expects them.

There is no reference arrangement: every place that the data of `hthor.tasks.arrangement.commonsense_places` allow is
right. The goal has one job for every target, out of place or not. Nobody is told which targets are out of place, except
that the target of the first job is::

    Job(target="remote_control", relation="on", destinations=("coffee_table", "side_table", "sofa", ...))

The destinations are the kinds of things in the house where the target may lie, the likeliest first; the relation is
that of the likeliest. Progress counts the targets that are back of those that were out of place, less those that
somebody misplaced since; the goal is met when no target is out of place.
"""

from hthor import catalog, seeds
from hthor.errors import HthorError
from hthor.tasks.arrangement import commonsense_places
from hthor.tasks.arrangement.free_spots import find_spot
from hthor.tasks.subgoals import JobKind
from hthor.types import Goal, HouseSpec, Job, Placement, Thing

FEWEST, MOST = 2, 4
"""Least and greatest number of the six targets that are out of place."""
TIME_LIMIT_S = 180.0
"""Twice the usual limit: two to four objects have to be found and carried, not one."""
_TRIES = 20


class TidyingUp(JobKind):
    """ "Tidy up: put what is out of place where it belongs." """

    name = "tidying_up"
    short = "tidy"
    crew = ("tender",)
    time_limit = TIME_LIMIT_S
    medium_from, hard_from = 35.0, 41.0

    def goals(self, house: HouseSpec) -> tuple[Goal, ...]:
        present = {thing.kind for thing in house.things}
        if not all(present.intersection(commonsense_places.usual_places(target)) for target in catalog.TARGETS):
            return ()
        return tuple(_goal(house, target, 0) for target in catalog.TARGETS)

    def instruction(self, goal: Goal, objects: tuple[Placement, ...]) -> str:
        first = next(placement for placement in objects if placement.id == goal.target)
        noun = catalog.kind(first.kind).definite
        return f"Tidy up: {noun} and maybe more is out of place. Put everything where one would look for it."

    def draw(self, house: HouseSpec, root: int) -> tuple[Goal, tuple[Placement, ...]]:
        count = FEWEST + int(seeds.draw(root, "count") * (MOST - FEWEST + 1))
        for attempt in range(_TRIES):
            own = seeds.derive(root, "try", attempt)
            order = [catalog.TARGETS[number] for number in seeds.shuffled(len(catalog.TARGETS), own, "order")]
            objects = _strewn(house, order, count, own)
            if objects:
                return _goal(house, order[0], own), objects
        raise HthorError(f"house '{house.id}' has no place where {count} targets would be out of place")


def _goal(house: HouseSpec, first: str, root: int) -> Goal:
    present = {thing.kind for thing in house.things}
    order = sorted(seeds.shuffled(len(catalog.TARGETS), root, "jobs"), key=lambda n: catalog.TARGETS[n] != first)
    jobs = []
    for target in (catalog.TARGETS[number] for number in order):
        kinds = tuple(kind for kind in commonsense_places.usual_places(target) if kind in present)
        jobs.append(Job(target=target, relation=catalog.kind(kinds[0]).relation, destinations=kinds))
    return Goal(target=first, relation=jobs[0].relation, destination=jobs[0].destinations[0], jobs=tuple(jobs))


def _strewn(house: HouseSpec, order: list[str], count: int, root: int) -> tuple[Placement, ...]:
    """The first ``count`` targets out of place and the others where they belong; empty when a target finds no room."""
    done: list[Placement] = []
    for rank, target in enumerate(order):

        def weigh(thing: Thing, target: str = target, out: bool = rank < count) -> float:
            if out:
                return float(commonsense_places.is_misplaced(target, thing.kind))
            return (
                commonsense_places.places_of(target)[thing.kind].share
                if thing.kind in commonsense_places.usual_places(target)
                else 0.0
            )

        found = find_spot(house, target, target, weigh, seeds.derive(root, "spot", target), done)
        if found is None:
            return ()
        done.append(found)
    return tuple(sorted(done, key=lambda placement: catalog.TARGETS.index(placement.id)))


KIND = TidyingUp()
