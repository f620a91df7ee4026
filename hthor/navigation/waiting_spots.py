"""Finds places where a body can stand without blocking anybody's way, and checks which places can be used."""

import math
from collections.abc import Sequence
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from hthor.navigation import grid_search_kernel, scan_kernel
from hthor.navigation.grid_map import CELL_M, FREE, OCCUPIED, GridMap
from hthor.navigation.grid_search_kernel import _DX, _DY, FAR, nearest
from hthor.navigation.planner import Planner
from hthor.navigation.search_window import SearchWindow
from hthor.types import Vec2

BERTH_M = 0.45
"""[m] No other body's axis comes closer than this to a standing body: both radii and a small margin."""
_ROUND_M = 0.95
_FAR_M = 3.0
_SNAP_CELLS = 30
NO, MAYBE, YES = 0, 1, 2
"""A place is not usable; is usable if unknown cells are free; is known to be usable."""


def park(free: NDArray[np.bool_], origin: Vec2, cell: float, here: Vec2, point: Vec2, apart_m: float) -> Vec2 | None:
    """The place nearby where the least traffic to ``point`` would pass; None if there is no suitable place.

    It blocks no passage: the free floor around it stays connected when it is occupied. Traffic is assumed to come from
    every free cell equally, by the shortest path.

    Args:
        free: (ny, nx) bool, cells where an axis can be; the corner is at ``origin`` [m], cells are ``cell`` [m] wide.
        here: where the body stands [m]; the place is at most 3 m away.
        point: where other bodies want to go [m]; the place is at least ``apart_m`` [m] away from it.
    """
    cells = np.array(free, dtype=np.uint8)
    column, row = math.floor((here[0] - origin[0]) / cell), math.floor((here[1] - origin[1]) / cell)
    x, y = (point[0] - origin[0]) / cell, (point[1] - origin[1]) / cell
    flow = _traffic(cells, x, y)
    if flow is None:
        return None
    found = _search(cells, flow, row, column, x, y, apart_m / cell, BERTH_M / cell, _ROUND_M / cell, _FAR_M / cell)
    if found < 0:
        return None
    row, column = divmod(int(found), free.shape[1])
    return (origin[0] + (column + 0.5) * cell, origin[1] + (row + 0.5) * cell)


def retreat(grid: GridMap, planner: Planner, here: Vec2, point: Vec2, apart_m: float) -> tuple[Vec2, ...] | None:
    """The path [m] on a body's own map to the place that `park` finds on that map; None to stay."""
    free = (grid.cells == FREE) & (planner.levels < 2)
    spot = park(free, (grid.left * CELL_M, grid.bottom * CELL_M), CELL_M, here, point, apart_m)
    return None if spot is None else planner.path(here, spot)


def _traffic(cells: NDArray[np.uint8], x: float, y: float) -> NDArray[np.int64] | None:
    """For each cell, the number of cells whose shortest path to a point [cells] leads through it."""
    nx = cells.shape[1]
    level = np.zeros_like(cells)
    end = nearest(cells, level, False, math.floor(y), math.floor(x), _SNAP_CELLS)
    if end < 0:
        return None
    rows, columns = (np.flatnonzero(cells.any(axis=axis)).tolist() for axis in (1, 0))
    x0, x1, y0, y1 = edges = columns[0], columns[-1], rows[0], rows[-1]
    ways = SearchWindow(cells, level, False, edges, divmod(int(end), nx))
    ways.spread(0)
    run: NDArray[np.int64] = np.zeros(ways.cost.size, dtype=np.int64)
    _pour(ways.cost, ways.came, ways.width, ways.start, run)
    flow: NDArray[np.int64] = np.zeros(cells.shape, dtype=np.int64)
    flow[y0 : y1 + 1, x0 : x1 + 1] = run.reshape(-1, ways.width)[1:-1, 1:-1]
    return flow


@numba.njit("void(int32[::1], int8[::1], int64, int64, int64[::1])", cache=True)
def _pour(cost: Any, came: Any, width: int, end: int, flow: Any) -> None:
    """Let one unit flow from every reached cell back along the path by which it was reached."""
    n = len(cost)
    sources = np.zeros(n, dtype=np.int8)  # number of neighbours that still have to flow into each cell
    for here in range(n):
        if cost[here] < FAR and here != end:
            d = came[here]
            sources[here - _DY[d] * width - _DX[d]] += 1
    for first in range(n):
        here = first
        while cost[here] < FAR and sources[here] == 0:
            sources[here] = -1
            flow[here] += 1
            if here == end:
                break
            d = came[here]
            there = here - _DY[d] * width - _DX[d]
            flow[there] += flow[here]
            sources[there] -= 1
            if there > first:  # it is handled later
                break
            here = there


