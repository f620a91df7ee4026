"""Compiled: shortest paths on a grid of cells and levels (see `scan_kernel`).

Costs are integers, 100 for a step of one clear cell, so that paths do not depend on rounding. A search works on a flat
copy of a window of the map with a closed border of one cell, so that no step has to check for the map's end. Indices
are unsigned in the inner loops, which saves numba's check for negative indices.
"""

import math
from typing import Any

import numba
import numpy as np

STEP, DIAGONAL = 100, 141
TIGHT, TIGHT_DIAGONAL = 120, 169
FAR = 1 << 30
BUCKETS = 512
_LAST = BUCKETS - 1
_SLACK = 108.24
"""Largest cost of a path along the lattice per cell of the straight distance."""
CLOSED, CLEAR, CLOSE, WATCHED = 0, 1, 2, 4
"""States of a window's cells: impassable or settled, else the level plus one; and a flag at cells to stop at."""

_DX = np.array([1, 0, -1, 0, 1, -1, -1, 1], dtype=np.int64)
_DY = np.array([0, 1, 0, -1, 1, 1, -1, -1], dtype=np.int64)


def rank(columns: int, rows: int, within: float) -> int:
    """The least cost of a path to within ``within`` cells of a goal that is ``columns`` and ``rows`` away."""
    slack = math.ceil(within * _SLACK) if within > 0.0 else 0
    return max(0, STEP * max(columns, rows) + (DIAGONAL - STEP) * min(columns, rows) - slack)


@numba.njit("int64[::1](int64)", cache=True)
def _offsets(width: int) -> Any:
    """Index offsets of a cell's neighbours in a flat window, in the order of `_DX` and `_DY`."""
    return np.array([1, width, -1, -width, width + 1, width - 1, -width - 1, 1 - width], dtype=np.int64)


@numba.njit("boolean(uint8[:,::1], uint8[:,::1], boolean, int64, int64)", cache=True)
def passable(cells: Any, level: Any, optimistic: bool, row: int, column: int) -> bool:
    """Whether the body's centre may be in this cell."""
    return level[row, column] < 2 and (optimistic or cells[row, column] == 1)


@numba.njit("int64(uint8[:,::1], uint8[:,::1], boolean, int64, int64, int64)", cache=True)
def nearest(cells: Any, level: Any, optimistic: bool, row: int, column: int, reach: int) -> int:
    """Flat index of the passable cell nearest to a cell, within ``reach`` cells; -1 when there is none."""
    ny, nx = cells.shape
    if 0 <= row < ny and 0 <= column < nx and passable(cells, level, optimistic, row, column):
        return int(row * nx + column)
    best, best2 = -1, reach * reach + 1
    for j in range(max(row - reach, 0), min(row + reach + 1, ny)):
        for i in range(max(column - reach, 0), min(column + reach + 1, nx)):
            d2 = (j - row) * (j - row) + (i - column) * (i - column)
            if d2 < best2 and passable(cells, level, optimistic, j, i):
                best, best2 = j * nx + i, d2
    return best


@numba.njit(
    "void(uint8[:,::1], uint8[:,::1], boolean, int64[::1], int64, uint8[::1], int32[::1], int8[::1],"
    " int32[::1], int32[::1], int32[::1], int64[::1], int64)",
    cache=True,
)
def prepare(
    cells: Any,
    level: Any,
    optimistic: bool,
    window: Any,
    start: int,
    state: Any,
    cost: Any,
    came: Any,
    heads: Any,
    chain: Any,
    item: Any,
    memo: Any,
    key: int,
) -> None:
    """Copy a window into flat arrays with a border, and put its cell ``start`` in the queue, in bucket ``key``.

    Args:
        window: first and last column, first and last row that may be used.
        state, cost, came: output, one entry per cell of the bordered window.
        heads, chain, item: output, the queue: `BUCKETS` entries, and eight per cell. memo: output, (3,) queue counters.
    """
    x0, x1, y0, y1 = window[0], window[1], window[2], window[3]
    width = x1 - x0 + 3
    cost[:] = FAR
    state[:] = CLOSED
    for j in range(y0, y1 + 1):  # loops that compile to vector instructions
        row = state[(j - y0 + 1) * width + 1 : (j - y0 + 2) * width - 1]
        tight, known = level[j, x0 : x1 + 1], cells[j, x0 : x1 + 1]
        if optimistic:
            for i in range(len(row)):
                row[i] = tight[i] + CLEAR if tight[i] < 2 else CLOSED
        else:
            for i in range(len(row)):
                row[i] = tight[i] + CLEAR if (tight[i] < 2) & (known[i] == 1) else CLOSED
    heads[:] = -1
    heads[key & _LAST] = 0
    item[0], chain[0] = start, -1
    cost[start], came[start] = 0, 0
    memo[0], memo[1], memo[2] = key, 1, 1


