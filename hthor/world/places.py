"""Surfaces of a house in the house frame: what lies on which, and where one more thing fits; knows nothing of hands."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import catalog, geometry, rules
from hthor.types import Thing, Vec2, Vec3

_SINK_M = 0.03
"""How far below a surface the underside of what lies on it may be."""
_GAP_M = 0.005
"""Free air kept on every side of what is put down, and the height from which it is let go."""


class Place(Struct, frozen=True, kw_only=True):
    """A surface of ``thing``: ``centre`` [m] house frame, ``half`` [m] along local axes that are turned by ``yaw``."""

    thing: str
    centre: Vec3
    half: Vec2
    yaw: float
    clearance: float
    inside: bool

    def distance(self, x: float, y: float) -> float:
        """Horizontal distance [m] from a point of the house to the nearest point of the surface."""
        size = (2 * self.half[0], 2 * self.half[1])
        return geometry.distance_to_rectangle((x, y), self.centre[:2], size, self.yaw)


class Places:
    """Every surface of the things given, in their order."""

    def __init__(self, things: Iterable[Thing]) -> None:
        self._by_thing: dict[str, tuple[Place, ...]] = {}
        for thing in things:
            found = tuple(_places(thing))
            if found:
                self._by_thing[thing.id] = found

    def of(self, thing: str) -> tuple[Place, ...]:
        """The thing's surfaces, none for what is no receptacle."""
        return self._by_thing.get(thing, ())

    def support(self, position: Vec3, height: float) -> str:
        """The thing on whose surface an object rests, directly or on top of others; empty on the floor.

        Args:
            position: [m] the object's centre. height: [m] how tall it is.
        """
        best, least = "", math.inf
        for thing, places in self._by_thing.items():
            for place in places:
                gap = position[2] - height / 2 - place.centre[2]
                if -_SINK_M <= gap <= place.clearance and gap < least and place.distance(*position[:2]) == 0.0:
                    best, least = thing, gap
        return best


def candidates(place: Place, size: Vec3, boxes: tuple[Any, Any], near: Vec3) -> list[Vec3]:
    """Centres [m] where an object of ``size`` fits on the surface, aligned with it, nearest to ``near`` first.

    Args:
        boxes: centres (M, 3) and half extents (M, 3) [m] of upright boxes that are in the way.
        near: [m] house frame; only its x and y count.
    """
    half = (size[0] / 2, size[1] / 2)
    spare = (place.half[0] - half[0], place.half[1] - half[1])
    if min(spare) < 0.0 or size[2] + _GAP_M > place.clearance:
        return []
    wanted = geometry.to_local(near, place.centre, place.yaw)
    us, vs = (_line(reach, aim) for reach, aim in zip(spare, wanted[:2], strict=True))
    u, v = (axis.ravel() for axis in np.meshgrid(us, vs, indexing="ij"))
    free = ~_covered(place, u, v, half, size[2], boxes)
    order = np.argsort(np.round(np.hypot(u - wanted[0], v - wanted[1]), 6), kind="stable")
    z = place.centre[2] + size[2] / 2 + _GAP_M
    return [(*_xy(place, float(u[k]), float(v[k])), z) for k in order if free[k]]


def _places(thing: Thing) -> Iterator[Place]:
    for surface in catalog.kind(thing.kind).surfaces(thing.size):
        yield Place(
            thing=thing.id,
            centre=geometry.to_house(surface.centre, thing.centre, thing.yaw),
            half=surface.half,
            yaw=thing.yaw,
            clearance=surface.clearance,
            inside=surface.inside,
        )


def _line(reach: float, aim: float) -> Any:
    """Grid points along one axis and, between them, the wanted coordinate itself when it is within reach."""
    count = math.floor(reach / rules.GRID_M + 1e-9)
    line = np.arange(-count, count + 1) * rules.GRID_M
    return np.sort(np.append(line, aim)) if abs(aim) <= reach else line


def _covered(place: Place, u: Any, v: Any, half: Vec2, height: float, boxes: tuple[Any, Any]) -> Any:
    """(N,) bool: which local positions would touch one of the boxes."""
    centres, extents = boxes
    low = place.centre[2]
    tall = (centres[:, 2] + extents[:, 2] > low + 1e-3) & (centres[:, 2] - extents[:, 2] < low + height + 2 * _GAP_M)
    centres, extents = centres[tall], extents[tall]
    cos, sin = math.cos(place.yaw), math.sin(place.yaw)
    dx, dy = centres[:, 0] - place.centre[0], centres[:, 1] - place.centre[1]
    bu, bv = cos * dx + sin * dy, cos * dy - sin * dx
    eu = abs(cos) * extents[:, 0] + abs(sin) * extents[:, 1] + half[0] + _GAP_M
    ev = abs(sin) * extents[:, 0] + abs(cos) * extents[:, 1] + half[1] + _GAP_M
    touching = (np.abs(u[:, None] - bu) < eu) & (np.abs(v[:, None] - bv) < ev)
    return touching.any(axis=1)


def _xy(place: Place, u: float, v: float) -> Vec2:
    x, y = geometry.turn((u, v), place.yaw)
    return (place.centre[0] + x, place.centre[1] + y)
