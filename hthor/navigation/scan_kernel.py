"""Compiled: adds range scans to a grid, and obstacles to levels.

Cells are (ny, nx) uint8: 0 unknown, 1 free, 2 occupied. Levels are (ny, nx) uint8: 0 clear, 1 tight, 2 no room for the
body. Signatures are explicit, so that the loops are compiled, or loaded from the cache, when the module is imported.
"""

import math
from typing import Any

import numba
import numpy as np

_BITS = 40
_ONE = 1 << _BITS
_READ = "Array(float64, 1, 'C', True)"  # read-only, as arrays from another process are


@numba.njit("void(uint8[:,::1], int64, int64, int64[::1])", cache=True)
def _open(cells: Any, row: int, column: int, bounds: Any) -> None:
    """Make an unknown cell free, and extend the ``bounds`` of the known cells."""
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


@numba.njit("int64(uint8[:,::1], int64, int64, int64, int64, int64[::1], int32[:,::1], int64, int64)", cache=True)
def _fill(
    cells: Any, row: int, column: int, left: int, bottom: int, bounds: Any, found: Any, count: int, low: int
) -> int:
    """Make a cell occupied, and add it and ``low`` to the list ``found``; returns the length of the list."""
    if cells[row, column] == 2:
        return count
    _open(cells, row, column, bounds)
    cells[row, column] = 2
    found[count, 0] = column + left
    found[count, 1] = row + bottom
    found[count, 2] = low
    return count + 1


@numba.njit("void(uint8[:,::1], float64, float64, float64, float64, int64, int64[::1])", cache=True)
def _sweep(cells: Any, x: float, y: float, ux: float, uy: float, count: int, bounds: Any) -> None:
    """Mark ``count`` cells along a beam as free, from (x, y) on in steps of (ux, uy) cells.

    The map is larger than any beam, so that no coordinate is negative. Coordinates are fixed-point integers in which a
    cell is `_ONE`, so that a step is one addition and a cell's index one shift.
    """
    fx, fy, dx, dy = int(x * _ONE), int(y * _ONE), int(ux * _ONE), int(uy * _ONE)
    for _ in range(count):
        j, i = fy >> _BITS, fx >> _BITS
        if cells[np.uint64(j), np.uint64(i)] == 0:
            _open(cells, j, i, bounds)
        fx, fy = fx + dx, fy + dy


@numba.njit(
    f"int64(uint8[:,::1], int64, int64, float64, float64, float64, float64, {_READ}, {_READ}, {_READ},"
    " float64, int64[::1], int32[:,::1], int64)",
    cache=True,
)
def beyond(
    cells: Any,
    left: int,
    bottom: int,
    cell: float,
    x: float,
    y: float,
    yaw: float,
    bearings: Any,
    ranges: Any,
    walls: Any,
    limit: float,
    bounds: Any,
    found: Any,
    count: int,
) -> int:
    """Fill the cells at the distances ``walls`` [m], seen over lower obstacles; returns the number of obstacles.

    The floor between the lower obstacle and the wall stays unknown.
    """
    px, py = x / cell - left, y / cell - bottom
    for k in range(len(bearings)):
        if walls[k] <= ranges[k] or walls[k] >= limit - 1e-6:
            continue
        reach, angle = walls[k] / cell + 0.2, yaw + bearings[k]
        b, a = math.floor(py + reach * math.sin(angle)), math.floor(px + reach * math.cos(angle))
        count = _fill(cells, b, a, left, bottom, bounds, found, count, False)
    return count


