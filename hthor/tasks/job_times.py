"""How far the objects of jobs have to be carried, and the least time of a person who does all jobs.

Both are walks over the avatar's floor, from a cell within the avatar's reach of an object to a cell within reach of the
nearest suitable destination. Lines of sight do not matter, and turning costs nothing.
"""

import functools
import math
from collections.abc import Sequence

import numpy as np

from hthor import catalog, rules
from hthor.geometry import plane
from hthor.tasks.arrangement.errands import Errand, Errands
from hthor.tasks.arrangement.reachability import REACH_M, SLACK_M, Bools, ReachableFloor, Walk
from hthor.tasks.jobs import PLACE_M, TOGETHER_M, destination_things
from hthor.tasks.kind import LeastTimes
from hthor.types import HouseSpec, Job, Placement, Vec2, Vec3


def least_times(house: HouseSpec, objects: Sequence[Placement], jobs: Sequence[Job]) -> LeastTimes:
    """The least time of one person who knows all places and does all the jobs, one after the other.

    They walk at `rules.PACE_M_S`, and at `rules.HANDLE_PACE` of it with a thing that several bodies carry, whose other
    bearers are always in place. Each pick and each place takes `rules.HANDLING_S`, and so does opening a closed thing
    that an object is in.
    """
    ground, there = ReachableFloor.of(house), {placement.id: placement for placement in objects}
    return Errands(ground, [_errand(ground, there[job.target], job) for job in jobs]).seconds


def _errand(ground: ReachableFloor, placement: Placement, job: Job) -> Errand:
    together = job.hands > 1
    length = catalog.kind(placement.kind).size[0] if together else 0.0  # by a handle, from farther away
    return Errand(
        take=ground.touching(placement, length),
        put=_ends(ground, job.relation, job.destinations, job.place, length + (TOGETHER_M if together else PLACE_M)),
        handling=_handling(ground.house, placement),
        pace=rules.PACE_M_S * (rules.HANDLE_PACE if together else 1.0),
    )


def _handling(house: HouseSpec, placement: Placement) -> float:
    """[s] To pick and to place an object, and to open a closed thing that it is in."""
    lying = next((thing for thing in house.things if thing.id == placement.support), None)
    shut = placement.relation == "in" and lying is not None and catalog.kind(lying.kind).hides
    return (2 + shut) * rules.HANDLING_S


def carrying_time(house: HouseSpec, placement: Placement, job: Job) -> float:
    """The least time [s] of one job for a body that stands next to the object; inf when it cannot be done."""
    way, pace = carrying_way(house, placement, job), rules.PACE_M_S
    if job.hands > 1:  # by a handle, from farther away; and it may stop short of the place
        way -= catalog.kind(placement.kind).size[0] + TOGETHER_M
        pace *= rules.HANDLE_PACE
    return max(way, 0.0) / pace + _handling(house, placement)


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
    mask = _ends(ground, relation, destinations, place if relation == "at" else None)
    return mask, ground.walk([mask])


def _ends(
    ground: ReachableFloor, relation: str, destinations: tuple[str, ...], place: Vec3 | None, spare: float = 0.0
) -> Bools:
    """The cells where the carrier of an object may stand when the job is done.

    Args:
        spare: [m] how much farther away than the carrier's reach an exact place may be.
    """
    if place is not None:
        return ground.touching(Placement(id="", kind="", position=place), spare)
    mask = np.zeros(ground.space.free.shape, dtype=bool)
    if relation == "at":
        rooms = [room.polygon for room in ground.house.rooms if room.id in destinations]
        free = ground.space.free
        mask[free] = [_within(REACH_M, (x, y), rooms) for x, y in ground.space.centres(free)]
    else:
        for thing in destination_things(destinations, ground.house):
            mask |= ground.beside(thing)
    return mask


def _within(reach: float, point: Vec2, polygons: Sequence[Sequence[Vec2]]) -> bool:
    return any(plane.inside(point, one) or plane.distance_to_edge(point, one) <= reach for one in polygons)
