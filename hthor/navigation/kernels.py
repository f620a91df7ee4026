"""The compiled inner loops of mapping and planning, on plain arrays; knows nothing of records.

Signatures are explicit, so that loading the module loads every loop, from the cache when there is one. Cells are
(ny, nx) uint8: 0 unknown, 1 free, 2 occupied. Levels are (ny, nx) uint8: 0 clear, 1 tight, 2 no room for the body.
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


@numba.njit("void(uint8[:,::1], int64, int64, int64[::1])", cache=True)
def _open(cells: Any, row: int, column: int, bounds: Any) -> None:
    """Make an unknown cell free, and keep the bounds of what is known."""
    if cells[row, column] == 0:
        cells[row, column] = 1
        if column < bounds[0]:
            bounds[0] = column
        if column > bounds[1]:
            bounds[1] = column
        if row < bounds[2]:
            bounds[2] = row
        if row > bounds[3]:
            bounds[3] = row


@numba.njit("int64(uint8[:,::1], int64, int64, int64, int64, int64[::1], int32[:,::1], int64)", cache=True)
def _fill(cells: Any, row: int, column: int, left: int, bottom: int, bounds: Any, found: Any, count: int) -> int:
    """Make a cell occupied and note it; returns how many are noted."""
    if cells[row, column] == 2:
        return count
    _open(cells, row, column, bounds)
    cells[row, column] = 2
    found[count, 0] = column + left
    found[count, 1] = row + bottom
    return count + 1


@numba.njit(
    "int64(uint8[:,::1], uint8[:,::1], int64, int64, float64, float64, float64, float64, float64[::1], float64[::1],"
    " float64, float64, float64, int64[::1], int32[:,::1], int64)",
    cache=True,
)
def integrate(
    cells: Any,
    near: Any,
    left: int,
    bottom: int,
    cell: float,
    x: float,
    y: float,
    yaw: float,
    bearings: Any,
    ranges: Any,
    limit: float,
    look_m: float,
    look_rad: float,
    bounds: Any,
    found: Any,
    count: int,
) -> int:
    """March every beam, and beams between neighbours so that no cell is skipped; returns the count of obstacles."""
    px, py = x / cell - left, y / cell - bottom
    row, column = math.floor(py), math.floor(px)
    for j in range(row - 2, row + 3):
        for i in range(column - 2, column + 3):
            _open(cells, j, i, bounds)
            near[j, i] = 1
    n = len(ranges)
    look = look_m / cell
    for k in range(n):
        angle = yaw + bearings[k]
        ux, uy = math.cos(angle), math.sin(angle)
        reach = ranges[k] / cell
        hit = ranges[k] < limit - 1e-6
        looking = abs(bearings[k]) <= look_rad
        t = 0.0
        end = reach - 0.3 if hit else reach
        while t < end:
            j, i = math.floor(py + t * uy), math.floor(px + t * ux)
            _open(cells, j, i, bounds)
            if looking and t <= look:
                near[j, i] = 1
            t += 1.0
        if hit:
            j, i = math.floor(py + (reach + 0.2) * uy), math.floor(px + (reach + 0.2) * ux)
            count = _fill(cells, j, i, left, bottom, bounds, found, count)
        # Between this beam and the next: free as far as the shorter one, from where a gap could open.
        m = k + 1 if k + 1 < n else 0
        gap = bearings[m] - bearings[k] if m else bearings[0] + 2.0 * math.pi - bearings[k]
        if not 1e-9 < gap < 0.3:
            continue
        other = ranges[m] / cell
        shorter = min(reach, other) - 1.0
        between = math.ceil(shorter * gap) - 1
        for s in range(1, between + 1):
            angle = yaw + bearings[k] + gap * s / (between + 1)
            vx, vy = math.cos(angle), math.sin(angle)
            t = 1.0 / gap
            while t < shorter:
                _open(cells, math.floor(py + t * vy), math.floor(px + t * vx), bounds)
                t += 1.0
        # Two hits closer together than any body is wide belong to one obstacle.
        if hit and ranges[m] < limit - 1e-6:
            angle = yaw + bearings[m]
            ax, ay = px + (reach + 0.2) * ux, py + (reach + 0.2) * uy
            bx, by = px + (other + 0.2) * math.cos(angle), py + (other + 0.2) * math.sin(angle)
            apart = math.hypot(bx - ax, by - ay)
            if 1.0 < apart < 6.0:
                for s in range(1, int(apart) + 1):
                    f = s / (int(apart) + 1)
                    j, i = math.floor(ay + f * (by - ay)), math.floor(ax + f * (bx - ax))
                    count = _fill(cells, j, i, left, bottom, bounds, found, count)
    return count


@numba.njit("void(uint8[:,::1], int32[:,::1], int64, int64, int64, int64, int64[:,::1])", cache=True)
def inflate(level: Any, obstacles: Any, first: int, last: int, left: int, bottom: int, disc: Any) -> None:
    """Raise the level around obstacles ``first`` to ``last``; ``disc`` (N, 3) holds column and row offsets, level."""
    ny, nx = level.shape
    for k in range(first, last):
        column, row = obstacles[k, 0] - left, obstacles[k, 1] - bottom
        for d in range(disc.shape[0]):
            i, j = column + disc[d, 0], row + disc[d, 1]
            if 0 <= i < nx and 0 <= j < ny and level[j, i] < disc[d, 2]:
                level[j, i] = disc[d, 2]


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


@numba.njit("float64(uint8[:,::1], uint8[:,::1], boolean, float64, float64, float64, float64)", cache=True)
def line_cost(cells: Any, level: Any, optimistic: bool, ax: float, ay: float, bx: float, by: float) -> float:
    """Cost of the straight line between two points [cells]; negative when the body does not fit on it."""
    ny, nx = cells.shape
    length = math.hypot(bx - ax, by - ay)
    n = int(length * 2.0) + 1
    tight = 0
    for s in range(1, n + 1):
        f = s / n
        i, j = math.floor(ax + f * (bx - ax)), math.floor(ay + f * (by - ay))
        if not (0 <= i < nx and 0 <= j < ny) or level[j, i] >= 2 or not (optimistic or cells[j, i] == 1):
            return -1.0
        tight += level[j, i]
    return length * (STEP + (TIGHT - STEP) * tight / n)


@numba.njit("int64(uint8[:,::1], uint8[:,::1], boolean, float64[:,::1], float64[::1], int64[::1])", cache=True)
def pull(cells: Any, level: Any, optimistic: bool, points: Any, cost: Any, keep: Any) -> int:
    """Pull the string tight: indices of the points to keep; a shortcut is taken when it costs no more.

    ``points`` (N, 2) [cells], ``cost`` (N,) the cost up to each, ``keep`` out; returns how many are kept.
    """
    n = len(points)
    keep[0] = 0
    kept, here = 1, 0
    while here < n - 1:
        best, misses = here + 1, 0
        for k in range(here + 2, n):
            line = line_cost(cells, level, optimistic, points[here, 0], points[here, 1], points[k, 0], points[k, 1])
            spare = 100.0 if here == 0 or k == n - 1 else 30.0  # the ends lie anywhere in their cells
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


@numba.njit("int64(uint8[:,::1], uint8[:,::1], boolean, float64[:,::1], float64[::1], int64[::1])", cache=True)
def straighten(cells: Any, level: Any, optimistic: bool, points: Any, cost: Any, keep: Any) -> int:
    """Pull the string from both ends, and take the cheapest way over the bends of both; as `pull`."""
    n = len(points)
    forth, back = np.empty(n, dtype=np.int64), np.empty(n, dtype=np.int64)
    n_forth = pull(cells, level, optimistic, points, cost, forth)
    n_back = pull(cells, level, optimistic, points[::-1].copy(), cost[n - 1] - cost[::-1], back)
    bends = np.zeros(n, dtype=np.int64)  # bit 1: a bend of either; bit 2: of the way forth
    for k in range(n_back):
        bends[n - 1 - back[k]] = 1
    for k in range(n_forth):
        bends[forth[k]] = 3
    nodes = np.nonzero(bends)[0]
    m = len(nodes)
    best, before = np.full(m, 1e18), np.zeros(m, dtype=np.int64)
    best[0] = 0.0
    last = 0  # the latest bend of the way forth, which always leads on
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
    """Move every bend of a way towards the line between its neighbours while that costs less; drop needless ones.

    ``points`` (N, 2) [cells] is changed in place, its first ``n`` rows are the way; returns how many are left.
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


