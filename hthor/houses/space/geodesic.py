"""Exact shortest paths of a body's axis through the free cells of a grid.

Free cells are open squares, so a shortest path is straight except for bends at the corners of blocked cells. The graph
joins corners that see one another and at which a taut string could bend; a query adds its two ends.
"""

from __future__ import annotations

import functools
import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hthor.houses.space import visibility_graph_kernel
from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.grid_kernel import label_at
from hthor.types import HouseSpec, Vec2

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Geodesics:
    """Shortest paths in one free space.

    A place that is not free cannot be reached; use ``FreeSpace.nearest_free`` first. Lengths are exact up to
    rounding, so ``distance(a, b)`` and ``distance(b, a)`` may differ in the last digits.
    """

    def __init__(self, space: FreeSpace) -> None:
        self.space = space
        self._corners, self._signs = visibility_graph_kernel.find_corners(space.free)
        self._start, self._end, self._length = visibility_graph_kernel.graph_edges(
            space.free, self._corners, self._signs
        )
        self._from = functools.lru_cache(maxsize=64)(lambda a: self.field([a]))

    @staticmethod
    @functools.lru_cache(maxsize=32)
    def of(space: FreeSpace) -> Geodesics:
        """The same as the constructor, computed once per process for each free space."""
        return Geodesics(space)

    def field(self, sources: ArrayLike, costs: ArrayLike | None = None) -> DistanceField:
        """Distances from the nearest of several places.

        Args:
            sources: (K, 2) [m] house frame. costs: (K,) [m] initial cost at each source; default 0.
        """
        points = np.asarray(sources, dtype=float).reshape(-1, 2)
        first = np.zeros(len(points)) if costs is None else np.asarray(costs, dtype=float)
        return DistanceField(self, points, first)

    def distance(self, a: Vec2, b: Vec2) -> float:
        """Length [m] of the shortest path; inf if there is no path."""
        return float(self._from((float(a[0]), float(a[1]))).at([b])[0])

    def distances(self, a: Vec2, points: ArrayLike) -> Floats:
        """(N,) [m] lengths of the shortest paths from ``a`` to each of ``points`` (N, 2); inf if there is no path."""
        return self._from((float(a[0]), float(a[1]))).at(points)

    def path(self, a: Vec2, b: Vec2) -> tuple[Vec2, ...]:
        """The way from ``a`` to ``b``, both included, with every bend between; empty if there is no path."""
        return self._from((float(a[0]), float(a[1]))).path(b)


class DistanceField:
    """Distances from a set of sources, each with an initial cost, to all places."""

    def __init__(self, owner: Geodesics, sources: Floats, costs: Floats) -> None:
        self._owner, self._sources = owner, sources
        space = owner.space
        self._free, self._labels = space.free, space.components
        self._local = (sources - space.origin) / space.cell
        self._costs = costs / space.cell
        self._reach, self._before, self._came = visibility_graph_kernel.shortest_to_corners(
            space.free, owner._corners, owner._signs, owner._start, owner._end, owner._length, self._local, self._costs
        )
        order = np.argsort(self._reach, kind="stable")
        self._order: Ints = order[np.isfinite(self._reach[order])]
        labels = [label_at(self._free, self._labels, x, y) for x, y in self._local]
        self._known = np.unique(np.array(labels, dtype=np.int64))

    def at(self, points: ArrayLike) -> Floats:
        """(N,) [m]: the least sum of cost and way to each of ``points`` (N, 2); inf if no source reaches it."""
        lengths, _ = self._query(points)
        metres: Floats = lengths * self._owner.space.cell
        return metres

    def path(self, point: Vec2) -> tuple[Vec2, ...]:
        """The way from the best source to the point, both included; empty if there is no path."""
        lengths, last = self._query([point])
        if not math.isfinite(lengths[0]):
            return ()
        way, node, space = [(float(point[0]), float(point[1]))], int(last[0]), self._owner.space
        while node >= 0:
            x, y = self._owner._corners[node]
            way.append((space.origin[0] + float(x) * space.cell, space.origin[1] + float(y) * space.cell))
            node = int(self._before[node])
        x, y = self._sources[-1 - node]
        way.append((float(x), float(y)))
        return tuple(reversed(way))

    def _query(self, points: ArrayLike) -> tuple[Floats, Ints]:
        places = (np.asarray(points, dtype=float).reshape(-1, 2) - self._owner.space.origin) / self._owner.space.cell
        answer: tuple[Floats, Ints] = visibility_graph_kernel.shortest_to_places(
            self._free,
            self._labels,
            self._owner._corners,
            self._owner._signs,
            self._order,
            self._reach,
            self._came,
            self._local,
            self._costs,
            self._known,
            places,
        )
        return answer


def house_geodesics(house: HouseSpec, radius: float, height: float = 1.8) -> Geodesics:
    """Shortest paths for a body in a house, computed once per process."""
    return Geodesics.of(FreeSpace.of(house, radius, height))
