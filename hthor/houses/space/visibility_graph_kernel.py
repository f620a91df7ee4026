"""Compiled search for taut strings among the corners of blocked cells.

A corner is a grid vertex with just one blocked neighbour: the only places where a shortest path bends. Coordinates and
lengths are in cells, as in `grid_kernel`.
"""

import heapq
import math
from typing import Any

import numba
import numpy as np

from hthor.houses.space.grid_kernel import free_share, is_open, label_at


@numba.njit(cache=True)
def find_corners(free: Any) -> Any:
    """Grid vertices with just one blocked neighbour: (N, 2) int64 places, (N, 2) int64 signs towards that cell."""
    ny, nx = free.shape
    places, signs = np.empty((ny * nx, 2), np.int64), np.empty((ny * nx, 2), np.int64)
    n = 0
    for y in range(1, ny):
        for x in range(1, nx):
            blocked = 0
            for sy in (-1, 1):
                for sx in (-1, 1):
                    if not is_open(free, x + (sx - 1) // 2, y + (sy - 1) // 2):
                        blocked += 1
                        signs[n, 0], signs[n, 1] = sx, sy
            if blocked == 1:
                places[n, 0], places[n, 1] = x, y
                n += 1
    return places[:n].copy(), signs[:n].copy()


@numba.njit(cache=True)
def can_bend(signs: Any, k: int, vx: float, vy: float) -> bool:
    """Whether a string from corner ``k`` along v can bend at ``k``: v does not point away from the blocked cell."""
    return not (vx * signs[k, 0] < 0.0 and vy * signs[k, 1] < 0.0)


@numba.njit(cache=True)
def turns_round(signs: Any, k: int, ux: float, uy: float, vx: float, vy: float) -> bool:
    """Whether a string that comes to corner ``k`` along u and leaves along v is straight or bends around the cell."""
    turn = ux * vy - uy * vx
    side = ux * signs[k, 1] - uy * signs[k, 0]
    return turn * side >= 0.0 or turn * turn <= 1e-18 * (ux * ux + uy * uy) * (vx * vx + vy * vy)


@numba.njit(cache=True)
def graph_edges(free: Any, corners: Any, signs: Any) -> Any:
    """The graph in compressed rows: (N + 1,) first edge of each corner, (E,) end of each edge, (E,) its length."""
    n = len(corners)
    one, two = [0], [0]
    one.pop()
    two.pop()
    degree = np.zeros(n + 1, np.int64)
    for i in range(n):
        for j in range(i + 1, n):
            vx, vy = float(corners[j, 0] - corners[i, 0]), float(corners[j, 1] - corners[i, 1])
            if not (can_bend(signs, i, vx, vy) and can_bend(signs, j, -vx, -vy)):
                continue
            if (
                free_share(free, float(corners[i, 0]), float(corners[i, 1]), float(corners[j, 0]), float(corners[j, 1]))
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
def shortest_to_corners(
    free: Any, corners: Any, signs: Any, start: Any, end: Any, length: Any, sources: Any, costs: Any
) -> Any:
    """Dijkstra's algorithm: (N,) lengths, (N,) previous corner or -1 - source, (N, 2) step from that place."""
    n = len(corners)
    reach, before, came = np.full(n, np.inf), np.full(n, -1, np.int64), np.zeros((n, 2))
    heap = [(0.0, 0)]
    heap.pop()
    for i in range(n):
        for s in range(len(sources)):
            vx, vy = sources[s, 0] - corners[i, 0], sources[s, 1] - corners[i, 1]
            whole = costs[s] + math.hypot(vx, vy)
            if whole >= reach[i] or not can_bend(signs, i, vx, vy):
                continue
            if free_share(free, sources[s, 0], sources[s, 1], float(corners[i, 0]), float(corners[i, 1])) >= 1.0:
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
                if turns_round(signs, i, came[i, 0], came[i, 1], vx, vy):
                    reach[j], before[j] = longer, i
                    came[j, 0], came[j, 1] = vx, vy
                    heapq.heappush(heap, (longer, j))
    return reach, before, came


@numba.njit(cache=True)
def shortest_to_places(
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
    """For each place, the least length, and the previous corner or -1 - source."""
    n = len(places)
    best, last = np.full(n, np.inf), np.full(n, -1, np.int64)
    for p in range(n):
        x, y = places[p, 0], places[p, 1]
        label = label_at(free, labels, x, y)
        met = False
        for k in known:
            met = met or (label > 0 and k == label)
        if not met:
            continue
        for s in range(len(sources)):
            whole = costs[s] + math.hypot(sources[s, 0] - x, sources[s, 1] - y)
            if whole < best[p] and free_share(free, sources[s, 0], sources[s, 1], x, y) >= 1.0:
                best[p], last[p] = whole, -1 - s
        for i in order:
            if reach[i] >= best[p]:
                break
            vx, vy = x - corners[i, 0], y - corners[i, 1]
            whole = reach[i] + math.hypot(vx, vy)
            if (
                whole >= best[p]
                or not can_bend(signs, i, vx, vy)
                or not turns_round(signs, i, came[i, 0], came[i, 1], vx, vy)
            ):
                continue
            if free_share(free, float(corners[i, 0]), float(corners[i, 1]), x, y) >= 1.0:
                best[p], last[p] = whole, i
    return best, last