@numba.njit("int64(int32[:,::1], int64[::1], uint8[:,::1], int32[::1], int64[:,::1])", cache=True)
def clusters(cost: Any, window: Any, mask: Any, stack: Any, out: Any) -> int:
    """Group the marked cells that were reached; every row of ``out`` is row, column, size, least cost.

    ``mask`` is used up. The cell given is the member nearest to the middle of its group.
    """
    x0, x1, y0, y1 = window[0], window[1], window[2], window[3]
    nx = cost.shape[1]
    groups = 0
    for row in range(y0, y1 + 1):
        for column in range(x0, x1 + 1):
            if mask[row, column] == 0 or groups == len(out):
                continue
            mask[row, column] = 0
            stack[0] = row * nx + column
            size, done = 1, 0
            sum_x, sum_y, least = 0, 0, FAR
            while done < size:  # the stack is kept whole: it becomes the list of members
                j, i = stack[done] // nx, stack[done] % nx
                done += 1
                sum_x += i
                sum_y += j
                if cost[j, i] < least:
                    least = cost[j, i]
                for d in range(8):
                    a, b = i + _DX[d], j + _DY[d]
                    if x0 <= a <= x1 and y0 <= b <= y1 and mask[b, a]:
                        mask[b, a] = 0
                        stack[size] = b * nx + a
                        size += 1
            best, best2 = stack[0], 1e18
            for s in range(size):
                j, i = stack[s] // nx, stack[s] % nx
                ex, ey = i - sum_x / size, j - sum_y / size
                if ex * ex + ey * ey < best2:
                    best, best2 = stack[s], ex * ex + ey * ey
            out[groups, 0] = best // nx
            out[groups, 1] = best % nx
            out[groups, 2] = size
            out[groups, 3] = least
            groups += 1
    return groups


@numba.njit(
    "void(uint8[:,::1], uint8[:,::1], uint8[:,::1], int32[:,::1], int64[::1], boolean, uint8[:,::1])", cache=True
)
def mark(cells: Any, level: Any, near: Any, cost: Any, window: Any, edges: bool, mask: Any) -> None:
    """Mark reached free cells: those next to the unknown (``edges``), or those along obstacles never seen close."""
    ny, nx = cells.shape
    for j in range(max(window[2], 1), min(window[3], ny - 2) + 1):
        for i in range(max(window[0], 1), min(window[1], nx - 2) + 1):
            mask[j, i] = 0
            if cells[j, i] != 1 or cost[j, i] == FAR:
                continue
            if edges:
                unknown = cells[j - 1, i] == 0 or cells[j + 1, i] == 0 or cells[j, i - 1] == 0 or cells[j, i + 1] == 0
                mask[j, i] = 1 if unknown else 0
            else:
                mask[j, i] = 1 if level[j, i] == 1 and near[j, i] == 0 else 0


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
