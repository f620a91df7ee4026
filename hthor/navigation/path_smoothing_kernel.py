"""Compiled: smooths lattice paths (see `grid_search_kernel`)."""

import math
from typing import Any

import numba
import numpy as np

from hthor.navigation.grid_search_kernel import STEP, TIGHT


@numba.njit(
    "float64(uint8[:,::1], uint8[:,::1], boolean, float64, float64, float64, float64)", cache=True, error_model="numpy"
)
def line_cost(cells: Any, level: Any, optimistic: bool, ax: float, ay: float, bx: float, by: float) -> float:
    """Cost of the straight line between two points [cells]; negative if the body does not fit on the line."""
    ny, nx = cells.shape
    length = math.hypot(bx - ax, by - ay)
    n = int(length * 2.0) + 1
    tight = 0
    for s in range(1, n + 1):
        f = s / n
        i, j = math.floor(ax + f * (bx - ax)), math.floor(ay + f * (by - ay))
        if not (0 <= i < nx and 0 <= j < ny):
            return -1.0
        row, column = np.uint64(j), np.uint64(i)
        rank = level[row, column]
        if rank >= 2 or not (optimistic or cells[row, column] == 1):
            return -1.0
        tight += rank
    return length * (STEP + (TIGHT - STEP) * tight / n)


@numba.njit(
    "int64(uint8[:,::1], uint8[:,::1], boolean, float64[:,::1], float64[::1], int64[::1])",
    cache=True,
    error_model="numpy",
)
def pull_string(cells: Any, level: Any, optimistic: bool, points: Any, cost: Any, keep: Any) -> int:
    """Straighten a path by shortcuts that cost no more; ``keep`` is set to the indices of the remaining points.

    ``points`` (N, 2) [cells] is the path, ``cost`` (N,) the cost up to each point; returns how many points remain.
    """
    n = len(points)
    keep[0] = 0
    kept, here = 1, 0
    while here < n - 1:
        best, misses = here + 1, 0
        for k in range(here + 2, n):
            line = line_cost(cells, level, optimistic, points[here, 0], points[here, 1], points[k, 0], points[k, 1])
            spare = 100.0 if here == 0 or k == n - 1 else 30.0  # the ends may lie anywhere in their cells
            if line >= 0.0 and line <= cost[k] - cost[here] + spare:
                best, misses = k, 0
            else:
                misses += 1
                if misses > 12:
                    break
        keep[kept] = best
        kept += 1
        here = best
    return kept


@numba.njit(
    "int64(uint8[:,::1], uint8[:,::1], boolean, float64[:,::1], float64[::1], int64[::1])",
    cache=True,
    error_model="numpy",
)
def straighten(cells: Any, level: Any, optimistic: bool, points: Any, cost: Any, keep: Any) -> int:
    """Like `pull_string`, but from both ends; the result is the cheapest path over the bends of both."""
    n = len(points)
    forth, back = np.empty(n, dtype=np.int64), np.empty(n, dtype=np.int64)
    n_forth = pull_string(cells, level, optimistic, points, cost, forth)
    n_back = pull_string(cells, level, optimistic, points[::-1].copy(), cost[n - 1] - cost[::-1], back)
    bends = np.zeros(n, dtype=np.int64)  # bit 1: a bend of either path; bit 2: a bend of the forward path
    for k in range(n_back):
        bends[n - 1 - back[k]] = 1
    for k in range(n_forth):
        bends[forth[k]] = 3
    nodes = np.nonzero(bends)[0]
    m = len(nodes)
    best, before = np.full(m, 1e18), np.zeros(m, dtype=np.int64)
    best[0] = 0.0
    last = 0  # the latest bend of the forward path, from which the path always continues
    for b in range(1, m):
        j = nodes[b]
        for a in range(max(0, b - 12), b):
            i = nodes[a]
            line = line_cost(cells, level, optimistic, points[i, 0], points[i, 1], points[j, 0], points[j, 1])
            if line >= 0.0 and best[a] + line < best[b]:
                best[b], before[b] = best[a] + line, a
        i = nodes[last]
        if best[last] + cost[j] - cost[i] < best[b] and bends[j] & 2 and best[b] > 1e17:
            best[b], before[b] = best[last] + cost[j] - cost[i], last
        if bends[j] & 2:
            last = b
    count, b = 1, m - 1
    while b > 0:
        count += 1
        b = before[b]
    b = m - 1
    for k in range(count - 1, -1, -1):
        keep[k] = nodes[b]
        b = before[b]
    return count


@numba.njit("int64(uint8[:,::1], uint8[:,::1], boolean, float64[:,::1], int64)", cache=True)
def tighten(cells: Any, level: Any, optimistic: bool, points: Any, n: int) -> int:
    """Move every bend of a path towards the line between its neighbours while the cost falls; drop needless bends.

    ``points`` (N, 2) [cells] is changed in place; its first ``n`` rows are the path. Returns how many rows are left.
    """
    for _ in range(6):
        changed = False
        k = 1
        while k < n - 1:
            ax, ay = points[k - 1, 0], points[k - 1, 1]
            bx, by = points[k, 0], points[k, 1]
            cx, cy = points[k + 1, 0], points[k + 1, 1]
            first = line_cost(cells, level, optimistic, ax, ay, bx, by)
            second = line_cost(cells, level, optimistic, bx, by, cx, cy)
            now = first + second if first >= 0.0 and second >= 0.0 else 1e18
            ex, ey = cx - ax, cy - ay
            t = ((bx - ax) * ex + (by - ay) * ey) / max(ex * ex + ey * ey, 1e-12)
            t = min(1.0, max(0.0, t))
            mx, my = ax + t * ex, ay + t * ey
            whole = line_cost(cells, level, optimistic, ax, ay, cx, cy)
            if 0.0 <= whole <= now + 1.0:
                for j in range(k, n - 1):
                    points[j, 0], points[j, 1] = points[j + 1, 0], points[j + 1, 1]
                n -= 1
                changed = True
                continue
            for share in (0.6, 0.3, 0.15):
                px, py = bx + share * (mx - bx), by + share * (my - by)
                first = line_cost(cells, level, optimistic, ax, ay, px, py)
                if first < 0.0:
                    continue
                second = line_cost(cells, level, optimistic, px, py, cx, cy)
                if second >= 0.0 and first + second < now - 0.5:
                    points[k, 0], points[k, 1] = px, py
                    changed = True
                    break
            k += 1
        if not changed:
            break
    return n
