"""Where a body can stand without cutting anybody's way; knows nothing of who might come."""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from hthor.types import Vec2

BERTH_M = 0.45
"""Nobody else's axis comes closer than this to a standing body: both radii and a little."""
_ROUND_M = 0.95
_FAR_M = 3.0


def park(free: NDArray[np.bool_], origin: Vec2, cell: float, here: Vec2, point: Vec2, apart_m: float) -> Vec2 | None:
    """The nearest spot that blocks no passage and leaves room around ``point``; None when there is none close by.

    A spot blocks no passage when the free floor around it hangs together without it.

    Args:
        free: (ny, nx) where an axis may be; its corner lies at ``origin`` [m], its cells are ``cell`` metres wide.
        here: where the body stands [m]. It walks at most 3 m to the spot.
        point: where others have business [m]; the spot is ``apart_m`` metres away from it.
    """
    column, row = math.floor((here[0] - origin[0]) / cell), math.floor((here[1] - origin[1]) / cell)
    found = _search(
        np.array(free, dtype=np.uint8),
        row,
        column,
        (point[0] - origin[0]) / cell,
        (point[1] - origin[1]) / cell,
        apart_m / cell,
        BERTH_M / cell,
        _ROUND_M / cell,
        _FAR_M / cell,
    )
    if found < 0:
        return None
    row, column = divmod(int(found), free.shape[1])
    return (origin[0] + (column + 0.5) * cell, origin[1] + (row + 0.5) * cell)


@numba.njit(
    "int64(uint8[:,::1], int64, int64, float64, float64, float64, float64, float64, float64)",
    cache=True,
)
def _search(
    free: Any, row: int, column: int, x: float, y: float, apart: float, inner: float, outer: float, far: float
) -> int:
    """Flat index of the first good cell in order of steps from the start; -1 when there is none."""
    ny, nx = free.shape
    seen = np.zeros((ny, nx), dtype=np.uint8)
    queue = np.empty(ny * nx, dtype=np.int64)
    count, done = 0, 0
    for j in range(max(row - 1, 0), min(row + 2, ny)):
        for i in range(max(column - 1, 0), min(column + 2, nx)):
            seen[j, i] = 1
            queue[count] = j * nx + i
            count += 1
    while done < count:
        j, i = queue[done] // nx, queue[done] % nx
        done += 1
        if free[j, i] and math.hypot(i + 0.5 - x, j + 0.5 - y) >= apart and _pieces(free, j, i, inner, outer) <= 1:
            return j * nx + i
        for dj, di in ((0, 1), (1, 0), (0, -1), (-1, 0)):
            b, a = j + dj, i + di
            if 0 <= b < ny and 0 <= a < nx and free[b, a] and not seen[b, a]:
                seen[b, a] = 1
                if math.hypot(b - row, a - column) <= far:
                    queue[count] = b * nx + a
                    count += 1
    return -1


@numba.njit("int64(uint8[:,::1], int64, int64, float64, float64)", cache=True)
def _pieces(free: Any, row: int, column: int, inner: float, outer: float) -> int:
    """How many pieces the free floor between two radii [cells] around a cell falls into."""
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