@numba.njit(
    f"int64(uint8[:,::1], uint8[:,::1], int64, int64, float64, float64, float64, float64, {_READ}, {_READ}, {_READ},"
    " float64, float64, float64, float64, int64[::1], int32[:,::1], int64)",
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
    tops: Any,
    low: float,
    limit: float,
    look_m: float,
    look_rad: float,
    bounds: Any,
    found: Any,
    count: int,
) -> int:
    """Trace every beam, and more beams in between so that no cell is skipped; returns the number of obstacles.

    ``tops`` are the heights [m] of the obstacles that beams hit; obstacles lower than ``low`` are marked as low.
    """
    px, py = x / cell - left, y / cell - bottom
    row, column = math.floor(py), math.floor(px)
    for b in range(row - 2, row + 3):
        for a in range(column - 2, column + 3):
            _open(cells, b, a, bounds)
            near[b, a] = 1
    n = len(ranges)
    look = look_m / cell
    along_x, along_y = np.empty(n), np.empty(n)
    for k in range(n):
        along_x[k], along_y[k] = math.cos(yaw + bearings[k]), math.sin(yaw + bearings[k])
    for k in range(n):
        ux, uy = along_x[k], along_y[k]
        reach = ranges[k] / cell
        hit = ranges[k] < limit - 1e-6
        count_k = math.ceil(reach - 0.3 if hit else reach)
        if abs(bearings[k]) <= look_rad:
            fx, fy, dx, dy = int(px * _ONE), int(py * _ONE), int(ux * _ONE), int(uy * _ONE)
            for _ in range(min(count_k, int(look) + 1)):
                near[np.uint64(fy >> _BITS), np.uint64(fx >> _BITS)] = 1
                fx, fy = fx + dx, fy + dy
        _sweep(cells, px, py, ux, uy, count_k, bounds)
        if hit:
            b, a = math.floor(py + (reach + 0.2) * uy), math.floor(px + (reach + 0.2) * ux)
            count = _fill(cells, b, a, left, bottom, bounds, found, count, tops[k] < low)
        # Between this beam and the next, cells are free up to the shorter range; start where a gap could open.
        m = k + 1 if k + 1 < n else 0
        gap = bearings[m] - bearings[k] if m else bearings[0] + 2.0 * math.pi - bearings[k]
        if not 1e-9 < gap < 0.3:
            continue
        other = ranges[m] / cell
        shorter = min(reach, other) - 1.0
        between = max(0, math.ceil(shorter * gap) - 1)
        cos, sin = math.cos(gap / (between + 1)), math.sin(gap / (between + 1))
        vx, vy, t = ux, uy, 1.0 / gap
        for _ in range(between):
            vx, vy = vx * cos - vy * sin, vx * sin + vy * cos
            _sweep(cells, px + t * vx, py + t * vy, vx, vy, math.ceil(shorter - t), bounds)
        # Two hits that are closer together than the width of any body belong to one obstacle.
        if hit and ranges[m] < limit - 1e-6:
            ax, ay = px + (reach + 0.2) * ux, py + (reach + 0.2) * uy
            bx, by = px + (other + 0.2) * along_x[m], py + (other + 0.2) * along_y[m]
            if 1.0 < (bx - ax) * (bx - ax) + (by - ay) * (by - ay) < 36.0:
                apart = int(math.hypot(bx - ax, by - ay))
                for s in range(1, apart + 1):
                    f = s / (apart + 1)
                    b, a = math.floor(ay + f * (by - ay)), math.floor(ax + f * (bx - ax))
                    count = _fill(cells, b, a, left, bottom, bounds, found, count, tops[k] < low and tops[m] < low)
    return count


@numba.njit(
    "boolean(uint8[:,::1], int64, int64, float64, float64, float64, float64, float64, int64, int64, float64, float64,"
    " int64, boolean)",
    cache=True,
)
def along(
    cells: Any,
    left: int,
    bottom: int,
    cell: float,
    ax: float,
    ay: float,
    bx: float,
    by: float,
    first: int,
    last: int,
    step: float,
    length: float,
    state: int,
    wanted: bool,
) -> bool:
    """Whether all points of a line, ``first`` to ``last``, ``step`` apart, are in ``state`` cells, or all are not."""
    ny, nx = cells.shape
    for k in range(first, last + 1):
        share = k * step / length
        i = math.floor((ax + share * (bx - ax)) / cell) - left
        j = math.floor((ay + share * (by - ay)) / cell) - bottom
        found = cells[j, i] if 0 <= j < ny and 0 <= i < nx else 0
        if (found == state) != wanted:
            return False
    return True


@numba.njit("void(uint8[:,::1], int32[:,::1], int64, int64, int64, int64, int64)", cache=True)
def surround(beside: Any, obstacles: Any, first: int, last: int, left: int, bottom: int, reach: int) -> None:
    """Mark the cells within ``reach`` columns and rows of the low obstacles among obstacles ``first`` to ``last``."""
    ny, nx = beside.shape
    for k in range(first, last):
        if obstacles[k, 2]:
            column, row = obstacles[k, 0] - left, obstacles[k, 1] - bottom
            for j in range(max(row - reach, 0), min(row + reach + 1, ny)):
                for i in range(max(column - reach, 0), min(column + reach + 1, nx)):
                    beside[j, i] = 1


@numba.njit("void(uint8[:,::1], int32[:,::1], int64, int64, int64, int64, int64[:,::1])", cache=True)
def inflate(level: Any, obstacles: Any, first: int, last: int, left: int, bottom: int, disc: Any) -> None:
    """Raise the levels around obstacles ``first`` to ``last``; ``disc`` (N, 3): column offset, row offset, level."""
    ny, nx = level.shape
    for k in range(first, last):
        column, row = obstacles[k, 0] - left, obstacles[k, 1] - bottom
        for d in range(disc.shape[0]):
            i, j = column + disc[d, 0], row + disc[d, 1]
            if 0 <= i < nx and 0 <= j < ny and level[np.uint64(j), np.uint64(i)] < disc[d, 2]:
                level[np.uint64(j), np.uint64(i)] = disc[d, 2]
