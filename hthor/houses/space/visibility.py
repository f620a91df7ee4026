"""Lines of sight in a house at rest, past the opaque parts of its walls and things."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray

from hthor.geometry import ray_casting
from hthor.houses.space import boxes, solids
from hthor.houses.space.boxes import Box
from hthor.types import HouseSpec, Thing, Vec3

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

_CLEAR = 0.5
"""Parts less opaque than this, such as glass, hide nothing."""
_NEAR_TOP = 0.4
"""Height of the point near a thing's top above its centre, as a share of the thing's height."""


class LinesOfSight:
    """Lines of sight past opaque boxes.

    Args:
        opaque: the boxes. own: for the id of a thing, the range of its own boxes among them.
    """

    def __init__(self, opaque: Sequence[Box], own: Mapping[str, tuple[int, int]] | None = None) -> None:
        self._pos = np.array([box.centre for box in opaque]).reshape(-1, 3)
        self._half = np.array([box.half for box in opaque]).reshape(-1, 3)
        self._mat = np.array([box.turn for box in opaque]).reshape(-1, 9)
        self._radius = np.sqrt((self._half**2).sum(1))
        self._own = own or {}

    def seen(self, eyes: ArrayLike, points: ArrayLike) -> Bools:
        """(N,) bool: whether each of the eyes (N, 3) [m] sees any of the points (P, 3) [m], at any distance."""
        return self._seen(eyes, points, (0, 0), first=False)

    def visible(self, thing: Thing, at: Vec3, eyes: ArrayLike) -> bool:
        """Whether any of the ``eyes`` (N, 3) [m] sees the thing, assumed to be ``at`` [m]; eyes are tried in order."""
        points = sighting_points(at, thing.size[2])
        own = self._own.get(thing.id, (0, 0))  # the parts of a thing do not hide it
        return bool(self._seen(eyes, points, own, first=True).any())

    def _seen(self, eyes: ArrayLike, points: ArrayLike, own: tuple[int, int], *, first: bool) -> Bools:
        places = np.asarray(eyes, dtype=float).reshape(-1, 3)
        targets = np.asarray(points, dtype=float).reshape(-1, 3)
        solid = (self._half, self._pos, self._mat, self._radius)
        return np.asarray(_seen(places, targets, *solid, own[0], own[1], first), dtype=bool)


def sighting_points(centre: Vec3, height: float) -> tuple[Vec3, Vec3]:
    """The points at which a thing is seen, as in the world: its centre [m], and a point near its top."""
    x, y, z = centre
    return centre, (x, y, z + _NEAR_TOP * height)


def with_all_open(house: HouseSpec) -> LinesOfSight:
    """Lines of sight in a house whose doors and drawers all stand open."""
    opaque: list[Box] = []
    own: dict[str, tuple[int, int]] = {}
    for thing in house.things:
        begin = len(opaque)
        opaque += [box for part, box in boxes.boxes_of(thing, 1.0) if part.rgba[3] >= _CLEAR]
        own[thing.id] = (begin, len(opaque))
    return LinesOfSight([*opaque, *wall_boxes(house)], own)


def wall_boxes(house: HouseSpec) -> list[Box]:
    """The walls as boxes."""
    rows = []
    for slab in solids.wall_slabs(house):
        centre = (*slab.centre, (slab.low + slab.high) / 2)
        half = (slab.size[0] / 2, slab.size[1] / 2, (slab.high - slab.low) / 2)
        rows.append(Box(centre, half, boxes.rotation((0.0, 0.0, 1.0), slab.yaw)))
    return rows


@numba.njit(cache=True)
def _seen(
    eyes: Any, points: Any, half: Any, pos: Any, mat: Any, radius: Any, skip0: int, skip1: int, first: bool
) -> Any:
    """(N,) whether each eye sees any of the points; ``first`` ends the search at the first eye that does."""
    out = np.zeros(len(eyes), dtype=np.bool_)
    reach = 0.0
    for k in range(len(eyes)):
        reach = max(reach, _distance(eyes[k], points[0]))
    for p in range(len(points)):
        reach = max(reach, _distance(points[p], points[0]))
    ids, near = np.empty(len(pos), dtype=np.int64), 0
    for g in range(len(pos)):
        if _distance(pos[g], points[0]) - radius[g] <= reach:
            ids[near] = g
            near += 1
    for k in range(len(eyes)):
        for p in range(len(points)):
            if not ray_casting.is_blocked(eyes[k], points[p], half, pos, mat, radius, ids[:near], skip0, skip1):
                out[k] = True
                if first:
                    return out
                break
    return out


@numba.njit(cache=True)
def _distance(a: Any, b: Any) -> float:
    x, y, z = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    return math.sqrt(x * x + y * y + z * z)
