"""At which of many places a body can stand with nothing between it and what it faces."""

import math
from collections.abc import Sequence
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from hthor.navigation import grid_search_kernel, scan_kernel
from hthor.navigation.grid_map import CELL_M, FREE, OCCUPIED, GridMap
from hthor.navigation.planner import Planner
from hthor.types import Vec2

NO, MAYBE, YES = 0, 1, 2
"""Not usable; usable if unknown cells are free; known to be free."""


def usable(grid: GridMap, planner: Planner, spots: Sequence[Vec2], facing: Sequence[Vec2], margin: float) -> list[int]:
    """`NO`, `MAYBE` or `YES` for each spot [m]: whether the body fits, and nothing stands between it and what it faces.

    Args:
        grid, planner: the map, and the body on it.
        facing: the point [m] that each spot faces; the last ``margin`` [m] before it do not count.
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
