"""A route: the shortest way with ample room through a house, cut into the stretches between its doors."""

import math
from itertools import pairwise

import numpy as np
from msgspec import Struct

from hthor.geometry import plane
from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.geodesic import Geodesics
from hthor.tasks.arrangement.reachability import HEIGHT_M, START_MARGIN_M
from hthor.tasks.routes.passages import Passage, passages
from hthor.types import HouseSpec, Pose, Room, Thing, Vec2

BESIDE_M = 0.8
"""Greatest distance [m] of a route's end from the landmark's nearest edge. Our choice: within an arm's reach."""
_FRONT_M = 0.45
"""The preferred distance [m] of the end from the landmark's front."""
_DIGITS = 3


class Stretch(Struct, frozen=True, kw_only=True):
    """The part of a route in one room.

    ``points`` [m], house frame, is the way from where the room is entered to where it is left. ``heading`` [rad] is
    that of whoever enters: straight through the door, or the heading at the start. ``entry`` and ``exit`` are the
    passages between rooms, None at the start and at the end of the route.
    """

    room: Room
    points: tuple[Vec2, ...]
    heading: float
    entry: Passage | None = None
    exit: Passage | None = None


class Route(Struct, frozen=True, kw_only=True):
    """A way through a house: ``points`` [m], house frame, with every bend; and the same in ``stretches``."""

    points: tuple[Vec2, ...]
    stretches: tuple[Stretch, ...]

    @property
    def metres(self) -> float:
        """Its length [m]."""
        return sum(math.dist(a, b) for a, b in pairwise(self.points))


def shortest_route(house: HouseSpec, start: Pose, end: Vec2) -> Route | None:
    """The shortest route over the floor where a task can start; None when there is none."""
    way = Geodesics.of(FreeSpace.of(house, START_MARGIN_M, HEIGHT_M)).path((start.x, start.y), end)
    return as_route(house, start, tuple((round(x, _DIGITS), round(y, _DIGITS)) for x, y in way)) if way else None


def as_route(house: HouseSpec, start: Pose, points: tuple[Vec2, ...]) -> Route | None:
    """A way as a route: cut wherever it goes from room to room; None when it begins in no room."""
    room = room_at(house, points[0])
    rooms = {other.id: other for other in house.rooms}
    stretches: list[Stretch] = []
    entry, heading, done = None, start.yaw, [points[0]]
    for a, b in pairwise(points):
        for where, door in _crossings(house, a, b):
            if room is None or room.id not in door.rooms:
                return None  # it clips a corner between rooms
            stretches.append(Stretch(room=room, points=(*done, where), heading=heading, entry=entry, exit=door))
            room = rooms[door.other_side(room.id)]
            entry, heading, done = door, door.heading(a, b), [where]
        done.append(b)
    if room is None:
        return None
    stretches.append(Stretch(room=room, points=tuple(done), heading=heading, entry=entry))
    return Route(points=points, stretches=tuple(stretches))


def place_beside(house: HouseSpec, thing: Thing) -> Vec2 | None:
    """The place [m] where a route to a thing ends: before its front if there is room, else as near to that as can be.

    It lies in the thing's room, and on floor where a task can start; None when there is no such place.
    """
    room = next((room for room in house.rooms if room.id == thing.room), None)
    lane = FreeSpace.of(house, START_MARGIN_M, HEIGHT_M)
    if room is None or not lane.free.any():
        return None
    largest = int(np.bincount(lane.components[lane.free]).argmax())
    cells = lane.centres((lane.components == largest) & lane.room_mask(room))
    centre, size = (thing.centre[0], thing.centre[1]), (thing.size[0], thing.size[1])
    x, y = plane.to_house((0.0, size[1] / 2 + _FRONT_M, 0.0), thing.centre, thing.yaw)[:2]
    near = [
        (round(math.dist(cell, (x, y)), 6), cell)
        for cell in ((float(u), float(v)) for u, v in cells)
        if plane.distance_to_rectangle(cell, centre, size, thing.yaw) <= BESIDE_M
    ]
    return min(near)[1] if near else None


def room_at(house: HouseSpec, point: Vec2) -> Room | None:
    """The room that contains a point [m], None outside."""
    return next((room for room in house.rooms if plane.inside(point, room.polygon)), None)


def _crossings(house: HouseSpec, a: Vec2, b: Vec2) -> list[tuple[Vec2, Passage]]:
    """The passages that a straight way goes through, and where [m], in this order."""
    found = []
    for door in passages(house):
        share = _meeting(a, b, door.a, door.b)
        if share is not None:
            found.append((share, (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])), door))
    return [(where, door) for _, where, door in sorted(found, key=lambda one: one[0])]


def _meeting(a: Vec2, b: Vec2, c: Vec2, d: Vec2) -> float | None:
    """The share of the way from ``a`` (included) to ``b`` at which it crosses the segment from ``c`` to ``d``."""
    (ux, uy), (vx, vy) = (b[0] - a[0], b[1] - a[1]), (d[0] - c[0], d[1] - c[1])
    cross = ux * vy - uy * vx
    if cross == 0.0:
        return None
    wx, wy = c[0] - a[0], c[1] - a[1]
    along, across = (wx * vy - wy * vx) / cross, (wx * uy - wy * ux) / cross
    return along if 0.0 <= along < 1.0 and 0.0 <= across <= 1.0 else None
