"""What hides what in a house at rest: walls and furniture against lines of sight."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from typing import Any

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray

from hthor import catalog
from hthor.geometry import ray_casting
from hthor.geometry.plane import to_house
from hthor.houses.space import solids
from hthor.types import HouseSpec, Vec3

Bools = NDArray[np.bool_]
Box = tuple[Vec3, Vec3, float]
"""Centre, half extents [m] and yaw of an upright box, house frame."""


class LinesOfSight:
    """Lines of sight in a house, through every opaque part of its walls and furniture.

    Args:
        house: the floor plan.
        opened: ids of things whose doors are taken off: what one sees when they are open.
    """

    def __init__(self, house: HouseSpec, opened: frozenset[str] = frozenset()) -> None:
        boxes = [*_walls(house), *_furniture(house, opened)]
        self._pos = np.array([centre for centre, _, _ in boxes]).reshape(-1, 3)
        self._half = np.array([half for _, half, _ in boxes]).reshape(-1, 3)
        self._mat = np.array([_matrix(yaw) for _, _, yaw in boxes]).reshape(-1, 9)
        self._radius = np.sqrt((self._half**2).sum(1))

    @staticmethod
    @functools.lru_cache(maxsize=64)
    def of(house: HouseSpec, opened: frozenset[str] = frozenset()) -> LinesOfSight:
        """The same as the constructor, worked out once a process."""
        return LinesOfSight(house, opened)

    def seen(self, eyes: ArrayLike, points: ArrayLike) -> Bools:
        """(N,) bool: from which of the eyes (N, 3) [m] any of the points (P, 3) [m] can be seen, at any distance."""
        places = np.asarray(eyes, dtype=float).reshape(-1, 3)
        targets = np.asarray(points, dtype=float).reshape(-1, 3)
        spans = np.linalg.norm(self._pos - targets[0], axis=1) - self._radius
        ends = np.concatenate((places, targets))
        near = np.nonzero(spans <= np.linalg.norm(ends - targets[0], axis=1).max(initial=0.0))[0]
        return np.asarray(_seen(places, targets, self._half, self._pos, self._mat, self._radius, near), dtype=bool)


def _walls(house: HouseSpec) -> Iterator[Box]:
    for slab in solids.wall_slabs(house):
        centre = (slab.centre[0], slab.centre[1], (slab.low + slab.high) / 2)
        yield centre, (slab.size[0] / 2, slab.size[1] / 2, (slab.high - slab.low) / 2), slab.yaw


def _furniture(house: HouseSpec, opened: frozenset[str]) -> Iterator[Box]:
    for thing in house.things:
        for part in catalog.kind(thing.kind).parts(thing.size):
            if part.rgba[3] >= 1.0 and not (part.moves and thing.id in opened):
                yield to_house(part.centre, thing.centre, thing.yaw), part.half, thing.yaw


def _matrix(yaw: float) -> tuple[float, ...]:
    cos, sin = math.cos(yaw), math.sin(yaw)
    return (cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)


@numba.njit(cache=True)
def _seen(eyes: Any, points: Any, half: Any, pos: Any, mat: Any, radius: Any, ids: Any) -> Any:
    out = np.zeros(len(eyes), dtype=np.bool_)
    for k in range(len(eyes)):
        for p in range(len(points)):
            if not ray_casting.is_blocked(eyes[k], points[p], half, pos, mat, radius, ids, -1, -1):
                out[k] = True
                break
    return out
