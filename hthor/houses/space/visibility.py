"""What a standing person can see of a house at rest, its doors and drawers open."""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from hthor.geometry import ray_casting
from hthor.houses.space import boxes, solids
from hthor.types import HouseSpec, Thing, Vec3

Floats = NDArray[np.float64]

_CLEAR = 0.5
"""What is less opaque than this, glass, hides nothing."""
_NEAR_TOP = 0.4
"""A thing is looked for at its centre and this share of its height above it, as the world does."""


class LinesOfSight:
    """Lines of sight through every opaque part of a house's walls and things, everything that opens standing open."""

    def __init__(self, house: HouseSpec) -> None:
        rows: list[tuple[Vec3, Vec3, Floats]] = []
        self._span: dict[str, tuple[int, int]] = {}
        for thing in house.things:
            begin = len(rows)
            rows += [
                (box.centre, box.half, box.turn) for part, box in boxes.boxes_of(thing, 1.0) if part.rgba[3] >= _CLEAR
            ]
            self._span[thing.id] = (begin, len(rows))
        for slab in solids.wall_slabs(house):
            centre = (*slab.centre, (slab.low + slab.high) / 2)
            half = (slab.size[0] / 2, slab.size[1] / 2, (slab.high - slab.low) / 2)
            rows.append((centre, half, boxes.rotation((0.0, 0.0, 1.0), slab.yaw)))
        self._pos = np.array([row[0] for row in rows]).reshape(-1, 3)
        self._half = np.array([row[1] for row in rows]).reshape(-1, 3)
        self._mat = np.array([row[2] for row in rows]).reshape(-1, 9)
        self._radius = np.sqrt((self._half**2).sum(1))

    def visible(self, thing: Thing, at: Vec3, eyes: Floats) -> bool:
        """Whether any of the ``eyes`` (N, 3) [m] sees the thing, taken to be ``at`` [m]; the first are tried first."""
        points = np.array([at, (at[0], at[1], at[2] + _NEAR_TOP * thing.size[2])])
        if not len(eyes):
            return False
        own = self._span.get(thing.id, (0, 0))  # what is no part of the house hides nothing
        return bool(_seen(eyes, points, self._half, self._pos, self._mat, self._radius, own[0], own[1]))


@numba.njit(cache=True)
def _seen(eyes: Any, points: Any, half: Any, pos: Any, mat: Any, radius: Any, skip0: int, skip1: int) -> bool:
    reach = 0.0
    for k in range(len(eyes)):
        reach = max(reach, _apart(eyes[k], points[0]))
    ids, near = np.empty(len(pos), dtype=np.int64), 0
    for g in range(len(pos)):
        if _apart(pos[g], points[0]) - radius[g] <= reach:
            ids[near] = g
            near += 1
    for k in range(len(eyes)):
        for p in range(len(points)):
            if not ray_casting.is_blocked(eyes[k], points[p], half, pos, mat, radius, ids[:near], skip0, skip1):
                return True
    return False


@numba.njit(cache=True)
def _apart(a: Any, b: Any) -> float:
    x, y, z = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    return math.sqrt(x * x + y * y + z * z)
