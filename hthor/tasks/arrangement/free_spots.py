"""Finds a free place for one object, on furniture or on the floor, that every body can reach."""

import functools
import math
from collections.abc import Callable, Iterable, Sequence

import msgspec
import numpy as np
from numpy.typing import NDArray

from hthor import catalog, seeds
from hthor.geometry.plane import inside
from hthor.houses.space.free_space import FreeSpace
from hthor.tasks.arrangement.placement import SupportSurface, SupportSurfaces, place_on, place_on_floor
from hthor.tasks.arrangement.reachability import HEIGHT_M, ReachableFloor
from hthor.types import HouseSpec, Placement, Room, Thing

Floats = NDArray[np.float64]

NEAR_M = 0.85
"""Distance on the plan from which a robot with an arm reaches an object; a person's reach is longer."""
LANE_M = 0.35
"""Half the width of the ways between places on the floor: slightly more than the broadest robot's radius."""
_TRIES = 60


def find_spot(
    house: HouseSpec, id: str, kind: str, weigh: Callable[[Thing], float], root: int, done: Sequence[Placement] = ()
) -> Placement | None:
    """A place on or in furniture, clear of ``done`` and of everything else; None when no place was found.

    The object rests exactly on a surface. The avatar can see it, with the fridge's door open, from free floor that is
    less than `NEAR_M` away and connected to the house's start.

    Args:
        id, kind: of the object.
        weigh: gives each thing's weight in the draw, zero for never; a thing's surfaces share it by size.
        root: root of all draws.
    """
    rests = SupportSurfaces.of(house).rests
    areas: dict[str, float] = {}
    for rest in rests:
        areas[rest.thing.id] = areas.get(rest.thing.id, 0.0) + _area(rest)
    weights = [weigh(rest.thing) * _area(rest) / areas[rest.thing.id] for rest in rests]
    if not any(weights):
        return None
    for attempt in range(_TRIES):
        rest = rests[seeds.choice(weights, root, "rest", attempt)]
        u, v, turn = (2 * seeds.draw(root, axis, attempt) - 1 for axis in ("u", "v", "yaw"))
        placement = msgspec.structs.replace(place_on(kind, rest, u, v, math.pi * turn), id=id)
        if SupportSurfaces.of(house).fits(rest, placement, done) and is_within_reach(house, placement):
            return placement
    return None


def is_within_reach(house: HouseSpec, placement: Placement) -> bool:
    """Whether the object can be seen from free floor at most `NEAR_M` away that is connected to the house's start; a
    closed thing that contains it counts as open.
    """
    ground = ReachableFloor.of(house)
    holder = next((thing for thing in house.things if thing.id == placement.support), None)
    shut = placement.relation == "in" and holder is not None and catalog.kind(holder.kind).hides
    opened = frozenset({placement.support}) if shut else frozenset[str]()
    floor = ground.space.component(*ground.space.nearest_free(house.start.x, house.start.y))
    cells = ground.space.centres(ground.touching(placement) & floor & ground.seeing(placement, opened))
    x, y, _ = placement.position
    return bool(len(cells)) and float(np.hypot(cells[:, 0] - x, cells[:, 1] - y).min()) <= NEAR_M


def find_floor_spot(
    house: HouseSpec, id: str, kind: str, room: Room, clear: float, root: int, near: Thing | None = None
) -> Placement | None:
    """A place on a room's floor, free within ``clear`` [m] of the object's middle, or None.

    With ``near`` only the places nearest to that thing are used.
    """
    cells = _room_floor(house, room, clear)
    if not len(cells):
        return None
    if near is not None:
        away = np.hypot(cells[:, 0] - near.centre[0], cells[:, 1] - near.centre[1])
        cells = cells[away <= away.min() + 0.2]
    x, y = cells[int(seeds.draw(root, "cell") * len(cells))]
    placement = place_on_floor(kind, (float(x), float(y)), math.pi * (2 * seeds.draw(root, "yaw") - 1))
    placement = msgspec.structs.replace(placement, id=id)
    return placement if SupportSurfaces.of(house).lies(house, placement, ()) else None


def room_of(house: HouseSpec, thing_id: str) -> str:
    """The id of the room that a thing stands in, empty if it is in no room."""
    return next((thing.room for thing in house.things if thing.id == thing_id), "")


def unique_things(house: HouseSpec, kinds: Iterable[str]) -> tuple[Thing, ...]:
    """The things of these kinds that are the only ones of their kind in the house, so that "the" is unambiguous."""
    rows = [[thing for thing in house.things if thing.kind == kind] for kind in kinds]
    return tuple(row[0] for row in rows if len(row) == 1)


@functools.lru_cache(maxsize=64)
def _room_floor(house: HouseSpec, room: Room, clear: float) -> Floats:
    """(N, 2) [m] middles of a room's cells that are free within ``clear`` [m], on floor that broad bodies can leave."""
    wide, lane = FreeSpace.of(house, clear, HEIGHT_M), FreeSpace.of(house, LANE_M, HEIGHT_M)
    if not lane.free.any():
        return np.zeros((0, 2))
    largest = int(np.bincount(lane.components[lane.free]).argmax())
    cells = wide.centres(wide.free & lane.free & (lane.components == largest))
    (x0, y0), (x1, y1) = np.min(room.polygon, axis=0), np.max(room.polygon, axis=0)
    cells = cells[(cells[:, 0] >= x0) & (cells[:, 0] <= x1) & (cells[:, 1] >= y0) & (cells[:, 1] <= y1)]
    floor: Floats = cells[np.array([inside((x, y), room.polygon) for x, y in cells], dtype=bool)]
    return floor


def _area(rest: SupportSurface) -> float:
    return rest.surface.half[0] * rest.surface.half[1]
