"""What helps where a house has no place for a relation: a thing brought along, and the floor.

Where a tomato is to be on a plate and shall go to the dining table, and the house's only plate is there, the task
brings another plate, elsewhere. Where the remote control is to be near the television and shall go to the TV stand,
and no other surface is within a metre, it has slipped to the floor.
"""

import math
from collections.abc import Sequence

import msgspec

from hthor import catalog, seeds
from hthor.catalog import priors
from hthor.tasks.arrangement.placement import (
    NEAR_M,
    SupportSurface,
    SupportSurfaces,
    as_thing,
    place_on,
    place_on_floor,
    supports_of,
)
from hthor.tasks.arrangement.reachability import ReachableFloor
from hthor.tasks.arrangement.relation_placement import (
    TRIES,
    PlacementRequest,
    find_placement,
    is_near_enough,
    is_reachable,
)
from hthor.types import HouseSpec, Placement

CODE_PART = "tools"

BROUGHT = "brought"
"""Begins the id of a thing that a task brings along, such as ``brought_plate``."""
_ARM_M = 2.1
"""From the eye to what lies on the floor within reach, at most."""


def on_floor(house: HouseSpec, root: int, wish: PlacementRequest, done: Sequence[Placement]) -> Placement | None:
    """A pose on the floor near a thing of the house, None where none was found."""
    row, ground = wish.row, ReachableFloor.of(house)
    marks = [thing for thing in house.things if thing.kind == row.reference]
    for attempt in range(wish.tries if marks and row.relation == "near" else 0):
        mark = marks[attempt % len(marks)]
        reach = NEAR_M + max(mark.size[:2]) / 2
        x, y, turn = (2 * seeds.draw(root, "floor", axis, attempt) - 1 for axis in ("x", "y", "yaw"))
        place = (mark.centre[0] + reach * x, mark.centre[1] + reach * y)
        placement = msgspec.structs.replace(place_on_floor(row.target, place, math.pi * turn), near=mark.id)
        lies = is_near_enough(house, placement, mark, wish, done) and SupportSurfaces.of(house).lies(
            house, placement, done
        )
        if lies and (ground.seeing(placement, reach_m=_ARM_M) & ground.touching(placement) & ground.joined).any():
            return placement
    return None


def on_brought(
    house: HouseSpec, root: int, wish: PlacementRequest, done: Sequence[Placement]
) -> tuple[Placement, Placement] | None:
    """The target on or near a thing brought along, and that thing, which lies where people put the target; None where
    that has no place either.
    """
    row, shelves = wish.row, SupportSurfaces.of(house)
    if not catalog.kind(row.reference).pickable:
        return None
    usual = {place for relation, place in priors.weights(row.target) if relation == "on"} - {wish.ban}
    rests = [rest for rest in shelves.rests if rest.thing.kind in usual and not catalog.kind(rest.thing.kind).pickable]
    areas = [rest.surface.half[0] * rest.surface.half[1] for rest in rests]
    for attempt in range(wish.tries if rests else 0):
        rest = rests[seeds.choice(areas, root, "brought", attempt)]
        u, v, turn = (2 * seeds.draw(root, "brought", axis, attempt) - 1 for axis in ("u", "v", "yaw"))
        under = place_on(row.reference, rest, u, v, math.pi * turn)
        under = msgspec.structs.replace(under, id=f"{BROUGHT}_{row.reference}")
        if shelves.fits(rest, under, done) and is_reachable(house, under, rest):
            target = _with(house, root, wish, under, rest, done)
            if target is not None:
                return target, under
    return None


def _with(
    house: HouseSpec,
    root: int,
    wish: PlacementRequest,
    under: Placement,
    rest: SupportSurface,
    done: Sequence[Placement],
) -> Placement | None:
    """The target near the thing brought along, or on it; None where that has no room."""
    if wish.row.relation == "near":
        return find_placement(house, root, msgspec.structs.replace(wish, tries=TRIES), [*done, under])
    top = supports_of(as_thing(under))[0]
    target = place_on(wish.row.target, top, 0.0, 0.0, under.yaw)
    fits = SupportSurfaces.of(house).fits(top, target, done) and is_reachable(house, target, rest)
    return target if fits and is_near_enough(house, target, None, wish, done) else None
