"""A path round bodies that stand in the way, on a grid of free floor."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hthor.navigation import path_smoothing_kernel
from hthor.navigation.grid_search_kernel import STEP, nearest, rank
from hthor.navigation.search_window import SearchWindow
from hthor.types import Vec2

Disc = tuple[float, float, float]
"""Middle and radius [m] of a disc on the floor."""

_BORDER_M = 2.5
_SNAP_CELLS = 4


def detour(
    free: NDArray[np.bool_], origin: Vec2, cell: float, here: Vec2, goal: Vec2, discs: Sequence[Disc], most_m: float
) -> tuple[Vec2, ...]:
    """A short path from ``here`` to ``goal`` that keeps out of the discs; () if there is none of at most ``most_m``.

    A body that already stands in a disc may leave it.

    Args:
        free: (ny, nx) bool, cells where an axis can be; the corner is at ``origin`` [m], cells are ``cell`` [m] wide.
        discs: radii are those of the other bodies and of this body together [m].
    """
    cells = without(free, origin, cell, here, discs)
    level = np.zeros_like(cells)
    start = _nearest(cells, level, _cell(here, origin, cell))
    end = _nearest(cells, level, _cell(goal, origin, cell))
    if start is None or end is None:
        return ()
    key = rank(abs(start[1] - end[1]), abs(start[0] - end[0]), 0.0)
    window = SearchWindow(cells, level, False, _edges(cells.shape, start, end, cell), start, key)
    last = window.seek(end[1] + 0.5, end[0] + 0.5, 0.0, math.floor(most_m / cell * STEP) + 1)
    if last < 0:
        return ()
    points, costs = window.trace(last)
    points[0], points[-1] = _cell(here, origin, cell), _cell(goal, origin, cell)
    keep = np.empty(len(points), dtype=np.int64)
    kept = path_smoothing_kernel.straighten(cells, level, False, points, costs, keep)
    bends = np.ascontiguousarray(points[keep[:kept]])
    kept = path_smoothing_kernel.tighten(cells, level, False, bends, kept)
    inner = [(origin[0] + x * cell, origin[1] + y * cell) for x, y in bends[1 : kept - 1].tolist()]
    return (*inner, goal)


def without(free: NDArray[np.bool_], origin: Vec2, cell: float, here: Vec2, discs: Sequence[Disc]) -> NDArray[np.uint8]:
    """(ny, nx) uint8: 1 for the free cells outside of the discs, which are made smaller where ``here`` is inside."""
    cells = np.array(free, dtype=np.uint8)
    for x, y, radius in discs:
        _block(cells, _cell((x, y), origin, cell), min(radius, math.dist((x, y), here) - cell) / cell)
    return cells


def _block(cells: NDArray[np.uint8], middle: Vec2, radius: float) -> None:
    """Close the cells whose middle is within a radius of a point; all lengths in cells."""
    (x, y), (ny, nx) = middle, cells.shape
    x0, x1 = max(math.floor(x - radius), 0), min(math.ceil(x + radius), nx)
    y0, y1 = max(math.floor(y - radius), 0), min(math.ceil(y + radius), ny)
    if radius <= 0.0 or x0 >= x1 or y0 >= y1:
        return
    columns, rows = np.arange(x0, x1) + 0.5 - x, np.arange(y0, y1) + 0.5 - y
    cells[y0:y1, x0:x1][np.hypot(rows[:, None], columns[None, :]) < radius] = 0


def _cell(point: Vec2, origin: Vec2, cell: float) -> Vec2:
    return (point[0] - origin[0]) / cell, (point[1] - origin[1]) / cell


def _nearest(cells: NDArray[np.uint8], level: NDArray[np.uint8], place: Vec2) -> tuple[int, int] | None:
    """Row and column of the nearest free cell, None if there is none close by."""
    flat = nearest(cells, level, False, math.floor(place[1]), math.floor(place[0]), _SNAP_CELLS)
    return None if flat < 0 else divmod(int(flat), cells.shape[1])


def _edges(
    shape: tuple[int, ...], start: tuple[int, int], end: tuple[int, int], cell: float
) -> tuple[int, int, int, int]:
    """First and last column, first and last row of a window round both ends."""
    border = math.ceil(_BORDER_M / cell)
    y0, y1 = min(start[0], end[0]) - border, max(start[0], end[0]) + border
    x0, x1 = min(start[1], end[1]) - border, max(start[1], end[1]) + border
    return max(x0, 0), min(x1, shape[1] - 1), max(y0, 0), min(y1, shape[0] - 1)
