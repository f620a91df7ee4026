"""Compiled: cells worth a visit, and groups of them (see `marching`, `searching`); knows nothing of records."""

from __future__ import annotations

from typing import Any

import numba

from hthor.navigation.searching import _DX, _DY, FAR


@numba.njit(
    "void(uint8[:,::1], uint8[:,::1], uint8[:,::1], uint8[:,::1], int32[:,::1], int64[::1], boolean, uint8[:,::1])",
    cache=True,
)
def mark(cells: Any, level: Any, beside: Any, near: Any, cost: Any, window: Any, edges: bool, mask: Any) -> None:
    """Mark reached free cells: those next to the unknown (``edges``), or those along furniture never seen close."""
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
                mask[j, i] = 1 if level[j, i] == 1 and beside[j, i] and near[j, i] == 0 else 0


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
