"""Exact shortest paths of a body's axis through the free cells of a grid; knows nothing of minds or physics.

Free cells are open squares, so a shortest path is straight but for bends at the corners of blocked cells. The graph
joins those corners that see one another and where a taut string could bend; a query adds its two ends.
"""

from __future__ import annotations

import functools
import heapq
import math
from typing import Any

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray

from hthor.houses.freespace import FreeSpace, _cell, _label_at, _walk
from hthor.types import HouseSpec, Vec2

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Geodesics:
    """Shortest paths in one free space.

    A place that is not free is reached by nothing; ask ``FreeSpace.nearest_free`` first. Lengths are exact but for
    rounding, so ``distance(a, b)`` and ``distance(b, a)`` may differ in the last digits.
    """

    def __init__(self, space: FreeSpace) -> None:
        self.space = space
        self._corners, self._signs = _corners(space.free)
        self._start, self._end, self._length = _edges(space.free, self._corners, self._signs)
        self._from = functools.lru_cache(maxsize=64)(lambda a: self.field([a]))

    @staticmethod
    @functools.lru_cache(maxsize=32)
    def of(space: FreeSpace) -> Geodesics:
        """The same as the constructor, worked out once a process for one free space."""
        return Geodesics(space)

    def field(self, sources: ArrayLike, costs: ArrayLike | None = None) -> Field:
        """Distances from the nearest of several places.

        Args:
            sources: (K, 2) [m] house frame. costs: (K,) [m] what it costs to be at each to begin with; default none.
        """
        points = np.asarray(sources, dtype=float).reshape(-1, 2)
        first = np.zeros(len(points)) if costs is None else np.asarray(costs, dtype=float)
        return Field(self, points, first)

    def distance(self, a: Vec2, b: Vec2) -> float:
        """Length [m] of the shortest path; inf where there is none."""
        return float(self._from((float(a[0]), float(a[1]))).at([b])[0])

    def distances(self, a: Vec2, points: ArrayLike) -> Floats:
        """(N,) [m] lengths of the shortest paths from ``a`` to each of ``points`` (N, 2); inf where there is none."""
        return self._from((float(a[0]), float(a[1]))).at(points)

    def path(self, a: Vec2, b: Vec2) -> tuple[Vec2, ...]:
        """The way from ``a`` to ``b``, both included, with every bend between; empty where there is none."""
        return self._from((float(a[0]), float(a[1]))).path(b)