@numba.njit("int64(uint8[:,::1], int64, int64, float64, float64)", cache=True)
def _pieces(free: Any, row: int, column: int, inner: float, outer: float) -> int:
    """The number of connected pieces of the free floor between two radii [cells] around a cell."""
    ny, nx = free.shape
    reach = math.ceil(outer)
    width = 2 * reach + 1
    ring = np.zeros((width, width), dtype=np.uint8)
    for j in range(width):
        for i in range(width):
            b, a = row + j - reach, column + i - reach
            apart = math.hypot(j - reach, i - reach)
            if inner <= apart <= outer and 0 <= b < ny and 0 <= a < nx and free[b, a]:
                ring[j, i] = 1
    stack = np.empty(width * width, dtype=np.int64)
    pieces = 0
    for j in range(width):
        for i in range(width):
            if not ring[j, i]:
                continue
            ring[j, i] = 0
            stack[0], top = j * width + i, 1
            size = 0
            while top > 0:
                top -= 1
                size += 1
                b, a = stack[top] // width, stack[top] % width
                for dj, di in ((0, 1), (1, 0), (0, -1), (-1, 0)):
                    d, c = b + dj, a + di
                    if 0 <= d < width and 0 <= c < width and ring[d, c]:
                        ring[d, c] = 0
                        stack[top] = d * width + c
                        top += 1
            if size >= 4:
                pieces += 1
    return pieces


@numba.njit("int64(int64[:,::1], int64, int64, float64, int64)", cache=True)
def _passing(flow: Any, row: int, column: int, radius: float, enough: int) -> int:
    """The largest flow within a radius [cells] of a cell; the search ends at any flow of at least ``enough``."""
    ny, nx = flow.shape
    reach = math.ceil(radius)
    most = flow[row, column]
    if most >= enough:
        return int(most)
    for j in range(max(row - reach, 0), min(row + reach + 1, ny)):
        for i in range(max(column - reach, 0), min(column + reach + 1, nx)):
            if flow[j, i] > most and math.hypot(j - row, i - column) <= radius:
                most = flow[j, i]
                if most >= enough:
                    return int(most)
    return int(most)


@numba.njit(
    "int64(uint8[:,::1], int64[:,::1], int64, int64, float64, float64, float64, float64, float64, float64)", cache=True
)
def _search(
    free: Any,
    flow: Any,
    row: int,
    column: int,
    x: float,
    y: float,
    apart: float,
    inner: float,
    outer: float,
    far: float,
) -> int:
    """Flat index of the suitable cell with the least traffic, the nearer of equal cells; -1 if no cell is suitable."""
    ny, nx = free.shape
    seen = np.zeros((ny, nx), dtype=np.uint8)
    queue = np.empty(ny * nx + 9, dtype=np.int64)
    count, done = 0, 0
    for j in range(max(row - 1, 0), min(row + 2, ny)):
        for i in range(max(column - 1, 0), min(column + 2, nx)):
            seen[j, i] = 1
            queue[count] = j * nx + i
            count += 1
    best, least = -1, 1 << 60
    while done < count:
        j, i = queue[done] // nx, queue[done] % nx
        done += 1
        if free[j, i] and (i + j) % 2 == 0 and math.hypot(i + 0.5 - x, j + 0.5 - y) >= apart:
            passing = _passing(flow, j, i, inner, least)
            if passing < least and _pieces(free, j, i, inner, outer) <= 1:
                best, least = j * nx + i, passing
        for dj, di in ((0, 1), (1, 0), (0, -1), (-1, 0)):
            b, a = j + dj, i + di
            if 0 <= b < ny and 0 <= a < nx and free[b, a] and not seen[b, a]:
                seen[b, a] = 1
                if math.hypot(b - row, a - column) <= far:
                    queue[count] = b * nx + a
                    count += 1
    return int(best)


def usable(grid: GridMap, planner: Planner, spots: Sequence[Vec2], facing: Sequence[Vec2], margin: float) -> list[int]:
    """`NO`, `MAYBE` or `YES` for each spot [m]: whether the body fits, with no obstacle before the point it faces.

    Args:
        grid, planner: the map, and the planner for the body.
        facing: the point [m] that each spot faces; obstacles in the last ``margin`` [m] before it do not count.
    """
    if not spots:
        return []
    ends: NDArray[np.float64] = np.array([(*a, *b) for a, b in zip(spots, facing, strict=True)])
    levels = planner.levels
    ranks = _usable(grid.cells, levels, planner.optimistic, grid.left, grid.bottom, ends, margin)
    return [int(rank) for rank in ranks.tolist()]


@numba.njit("int64[::1](uint8[:,::1], uint8[:,::1], boolean, int64, int64, float64[:,::1], float64)", cache=True)
def _usable(cells: Any, level: Any, optimistic: bool, left: int, bottom: int, ends: Any, margin: float) -> Any:
    ny, nx = cells.shape
    ranks = np.zeros(len(ends), dtype=np.int64)
    for k in range(len(ends)):
        ax, ay, bx, by = ends[k, 0], ends[k, 1], ends[k, 2], ends[k, 3]
        column, row = math.floor(ax / CELL_M - left), math.floor(ay / CELL_M - bottom)
        if not (0 <= row < ny and 0 <= column < nx):
            continue
        if not grid_search_kernel.passable(cells, level, optimistic, row, column):
            continue
        apart = math.hypot(bx - ax, by - ay)
        count = int((apart - margin) / CELL_M)
        if count > 0 and not scan_kernel.along(
            cells, left, bottom, CELL_M, ax, ay, bx, by, 1, count, CELL_M, apart, OCCUPIED, False
        ):
            continue
        ranks[k] = YES if cells[row, column] == FREE else MAYBE
    return ranks
