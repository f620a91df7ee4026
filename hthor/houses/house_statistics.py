"""Statistics of houses for comparison: rooms, doors, things, free floor, distances."""

from __future__ import annotations

import math
import statistics
from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np
from msgspec import Struct

from hthor import catalog, rules
from hthor.geometry.plane import distance_to_rectangle, signed_area
from hthor.houses.space.free_space import Floats, FreeSpace
from hthor.houses.space.geodesic import Geodesics
from hthor.types import HouseSpec, Thing

BODY_M = 0.20
"""Radius of the body whose free floor and ways are measured: that of an AI2-THOR agent."""
_STAND_M = 1.0
_TENTHS = 10


class HouseFigures(Struct, frozen=True, kw_only=True):
    """The measurements of one house.

    ``rooms`` holds kind, area [m2], doors, things and things on the floor or a wall of each room; a door counts for
    both its rooms, and openings without a wall do not count. ``doors`` counts the passable doors of the house. ``ways``
    [m] are the shortest ways from the start to a place to stand at each receptacle; ``free`` is the share of the floor
    that a body's axis can reach.
    """

    house: str
    rooms: tuple[RoomFigures, ...]
    doors: int
    ways: tuple[float, ...]
    free: float

    @property
    def area(self) -> float:
        """Total area of the rooms [m2]."""
        return sum(room.area for room in self.rooms)


class RoomFigures(Struct, frozen=True, kw_only=True):
    """One room: its kind, area [m2], doors, all things, and only the things on the floor or a wall (``top``)."""

    kind: str
    area: float
    doors: int
    things: int
    top: int


class Quantiles(Struct, frozen=True, kw_only=True):
    """Lower tenth, median and upper tenth of a figure, and the number of its values."""

    low: float
    median: float
    high: float
    count: int


class HouseStatistics(Struct, frozen=True, kw_only=True):
    """A population's figures by name; ``houses`` is how many were measured."""

    name: str
    houses: int
    figures: dict[str, Quantiles]


def measure_house(house: HouseSpec) -> HouseFigures:
    """Measure one house."""
    space = FreeSpace.of(house, BODY_M)
    reached = space.component(*space.nearest_free(house.start.x, house.start.y))
    doors = Counter(room for opening in house.openings if opening.passable for room in opening.rooms)
    things, top = Counter(t.room for t in house.things), Counter(t.room for t in house.things if not t.parent)
    rooms = tuple(
        RoomFigures(
            kind=room.kind,
            area=abs(signed_area(room.polygon)),
            doors=doors[room.id],
            things=things[room.id],
            top=top[room.id],
        )
        for room in house.rooms
    )
    area = sum(room.area for room in rooms)
    return HouseFigures(
        house=house.id,
        rooms=rooms,
        doors=sum(opening.passable for opening in house.openings),
        ways=_ways(house, space),
        free=float(reached.sum()) * space.cell**2 / area,
    )


def summarize_houses(name: str, houses: Iterable[HouseFigures]) -> HouseStatistics:
    """The figures of a population; rooms, things and ways are pooled over its houses.

    Raises:
        ValueError: when there are no houses.
    """
    all_ = list(houses)
    if not all_:
        raise ValueError("statistics of houses need at least one house")
    rooms = [room for one in all_ for room in one.rooms]
    kinds = ("kitchen", "living_room", "bedroom", "bathroom")
    figures: dict[str, Sequence[float]] = {
        "rooms a house": [len(one.rooms) for one in all_],
        "floor of a house, m2": [one.area for one in all_],
        "doors a house": [one.doors for one in all_],
        "things a house": [sum(room.things for room in one.rooms) for one in all_],
        "of these on floor or wall": [sum(room.top for room in one.rooms) for one in all_],
        "room, m2": [room.area for room in rooms],
        **{f"{kind.replace('_', ' ')}, m2": [room.area for room in rooms if room.kind == kind] for kind in kinds},
        "doors a room": [room.doors for room in rooms],
        "things a room": [room.things for room in rooms],
        "of these on floor or wall, a room": [room.top for room in rooms],
        "start to receptacle, m": [way for one in all_ for way in one.ways],
        "free floor, %": [100.0 * one.free for one in all_],
    }
    spreads = {label: quantiles_of(values) for label, values in figures.items() if values}
    return HouseStatistics(name=name, houses=len(all_), figures=spreads)


def quantiles_of(values: Sequence[float]) -> Quantiles:
    """Tenths and median of at least one value."""
    if len(values) == 1:
        return Quantiles(low=values[0], median=values[0], high=values[0], count=1)
    tenths = statistics.quantiles(values, n=_TENTHS, method="inclusive")
    middle = statistics.median(values)
    return Quantiles(low=min(tenths[0], middle), median=middle, high=max(tenths[-1], middle), count=len(values))


def _ways(house: HouseSpec, space: FreeSpace) -> tuple[float, ...]:
    """From the start to the nearest place to stand within 1 m of each receptacle that has such a place."""
    start = space.nearest_free(house.start.x, house.start.y)
    field = Geodesics.of(space).field([start])
    reached = space.component(*start)
    rooms = {room.id: space.centres(reached & space.room_mask(room)) for room in house.rooms}
    ways = []
    for thing in house.things:
        if thing.kind in catalog.RECEPTACLES and not thing.parent:
            beside = _beside(thing, rooms.get(thing.room, space.centres(reached)))
            if len(beside):
                ways.append(float(field.at(beside).min()))
    return tuple(ways)


def _beside(thing: Thing, places: Floats) -> Floats:
    """The places among (N, 2) that are nearest to the thing's edge, if they are within reach."""
    reach = math.hypot(*thing.size[:2]) / 2 + _STAND_M
    near = places[np.hypot(places[:, 0] - thing.centre[0], places[:, 1] - thing.centre[1]) < reach]
    gaps = np.array([distance_to_rectangle((x, y), thing.centre[:2], thing.size[:2], thing.yaw) for x, y in near])
    best: Floats = near[gaps <= min(_STAND_M, gaps.min() + rules.GRID_M)] if len(near) else near
    return best