@numba.njit(
    "int64(uint8[::1], int32[::1], int8[::1], int64, int64, int64, float64, float64, float64, int64,"
    " int32[::1], int32[::1], int32[::1], int64[::1])",
    cache=True,
)
def seek(
    state: Any,
    cost: Any,
    came: Any,
    width: int,
    left: int,
    bottom: int,
    goal_x: float,
    goal_y: float,
    within: float,
    most: int,
    heads: Any,
    chain: Any,
    item: Any,
    memo: Any,
) -> int:
    """Search the cheapest path to within ``within`` cells of a goal (A*); returns its last cell, -1 without a path.

    Args:
        width: of the bordered window. left, bottom: the map's column and row of the window's cell 0.
        goal_x, goal_y: the goal [cells of the map].
        most: give up when every path costs more.
    """
    offsets = _offsets(width)
    slack = math.ceil(within * _SLACK) if within > 0.0 else 0
    gx, gy = math.floor(goal_x), math.floor(goal_y)
    near2 = within * within
    key, used, waiting = memo[0], memo[1], memo[2]
    while waiting > 0 and key <= most:
        bucket = np.uint64(key & _LAST)
        entry = heads[bucket]
        if entry < 0:
            key += 1
            continue
        heads[bucket] = chain[np.uint64(entry)]
        waiting -= 1
        here = np.int64(item[np.uint64(entry)])
        if state[np.uint64(here)] == CLOSED:
            continue
        state[np.uint64(here)] = CLOSED
        row = here // width
        i, j = here - row * width + left, row + bottom
        ex, ey = i + 0.5 - goal_x, j + 0.5 - goal_y
        if (i == gx and j == gy) or ex * ex + ey * ey <= near2:
            return int(here)
        base = cost[np.uint64(here)]
        for d in range(8):
            there = np.uint64(here + offsets[np.uint64(d)])
            kind = state[there]
            if kind == CLOSED:
                continue
            if kind == CLEAR:
                reached = base + (STEP if d < 4 else DIAGONAL)
            else:
                reached = base + (TIGHT if d < 4 else TIGHT_DIAGONAL)
            if reached >= cost[there]:
                continue
            cost[there] = reached
            came[there] = d
            dx, dy = abs(i + _DX[d] - gx), abs(j + _DY[d] - gy)
            ahead = reached + max(0, STEP * max(dx, dy) + (DIAGONAL - STEP) * min(dx, dy) - slack)
            last, bucket = np.uint64(used), np.uint64(ahead & _LAST)
            item[last] = there
            chain[last] = heads[bucket]
            heads[bucket] = used
            used += 1
            waiting += 1
    return -1


@numba.njit(
    "int64(uint8[::1], int32[::1], int8[::1], int64, int64, int64, int32[::1], int32[::1], int32[::1], int64[::1])",
    cache=True,
)
def spread(
    state: Any, cost: Any, came: Any, width: int, watched: int, most: int, heads: Any, chain: Any, item: Any, memo: Any
) -> int:
    """Search paths to cells of increasing cost (Dijkstra) until ``watched`` more of the watched cells are reached.

    Another call continues the search. Cells that are `CLOSED` and cheaper than `FAR` have their least cost.

    Args:
        most: stop before the first cell that costs more.

    Returns:
        The watched cell reached last; -1 if the search ended before ``watched`` cells were reached.
    """
    offsets = _offsets(width)
    key, used, waiting = memo[0], memo[1], memo[2]
    found = -1
    while waiting > 0 and key <= most:
        bucket = np.uint64(key & _LAST)
        entry = heads[bucket]
        if entry < 0:
            key += 1
            continue
        heads[bucket] = chain[np.uint64(entry)]
        waiting -= 1
        here = np.uint64(item[np.uint64(entry)])
        kind = state[here]
        if kind == CLOSED:
            continue
        state[here] = CLOSED
        base = cost[here]
        for d in range(8):
            there = np.uint64(np.int64(here) + offsets[np.uint64(d)])
            next_kind = state[there] & (CLEAR | CLOSE)
            if next_kind == CLOSED:
                continue
            if next_kind == CLEAR:
                reached = base + (STEP if d < 4 else DIAGONAL)
            else:
                reached = base + (TIGHT if d < 4 else TIGHT_DIAGONAL)
            if reached >= cost[there]:
                continue
            cost[there] = reached
            came[there] = d
            last, bucket = np.uint64(used), np.uint64(reached & _LAST)
            item[last] = there
            chain[last] = heads[bucket]
            heads[bucket] = used
            used += 1
            waiting += 1
        if kind & WATCHED:
            watched -= 1
            if watched == 0:
                found = int(here)
                break
    memo[0], memo[1], memo[2] = key, used, waiting
    return int(found)


@numba.njit("int64(int8[::1], int64, int64, int64, int64)", cache=True)
def steps(came: Any, width: int, start: int, end: int, most: int) -> int:
    """The number of cells on the path from ``start`` to ``end``, at most ``most``."""
    offsets = _offsets(width)
    here, count = end, 1
    while here != start and count < most:
        here -= offsets[came[here]]
        count += 1
    return count


@numba.njit("void(int8[::1], int32[::1], int64, int64, int64, int64, float64[:,::1], float64[::1])", cache=True)
def trace(came: Any, cost: Any, width: int, end: int, left: int, bottom: int, points: Any, costs: Any) -> None:
    """Write the last cells of the path to ``end``, as many as ``points`` has rows; see
    `hthor.navigation.search_window.SearchWindow.trace`.
    """
    offsets = _offsets(width)
    here = end
    for k in range(len(points) - 1, -1, -1):
        row = here // width
        points[k, 0] = here - row * width + (left + 0.5)
        points[k, 1] = row + (bottom + 0.5)
        costs[k] = cost[here]
        here -= offsets[came[here]]
