"""Landmarks of a route: pieces of furniture that are in sight where an instruction mentions them, and unambiguous.

Sight is computed on the house at rest, with the lines of sight by which tasks are made: a landmark is in sight from a
place if nothing opaque lies between its middle, or a point near its top, and eyes at a person's height as well as at
that of a low robot. The field of view does not matter, because heads turn.
"""

import functools
import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from msgspec import Struct

from hthor import catalog
from hthor.geometry import plane
from hthor.houses.space.visibility import LinesOfSight, with_all_open
from hthor.tasks.arrangement.reachability import EYE_M
from hthor.tasks.routes.route import Stretch
from hthor.types import HouseSpec, Thing, Vec2

EYES_M = (EYE_M, 0.9)
"""Heights of the eyes [m] that have to see a landmark: a person's, and that of the robot `scout`."""
PASSED_M = 1.2
"""Greatest distance [m] of a route from the edge of a landmark that it goes past. Our choice: within a detector's
range of 1.5 m of a part of it."""
SHARP_RAD = math.radians(50.0)
"""Least change of heading [rad] that counts as a turn. Our choice."""
_STEP_M = 0.25
"""Distance [m] between the places of a route from which sight is tested."""
_CLEAR_M = 0.6
"""How far [m] behind the beginning and before the end of a stretch a landmark is passed, to be worth a mention."""


class Passing(Struct, frozen=True, kw_only=True):
    """A landmark that a stretch of a route goes past.

    ``at`` [m] is how far along the stretch it is nearest, ``place`` [m] that point of the route, and ``heading`` [rad]
    the way's direction there. ``bearing`` [rad] is the landmark's direction, relative to that heading. ``bend`` [rad]
    is by how much the way turns there, left positive.
    """

    thing: Thing
    at: float
    place: Vec2
    heading: float
    bearing: float
    bend: float


def is_landmark(thing: Thing) -> bool:
    """Whether people and detectors notice the thing as a piece of furniture."""
    kind = catalog.kind(thing.kind)
    return not thing.parent and not kind.pickable and bool(kind.rests(thing.size))


def in_sight(house: HouseSpec, thing: Thing, places: Sequence[Vec2], heights: Sequence[float] = EYES_M) -> bool:
    """Whether eyes at each of the heights see the thing, from some of the places [m]."""
    eyes = [np.array([(x, y, height) for x, y in places]) for height in heights]
    return bool(len(places)) and all(_sight(house).visible(thing, thing.centre, row) for row in eyes)


def is_unambiguous(house: HouseSpec, thing: Thing, places: Sequence[Vec2]) -> bool:
    """Whether the thing is in sight from the places [m], and no other thing of its kind is, from any of them."""
    others = (other for other in house.things if other.kind == thing.kind and other.id != thing.id)
    seen = (in_sight(house, other, places, (height,)) for other in others for height in EYES_M)
    return in_sight(house, thing, places) and not any(seen)


def places_along(points: Sequence[Vec2], until: float = math.inf) -> list[Vec2]:
    """Places [m] along a way, at most 0.25 m apart, up to a distance [m] from its beginning."""
    found, walked = [points[0]], 0.0
    for a, b in pairwise(points):
        length = math.dist(a, b)
        for number in range(1, math.ceil(length / _STEP_M) + 1):
            share = min(number * _STEP_M / length, 1.0)
            if walked + share * length > until:
                return found
            found.append((a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])))
        walked += length
    return found


def passings(house: HouseSpec, stretch: Stretch) -> list[Passing]:
    """The landmarks of the room that a stretch goes past, in the order of the way; each is unambiguous there."""
    rows = []
    whole = sum(math.dist(a, b) for a, b in pairwise(stretch.points))
    for thing in house.things:
        if thing.room == stretch.room.id and is_landmark(thing):
            one = _passing(thing, stretch.points)
            if one is not None and _CLEAR_M <= one.at <= whole - _CLEAR_M:
                rows.append(one)
    rows.sort(key=lambda one: (one.at, one.thing.id))
    return [one for one in rows if is_unambiguous(house, one.thing, places_along(stretch.points, one.at))]


def outline_distance(thing: Thing, point: Vec2) -> float:
    """Distance [m] on the plan from a point to the thing's nearest edge, 0 inside."""
    return plane.distance_to_rectangle(point, thing.centre[:2], thing.size[:2], thing.yaw)


def _passing(thing: Thing, points: Sequence[Vec2]) -> Passing | None:
    """How a way goes past a thing; None when it does not come near enough."""
    places = places_along(points)
    near = min(range(len(places)), key=lambda number: (round(outline_distance(thing, places[number]), 6), number))
    if outline_distance(thing, places[near]) > PASSED_M or not 0 < near < len(places) - 1:
        return None
    place = places[near]
    before, after = places[max(near - 3, 0)], places[min(near + 3, len(places) - 1)]
    came, goes = _direction(before, place), _direction(place, after)
    bearing = plane.wrap(_direction(place, (thing.centre[0], thing.centre[1])) - came)
    at = sum(math.dist(a, b) for a, b in pairwise(places[: near + 1]))
    return Passing(thing=thing, at=at, place=place, heading=came, bearing=bearing, bend=plane.wrap(goes - came))


def _direction(a: Vec2, b: Vec2) -> float:
    return math.atan2(b[1] - a[1], b[0] - a[0])


@functools.lru_cache(maxsize=16)
def _sight(house: HouseSpec) -> LinesOfSight:
    return with_all_open(house)
