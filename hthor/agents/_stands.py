"""Where a body can stand to have something in reach, and the shortest way there; knows nothing of why."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from hthor import geometry
from hthor.types import Thing, Vec2, Vec3

_MISS_M = 0.3


class Ways(Protocol):
    """A house as one body knows it."""

    def stands(self, spot: Vec2) -> bool: ...
    def fits(self, a: Vec2, b: Vec2) -> bool: ...
    def lengths(self, here: Vec2, spots: Sequence[Vec2]) -> Sequence[float]: ...
    def way(self, here: Vec2, spot: Vec2) -> tuple[Vec2, ...]: ...
    def retreat(self, here: Vec2, point: Vec2, apart_m: float) -> tuple[Vec2, ...]: ...
    def loose(self, here: Vec2) -> Vec2: ...
    def open_to(self, spot: Vec2, edge: Vec2) -> bool: ...
    def sees(self, spot: Vec2, point: Vec3) -> bool: ...


def route(
    ways: Ways,
    here: Vec2,
    points: Sequence[Vec3],
    reach: float,
    holder: Thing | None = None,
    front: bool = False,
    but: Sequence[Vec2] = (),
    grid_m: float = 0.12,
) -> tuple[Vec2, ...]:
    """The shortest way to a spot from which one of the points is at most ``reach`` [m] away; () when there is none.

    Args:
        holder: the furniture that the points belong to: no wall may be between it and the spot.
        front: the spot must lie in front of the holder, where its door is.
        but: spots that turned out to be no good; nothing within 0.3 m of them is proposed.
        grid_m: how far the spots that are looked at lie apart [m].
    """
    spots = [
        spot
        for spot in _lattice(np.array([point[:2] for point in points]), reach, grid_m)
        if not (front and holder is not None and not _in_front(holder, spot, reach))
        and all(math.dist(spot, miss) > _MISS_M for miss in but)
        and ways.stands(spot)
    ]
    lengths = ways.lengths(here, spots) if spots else ()
    order = sorted((round(length, 6), number) for number, length in enumerate(lengths) if math.isfinite(length))
    for _, number in order:
        spot = spots[number]
        point = nearest(points, spot)
        if ways.open_to(spot, point[:2] if holder is None else edge(holder, spot)) and ways.sees(spot, point):
            return ways.way(here, spot)
    return ()


def nearest(points: Sequence[Vec3], spot: Vec2) -> Vec3:
    """The one of the points that is nearest to a spot on the plan, the first of equals."""
    return min(points, key=lambda point: round(math.dist(point[:2], spot), 6))


def edge(thing: Thing, spot: Vec2) -> Vec2:
    """The point of a thing's outline, or inside it, that is nearest to a spot."""
    u, v, _ = geometry.to_local((*spot, 0.0), thing.centre, thing.yaw)
    w, d = thing.size[0] / 2, thing.size[1] / 2
    x, y, _ = geometry.to_house((max(-w, min(w, u)), max(-d, min(d, v)), 0.0), thing.centre, thing.yaw)
    return (x, y)


def gap(thing: Thing, spot: Vec2) -> float:
    """Distance [m] from a spot to a thing's outline."""
    return geometry.distance_to_rectangle(spot, thing.centre[:2], thing.size[:2], thing.yaw)


def _lattice(points: Any, reach: float, grid_m: float) -> list[Vec2]:
    """Spots of a square lattice within reach of any of the points (N, 2) [m], row by row."""
    low, high = np.ceil((points.min(0) - reach) / grid_m), np.floor((points.max(0) + reach) / grid_m)
    xs, ys = (np.arange(low[axis], high[axis] + 1) * grid_m for axis in (0, 1))
    x, y = (axis.ravel() for axis in np.meshgrid(xs, ys))
    apart = np.hypot(x[:, None] - points[:, 0], y[:, None] - points[:, 1]).min(1)
    near = apart <= reach
    return list(zip(x[near].tolist(), y[near].tolist(), strict=True))


def _in_front(thing: Thing, spot: Vec2, reach: float) -> bool:
    """Whether the door is straight ahead: from the side an open leaf is in the way."""
    u, v, _ = geometry.to_local((*spot, 0.0), (*thing.centre[:2], 0.0), thing.yaw)
    return v > thing.size[1] / 2 and abs(u) < min(thing.size[0] / 2, 0.4 * reach)
