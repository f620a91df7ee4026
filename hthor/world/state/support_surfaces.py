"""Surfaces of furniture in the house frame: which objects lie on them, and where another object fits.

The surface of a drawer moves with it; see `SupportSurfaces.pull`.
"""

import math
from collections.abc import Iterable, Iterator
from typing import Any

import msgspec
import numpy as np
from msgspec import Struct

from hthor import catalog, rules
from hthor.geometry import plane
from hthor.types import Joint, Thing, Vec2, Vec3

_SINK_M = 0.03
"""[m] How far the lowest point of a round or tilted object may be below the surface that it lies on."""
_GAP_M = 0.005
"""[m] Gap kept free on every side of an object that is put down, and the height from which it is released."""


class SupportSurface(Struct, frozen=True, kw_only=True):
    """A surface of ``thing``: its ``centre`` [m], house frame, and half extents [m] along axes turned by ``yaw``.

    ``pull`` [m], house frame, is the displacement of its drawer when fully open; zero for a fixed surface.
    """

    thing: str
    centre: Vec3
    half: Vec2
    yaw: float
    clearance: float
    inside: bool
    pull: Vec3 = (0.0, 0.0, 0.0)

    @property
    def slides(self) -> bool:
        """Whether the surface is in a drawer."""
        return self.pull != (0.0, 0.0, 0.0)

    def distance(self, x: float, y: float) -> float:
        """Horizontal distance [m] from a point of the house to the nearest point of the surface."""
        size = (2 * self.half[0], 2 * self.half[1])
        return plane.distance_to_rectangle((x, y), self.centre[:2], size, self.yaw)

    def holds(self, position: Vec3, height: float) -> bool:
        """Whether an object ``height`` [m] tall with its centre at ``position`` lies on it, directly or not."""
        gap = position[2] - height / 2 - self.centre[2]
        return -_SINK_M <= gap <= self.clearance and self.distance(*position[:2]) == 0.0


class SupportSurfaces:
    """Every surface of the given things, in the order of the things."""

    def __init__(self, things: Iterable[Thing]) -> None:
        self._closed: dict[str, tuple[SupportSurface, ...]] = {}
        for thing in things:
            found = tuple(_surfaces_of(thing))
            if found:
                self._closed[thing.id] = found
        self.reset()

    def reset(self) -> None:
        """Close all drawers."""
        self._by_thing = dict(self._closed)
        rows = [(*p.centre, *p.half, math.cos(p.yaw), math.sin(p.yaw), p.clearance) for p in self.all()]
        self._rows = np.array(rows).reshape(-1, 8)
        self._owners = [place.thing for place in self.all()]

    def all(self) -> Iterator[SupportSurface]:
        """Every surface."""
        return (place for places in self._by_thing.values() for place in places)

    def of(self, thing: str) -> tuple[SupportSurface, ...]:
        """The thing's surfaces; empty for a thing that is not a receptacle."""
        return self._by_thing.get(thing, ())

    def pull(self, thing: str, share: float) -> None:
        """Pull the thing's drawers out by a share of their travel, 0 to 1."""
        pulled = tuple(_pulled_out(place, share) for place in self._closed.get(thing, ()))
        if any(place.slides for place in pulled):
            self._by_thing[thing] = pulled
            first = self._owners.index(thing)
            self._rows[first : first + len(pulled), :3] = [place.centre for place in pulled]

    def support(self, position: Vec3, height: float) -> str:
        """The thing on whose surface an object rests, directly or on top of others; empty on the floor.

        Args:
            position: [m] the object's centre. height: [m] of the object.
        """
        if not self._owners:
            return ""
        x, y, z, half_x, half_y, cos, sin, clearance = self._rows.T
        dx, dy, gap = position[0] - x, position[1] - y, position[2] - height / 2 - z
        over = (np.abs(cos * dx + sin * dy) <= half_x) & (np.abs(cos * dy - sin * dx) <= half_y)
        gap = np.where(over & (gap >= -_SINK_M) & (gap <= clearance), gap, math.inf)
        best = int(np.argmin(gap))
        return self._owners[best] if gap[best] < math.inf else ""


def free_spots(place: SupportSurface, size: Vec3, boxes: tuple[Any, Any], near: Vec3) -> list[Vec3]:
    """Centres [m] where an object of ``size`` fits on the surface, aligned with it, nearest to ``near`` first.

    Args:
        boxes: centres (M, 3) and half extents (M, 3) [m] of upright boxes that are in the way.
        near: [m], house frame; only x and y are used.
    """
    half = (size[0] / 2, size[1] / 2)
    spare = (place.half[0] - half[0], place.half[1] - half[1])
    if min(spare) < 0.0 or size[2] + _GAP_M > place.clearance:
        return []
    wanted = plane.to_local(near, place.centre, place.yaw)
    us, vs = (_grid_line(reach, aim) for reach, aim in zip(spare, wanted[:2], strict=True))
    u, v = (axis.ravel() for axis in np.meshgrid(us, vs, indexing="ij"))
    free = ~_is_covered(place, u, v, half, size[2], boxes)
    order = np.argsort(np.round(np.hypot(u - wanted[0], v - wanted[1]), 6), kind="stable")
    z = place.centre[2] + size[2] / 2 + _GAP_M
    return [(*_to_house_xy(place, float(u[k]), float(v[k])), z) for k in order if free[k]]


def _surfaces_of(thing: Thing) -> Iterator[SupportSurface]:
    kind = catalog.kind(thing.kind)
    slides = {joint.name: joint for joint in kind.joints(thing.size) if joint.kind == "slide"}
    for surface in kind.surfaces(thing.size):
        yield SupportSurface(
            thing=thing.id,
            centre=plane.to_house(surface.centre, thing.centre, thing.yaw),
            half=surface.half,
            yaw=thing.yaw,
            clearance=surface.clearance,
            inside=surface.inside,
            pull=_pull_vector(slides.get(surface.moves), thing.yaw),
        )


def _pull_vector(joint: Joint | None, yaw: float) -> Vec3:
    if joint is None:
        return (0.0, 0.0, 0.0)
    x, y = plane.turn((joint.axis[0] * joint.travel, joint.axis[1] * joint.travel), yaw)
    return (x, y, joint.axis[2] * joint.travel)


def _pulled_out(place: SupportSurface, share: float) -> SupportSurface:
    if not place.slides:
        return place
    x, y, z = (at + share * pull for at, pull in zip(place.centre, place.pull, strict=True))
    return msgspec.structs.replace(place, centre=(x, y, z))


def _grid_line(reach: float, aim: float) -> Any:
    """Grid points along one axis, with the wanted coordinate ``aim`` among them if it is within ``reach``."""
    count = math.floor(reach / rules.GRID_M + 1e-9)
    line = np.arange(-count, count + 1) * rules.GRID_M
    return np.sort(np.append(line, aim)) if abs(aim) <= reach else line


def _is_covered(place: SupportSurface, u: Any, v: Any, half: Vec2, height: float, boxes: tuple[Any, Any]) -> Any:
    """(N,) bool, the local positions at which the object would touch one of the boxes."""
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


def _to_house_xy(place: SupportSurface, u: float, v: float) -> Vec2:
    x, y = plane.turn((u, v), place.yaw)
    return (place.centre[0] + x, place.centre[1] + y)
