"""Compiled: shortest paths on a grid of cells and levels (see `marching`); knows nothing of records.

Costs are whole numbers, 100 for a step of one clear cell, so that paths do not depend on rounding.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

STEP, DIAGONAL = 100, 141
TIGHT, TIGHT_DIAGONAL = 120, 169
FAR = 1 << 30
BUCKETS = 512
_CLOSED = 16

_DX = np.array([1, 0, -1, 0, 1, -1, -1, 1], dtype=np.int64)
_DY = np.array([0, 1, 0, -1, 1, 1, -1, -1], dtype=np.int64)


@numba.njit("boolean(uint8[:,::1], uint8[:,::1], boolean, int64, int64)", cache=True)
def passable(cells: Any, level: Any, optimistic: bool, row: int, column: int) -> bool:
    """Whether the body's centre may be in this cell."""
    return level[row, column] < 2 and (optimistic or cells[row, column] == 1)


@numba.njit("int64(uint8[:,::1], uint8[:,::1], boolean, int64, int64, int64)", cache=True)
def nearest(cells: Any, level: Any, optimistic: bool, row: int, column: int, reach: int) -> int:
    """Flat index of the passable cell nearest to a cell, within ``reach`` cells; -1 when there is none."""
    ny, nx = cells.shape
    best, best2 = -1, reach * reach + 1
    for j in range(max(row - reach, 0), min(row + reach + 1, ny)):
        for i in range(max(column - reach, 0), min(column + reach + 1, nx)):
            d2 = (j - row) * (j - row) + (i - column) * (i - column)
            if d2 < best2 and passable(cells, level, optimistic, j, i):
                best, best2 = j * nx + i, d2
    return best


@numba.njit(
    "int64(uint8[:,::1], uint8[:,::1], boolean, int64, int64, float64, float64, float64, boolean, int64[::1],"
    " int32[:,::1], int8[:,::1], int32[::1], int32[::1])",
    cache=True,
)
def search(
    cells: Any,
    level: Any,
    optimistic: bool,
    row: int,
    column: int,
    goal_x: float,
    goal_y: float,
    within: float,
    aimed: bool,
    window: Any,
    cost: Any,
    came: Any,
    chain: Any,
    item: Any,
) -> int:
    """Shortest paths from a cell, by a queue of buckets: to within ``within`` cells of a goal, or to everywhere.

    Args:
        aimed: stop at the goal (A*); otherwise visit every cell of the window (Dijkstra).
        window: first and last column, first and last row that may be used.
        cost: out, (ny, nx) cost from the start, `FAR` where not reached. came: out, direction of the last step.
        chain, item: scratch of at least eight entries a cell of the window.

    Returns:
        Flat index of the goal cell reached; -1 when there is none or when not aimed.
    """
    nx = cells.shape[1]
    x0, x1, y0, y1 = window[0], window[1], window[2], window[3]
    for j in range(y0, y1 + 1):
        for i in range(x0, x1 + 1):
            cost[j, i] = FAR
            came[j, i] = 0
    heads = np.full(BUCKETS, -1, dtype=np.int32)
    slack = math.ceil(within * 108.24) if within > 0.0 else 0
    gx, gy = math.floor(goal_x), math.floor(goal_y)
    near2 = within * within
    used, waiting = 1, 1
    item[0] = row * nx + column
    chain[0] = -1
    cost[row, column] = 0
    key = 0
    if aimed:
        dx, dy = abs(column - gx), abs(row - gy)
        key = max(0, STEP * max(dx, dy) + (DIAGONAL - STEP) * min(dx, dy) - slack)
    heads[key % BUCKETS] = 0
    while waiting > 0:
        slot = key % BUCKETS
        entry = heads[slot]
        if entry < 0:
            key += 1
            continue
        heads[slot] = chain[entry]
        waiting -= 1
        here = item[entry]
        j, i = here // nx, here % nx
        if came[j, i] & _CLOSED:
            continue
        came[j, i] |= _CLOSED
        if aimed:
            ex, ey = i + 0.5 - goal_x, j + 0.5 - goal_y
            if (i == gx and j == gy) or ex * ex + ey * ey <= near2:
                return int(here)
        base = cost[j, i]
        for d in range(8):
            a, b = i + _DX[d], j + _DY[d]
            if a < x0 or a > x1 or b < y0 or b > y1 or came[b, a] & _CLOSED:
                continue
            if level[b, a] >= 2 or not (optimistic or cells[b, a] == 1):
                continue
            if level[b, a] == 0:
                reached = base + (STEP if d < 4 else DIAGONAL)
            else:
                reached = base + (TIGHT if d < 4 else TIGHT_DIAGONAL)
            if reached >= cost[b, a]:
                continue
            cost[b, a] = reached
            came[b, a] = d
            rank = reached
            if aimed:
                dx, dy = abs(a - gx), abs(b - gy)
                rank += max(0, STEP * max(dx, dy) + (DIAGONAL - STEP) * min(dx, dy) - slack)
            item[used] = b * nx + a
            chain[used] = heads[rank % BUCKETS]
            heads[rank % BUCKETS] = used
            used += 1
            waiting += 1
    return -1


@numba.njit("int64(int8[:,::1], int64, int64, int64[::1])", cache=True)
def trace(came: Any, start: int, end: int, out: Any) -> int:
    """Flat indices from ``end`` back to ``start`` into ``out``; returns how many."""
    nx = came.shape[1]
    here, count = end, 0
    out[0] = here
    while here != start and count < len(out) - 1:
        d = came[here // nx, here % nx] & 7
        here -= _DY[d] * nx + _DX[d]
        count += 1
        out[count] = here
    return count + 1