class Field:
    """Distance to everywhere from a set of sources, each with a cost to begin with."""

    def __init__(self, owner: Geodesics, sources: Floats, costs: Floats) -> None:
        self._owner, self._sources = owner, sources
        space = owner.space
        self._free, self._labels = space.free, space.components
        self._local = (sources - space.origin) / space.cell
        self._costs = costs / space.cell
        self._reach, self._before, self._came = _spread(
            space.free, owner._corners, owner._signs, owner._start, owner._end, owner._length, self._local, self._costs
        )
        order = np.argsort(self._reach, kind="stable")
        self._order: Ints = order[np.isfinite(self._reach[order])]
        labels = [_label_at(self._free, self._labels, x, y) for x, y in self._local]
        self._known = np.unique(np.array(labels, dtype=np.int64))

    def at(self, points: ArrayLike) -> Floats:
        """(N,) [m]: the least of cost and way to each of ``points`` (N, 2); inf where no source reaches it."""
        lengths, _ = self._query(points)
        metres: Floats = lengths * self._owner.space.cell
        return metres

    def path(self, point: Vec2) -> tuple[Vec2, ...]:
        """The way from the best source to the point, both included; empty where there is none."""
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
        answer: tuple[Floats, Ints] = _reach(
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


def geodesics(house: HouseSpec, radius: float, height: float = 1.8) -> Geodesics:
    """Shortest paths for a body in a house, worked out once a process."""
    return Geodesics.of(FreeSpace.of(house, radius, height))


# ------------------------------------------------------------------------------- compiled; lengths below are in cells


@numba.njit(cache=True)
def _corners(free: Any) -> Any:
    """Grid vertices with just one blocked neighbour: (N, 2) int64 places, (N, 2) int64 signs towards that cell."""
    ny, nx = free.shape
    places, signs = np.empty((ny * nx, 2), np.int64), np.empty((ny * nx, 2), np.int64)
    n = 0
    for y in range(1, ny):
        for x in range(1, nx):
            blocked = 0
            for sy in (-1, 1):
                for sx in (-1, 1):
                    if not _cell(free, x + (sx - 1) // 2, y + (sy - 1) // 2):
                        blocked += 1
                        signs[n, 0], signs[n, 1] = sx, sy
            if blocked == 1:
                places[n, 0], places[n, 1] = x, y
                n += 1
    return places[:n].copy(), signs[:n].copy()


@numba.njit(cache=True)
def _taut(signs: Any, k: int, vx: float, vy: float) -> bool:
    """Whether a string from corner ``k`` along v can bend there: v does not point away from the blocked cell."""
    return not (vx * signs[k, 0] < 0.0 and vy * signs[k, 1] < 0.0)


@numba.njit(cache=True)
def _bends(signs: Any, k: int, ux: float, uy: float, vx: float, vy: float) -> bool:
    """Whether a string that comes to corner ``k`` along u and leaves along v bends round the blocked cell, or not."""
    turn = ux * vy - uy * vx
    side = ux * signs[k, 1] - uy * signs[k, 0]
    return turn * side >= 0.0 or turn * turn <= 1e-18 * (ux * ux + uy * uy) * (vx * vx + vy * vy)


@numba.njit(cache=True)
def _edges(free: Any, corners: Any, signs: Any) -> Any:
    """The graph in compressed rows: (N + 1,) first edge of each corner, (E,) where it leads, (E,) how long it is."""
    n = len(corners)
    one, two = [0], [0]
    one.pop()
    two.pop()
    degree = np.zeros(n + 1, np.int64)
    for i in range(n):
        for j in range(i + 1, n):
            vx, vy = float(corners[j, 0] - corners[i, 0]), float(corners[j, 1] - corners[i, 1])
            if not (_taut(signs, i, vx, vy) and _taut(signs, j, -vx, -vy)):
                continue
            if (
                _walk(free, float(corners[i, 0]), float(corners[i, 1]), float(corners[j, 0]), float(corners[j, 1]))
                >= 1.0
            ):
                one.append(i)
                two.append(j)
                degree[i + 1] += 1
                degree[j + 1] += 1
    start = np.cumsum(degree)
    end, length, fill = np.empty(start[n], np.int64), np.empty(start[n], np.float64), start[:-1].copy()
    for k in range(len(one)):
        i, j = one[k], two[k]
        span = math.hypot(float(corners[j, 0] - corners[i, 0]), float(corners[j, 1] - corners[i, 1]))
        end[fill[i]], length[fill[i]] = j, span
        end[fill[j]], length[fill[j]] = i, span
        fill[i] += 1
        fill[j] += 1
    return start, end, length


@numba.njit(cache=True)
def _spread(free: Any, corners: Any, signs: Any, start: Any, end: Any, length: Any, sources: Any, costs: Any) -> Any:
    """Dijkstra's algorithm from the sources: (N,) lengths, (N,) corner before or -1 - source, (N, 2) way from it."""
    n = len(corners)
    reach, before, came = np.full(n, np.inf), np.full(n, -1, np.int64), np.zeros((n, 2))
    heap = [(0.0, 0)]
    heap.pop()
    for i in range(n):
        for s in range(len(sources)):
            vx, vy = sources[s, 0] - corners[i, 0], sources[s, 1] - corners[i, 1]
            whole = costs[s] + math.hypot(vx, vy)
            if whole >= reach[i] or not _taut(signs, i, vx, vy):
                continue
            if _walk(free, sources[s, 0], sources[s, 1], float(corners[i, 0]), float(corners[i, 1])) >= 1.0:
                reach[i], before[i] = whole, -1 - s
                came[i, 0], came[i, 1] = -vx, -vy
        if reach[i] < np.inf:
            heapq.heappush(heap, (reach[i], i))
    while len(heap):
        whole, i = heapq.heappop(heap)
        if whole > reach[i]:
            continue
        for e in range(start[i], start[i + 1]):
            j, longer = end[e], whole + length[e]
            if longer < reach[j]:
                vx, vy = float(corners[j, 0] - corners[i, 0]), float(corners[j, 1] - corners[i, 1])
                if _bends(signs, i, came[i, 0], came[i, 1], vx, vy):
                    reach[j], before[j] = longer, i
                    came[j, 0], came[j, 1] = vx, vy
                    heapq.heappush(heap, (longer, j))
    return reach, before, came


@numba.njit(cache=True)
def _reach(
    free: Any,
    labels: Any,
    corners: Any,
    signs: Any,
    order: Any,
    reach: Any,
    came: Any,
    sources: Any,
    costs: Any,
    known: Any,
    places: Any,
) -> Any:
    """For each place the least length, and the corner before it, or -1 - source."""
    n = len(places)
    best, last = np.full(n, np.inf), np.full(n, -1, np.int64)
    for p in range(n):
        x, y = places[p, 0], places[p, 1]
        label = _label_at(free, labels, x, y)
        met = False
        for k in known:
            met = met or (label > 0 and k == label)
        if not met:
            continue
        for s in range(len(sources)):
            whole = costs[s] + math.hypot(sources[s, 0] - x, sources[s, 1] - y)
            if whole < best[p] and _walk(free, sources[s, 0], sources[s, 1], x, y) >= 1.0:
                best[p], last[p] = whole, -1 - s
        for i in order:
            if reach[i] >= best[p]:
                break
            vx, vy = x - corners[i, 0], y - corners[i, 1]
            whole = reach[i] + math.hypot(vx, vy)
            if whole >= best[p] or not _taut(signs, i, vx, vy) or not _bends(signs, i, came[i, 0], came[i, 1], vx, vy):
                continue
            if _walk(free, float(corners[i, 0]), float(corners[i, 1]), x, y) >= 1.0:
                best[p], last[p] = whole, i
    return best, last
