"""Where to stand to look at a place or to reach an object."""

import functools
import math
from collections.abc import Sequence

from hthor.geometry.plane import to_house
from hthor.humans.memory.spatial_memory import KnownPlace
from hthor.humans.motor.locomotion import Walker
from hthor.navigation.waiting_spots import MAYBE, YES, usable
from hthor.types import Vec2, Vec3

GAP_M = 0.42
"""[m] From the edge of furniture to the middle of the body of who stands at it. Our choice."""
_SPACING_M = 0.6
"""[m] Between the spots that are considered along a side of furniture. Our choice."""
_FRONT_SPACING = 0.6
"""[ratio] Spots in front of furniture that opens are closer together by this factor. Our choice."""
_RING_M = (0.6, 0.75, 0.9, 1.0, 1.14)
"""[m] Radii of the rings of spots around an object. Our choice."""
_DIRECTIONS = 20
"""[count] Spots on each ring. Our choice."""
_UNKNOWN_SIZE_M = 0.5
"""[m] Side of the furniture that is assumed under an object of unknown support. Our choice."""


def viewpoints_of_place(place: KnownPlace, walker: Walker, front: bool = False) -> list[Vec2]:
    """Spots [m] along the edges of a place, ``front`` only or all round, where one could stand and see it."""
    return _usable(_beside(place.centre, place.size, place.yaw, front), place, walker)


def viewpoints_of_object(point: Vec3, support: KnownPlace | None, walker: Walker, reach: float) -> list[Vec2]:
    """Spots [m] within ``reach`` metres of an object that lies on ``support``, if anything."""
    return _usable(rings(point, reach), support or _assumed_place(point), walker)


def rings(point: Vec3, reach: float) -> list[Vec2]:
    """Spots [m] in rings about an object, within ``reach`` metres, free or not."""
    x, y = point[0], point[1]
    return [
        (x + r * math.cos(a), y + r * math.sin(a))
        for r in _RING_M
        if r <= reach
        for a in (2.0 * math.pi * k / _DIRECTIONS for k in range(_DIRECTIONS))
    ]


def within_reach(spots: list[Vec2], point: Vec3, reach: float) -> list[Vec2]:
    """Those from which an object is at most ``reach`` metres away."""
    return [spot for spot in spots if math.dist(spot, point[:2]) <= reach]


@functools.lru_cache(maxsize=4096)
def _beside(centre: Vec3, size: Vec3, yaw: float, front: bool) -> tuple[Vec2, ...]:
    half = (size[0] / 2.0, size[1] / 2.0)
    deep = half[1] + GAP_M
    local = [(s, deep) for s in _spread(half[0], front)]
    if not front:
        local += [(s, -deep) for s in _spread(half[0], front)]
        local += [(side * (half[0] + GAP_M), s) for side in (-1.0, 1.0) for s in _spread(half[1], front)]
    return tuple(to_house((x, y, 0.0), centre, yaw)[:2] for x, y in local)


def _spread(half: float, wide: bool) -> list[float]:
    """Positions along a side, the middle among them; ``wide`` adds some past its ends."""
    count = max(0, math.floor(half / _SPACING_M)) + (1 if wide else 0)
    return [k * _SPACING_M * (_FRONT_SPACING if wide else 1.0) for k in range(-count, count + 1)]


def _usable(spots: Sequence[Vec2], place: KnownPlace, walker: Walker) -> list[Vec2]:
    """Spots known to be free; when there is none, those that might be."""
    ranks = usable(walker.grid, walker.planner, spots, [_edge(spot, place) for spot in spots], walker.margin)
    best = YES if YES in ranks else MAYBE
    return [spot for spot, rank in zip(spots, ranks, strict=True) if rank == best]


def has_free_line(spot: Vec2, place: KnownPlace, walker: Walker) -> bool:
    """Whether nothing on the map, above all no wall, is between a spot and the nearest edge of the place."""
    return not walker.grid.meets(spot, _edge(spot, place), walker.margin)


def _edge(spot: Vec2, place: KnownPlace) -> Vec2:
    """The point of a place's outline, or inside it, that is nearest to a spot."""
    cx, cy, _ = place.centre
    cos, sin = math.cos(place.yaw), math.sin(place.yaw)
    dx, dy, w, d = spot[0] - cx, spot[1] - cy, place.size[0] / 2.0, place.size[1] / 2.0
    x, y = max(-w, min(w, dx * cos + dy * sin)), max(-d, min(d, dy * cos - dx * sin))
    return cx + x * cos - y * sin, cy + x * sin + y * cos


def _assumed_place(point: Vec3) -> KnownPlace:
    size = (_UNKNOWN_SIZE_M, _UNKNOWN_SIZE_M, 0.0)
    return KnownPlace(id="", kind="", centre=point, size=size, yaw=0.0)
