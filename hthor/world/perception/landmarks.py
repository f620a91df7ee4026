"""Furniture and doorways as targets that never move, with the points at which visibility is tested."""

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from msgspec import Struct

from hthor import catalog
from hthor.geometry.plane import to_house
from hthor.geometry.ray_casting import Floats
from hthor.houses.space.solids import WALL_M
from hthor.types import Opening, Thing, Vec3

_DOORWAY_HEIGHT_M = 1.0
"""[m] Height of the point at which the visibility of a doorway is tested."""
_ROUNDING_M = 1e-6
_CORNER_SHARE, _ABOVE_SURFACE_M = 0.85, 0.02
"""Furniture is tested at its upper corners, scaled by this share about its centre, and this far [m] above surfaces."""


class Landmark(Struct, frozen=True):
    """The constant part of a detection of a thing that never moves: all fields except distance and state.

    ``points`` [m], house frame, are the points at which its visibility is tested.
    """

    id: str
    kind: str
    family: str
    position: Vec3
    size: Vec3
    yaw: float
    points: tuple[Vec3, ...]


def landmarks(statics: Iterable[Thing], openings: Iterable[Opening]) -> tuple[Landmark, ...]:
    """Furniture by id, then doorways by id."""
    furniture = [_furniture(thing) for thing in statics if _is_furniture(thing)]
    doorways = [_doorway(opening) for opening in openings if opening.passable]
    return (*sorted(furniture, key=lambda landmark: landmark.id), *sorted(doorways, key=lambda landmark: landmark.id))


def pack_targets(found: Sequence[Landmark], span: Mapping[str, tuple[int, int]]) -> tuple[Floats, Floats]:
    """``balls`` and ``spots`` for `visibility_kernel.visible_targets`; ``span`` gives the geoms of each landmark."""
    balls, begin = np.zeros((7, len(found) + 1)), 0
    for number, landmark in enumerate(found):
        balls[:, number] = (*_bounding_sphere(landmark.points), *span.get(landmark.id, (0, 0)), begin)
        begin += len(landmark.points)
    balls[6, -1] = begin
    spots = np.zeros((6, begin))
    spots[:3] = np.array([point for landmark in found for point in landmark.points]).reshape(-1, 3).T
    return balls, spots


def _bounding_sphere(points: Sequence[Vec3]) -> tuple[float, float, float, float]:
    """Middle and radius [m] of a ball around the points, slightly enlarged against rounding."""
    x, y, z = (0.5 * (min(axis) + max(axis)) for axis in zip(*points, strict=True))
    return x, y, z, max(math.dist((x, y, z), point) for point in points) + _ROUNDING_M


def _is_furniture(thing: Thing) -> bool:
    """Whether a thing counts as furniture; small static things that lie on others are not detected."""
    return not thing.parent or catalog.kind(thing.kind).receptacle


def _furniture(thing: Thing) -> Landmark:
    kind = catalog.kind(thing.kind)
    w, d, h = (extent / 2 for extent in thing.size)
    local: list[Vec3] = [(0.0, 0.0, 0.0), (0.0, 0.0, h + _ABOVE_SURFACE_M)]
    for surface in kind.surfaces(thing.size):
        if not surface.inside:
            local.append((surface.centre[0], surface.centre[1], surface.centre[2] + _ABOVE_SURFACE_M))
    local += [(sx * _CORNER_SHARE * w, sy * _CORNER_SHARE * d, _CORNER_SHARE * h) for sx in (-1, 1) for sy in (-1, 1)]
    if kind.openable:
        local.append((0.0, d + _ABOVE_SURFACE_M, 0.0))
    points = tuple(to_house(point, thing.centre, thing.yaw) for point in local)
    return Landmark(thing.id, thing.kind, "furniture", thing.centre, thing.size, thing.yaw, points)


def _doorway(opening: Opening) -> Landmark:
    (ax, ay), (bx, by) = opening.a, opening.b
    middle = ((ax + bx) / 2, (ay + by) / 2, _DOORWAY_HEIGHT_M)
    size = (math.dist(opening.a, opening.b), WALL_M, opening.high - opening.low)
    yaw = math.atan2(by - ay, bx - ax)
    return Landmark(opening.id, "doorway", "doorway", middle, size, yaw, (middle,))
