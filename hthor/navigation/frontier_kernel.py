"""Compiled: cells worth a visit, and groups of them (see `scan_kernel`, `grid_search_kernel`)."""

from typing import Any

import numba
import numpy as np

from hthor.navigation.grid_search_kernel import _DX, _DY, FAR, WATCHED, spread

_STRETCH = 32
"""Number of cells that are checked for marks in one step, because few cells are marked."""


@numba.njit(
    "int64(uint8[:,::1], uint8[:,::1], uint8[:,::1], uint8[:,::1], int64[::1], uint8[:,::1], int32[::1])", cache=True
)
def mark_cells(cells: Any, level: Any, beside: Any, near: Any, bounds: Any, mask: Any, marked: Any) -> int:
    """Mark free cells where a body has room: 1 next to unknown cells, 2 along furniture never seen from close by.

    Args:
        bounds: of the known map, see `GridMap`.
        mask: output, zero outside ``bounds`` before. marked: output, flat indices of all marked cells, in order.

    Returns:
        How many cells are marked.
    """
    ny, nx = cells.shape
    count = 0
    x0, x1 = max(bounds[0], 1), min(bounds[1], nx - 2) + 1
    for j in range(max(bounds[2], 1), min(bounds[3], ny - 2) + 1):  # a loop that becomes vector instructions
        here, west, east = cells[j, x0:x1], cells[j, x0 - 1 : x1 - 1], cells[j, x0 + 1 : x1 + 1]
        south, north, tight = cells[j - 1, x0:x1], cells[j + 1, x0:x1], level[j, x0:x1]
        along, seen, out = beside[j, x0:x1], near[j, x0:x1], mask[j, x0:x1]
        for i in range(len(out)):
            room = (here[i] == 1) & (tight[i] < 2)
            edge = room & ((west[i] == 0) | (east[i] == 0) | (south[i] == 0) | (north[i] == 0))
            unvisited = room & (tight[i] == 1) & (along[i] != 0) & (seen[i] == 0)
            out[i] = (1 if edge else 0) | (2 if unvisited else 0)
        for begin in range(0, len(out), _STRETCH):
            some = np.uint8(0)
            stretch = out[begin : begin + _STRETCH]
            for i in range(len(stretch)):
                some |= stretch[i]
            if some:
                for i in range(len(stretch)):
                    if stretch[i]:
                        marked[count] = j * nx + x0 + begin + i
                        count += 1
    return count


@numba.njit("int64(uint8[:,::1], int32[::1], uint8, int32[::1], int64[:,::1])", cache=True)
def group_cells(mask: Any, marked: Any, bit: int, members: Any, out: Any) -> int:
    """Group the ``marked`` cells that have ``bit`` in the mask, ordered by first cell; returns the number of groups.

    The bit is cleared. Each row of ``out`` has a group's centre cell (row, column), which is the member nearest to its
    middle, and the first and last + 1 index of its cells in ``members``, which are flat indices.
    """
    nx = mask.shape[1]
    groups, done = 0, 0
    for start in marked:
        row, column = start // nx, start % nx
        if mask[row, column] & bit == 0 or groups == len(out):
            continue
        mask[row, column] ^= bit
        first, size = done, done + 1
        members[first] = row * nx + column
        sum_x, sum_y = 0, 0
        while done < size:
            j, i = members[done] // nx, members[done] % nx
            done += 1
            sum_x += i
            sum_y += j
            for d in range(8):
                a, b = i + _DX[d], j + _DY[d]
                if mask[b, a] & bit:
                    mask[b, a] ^= bit
                    members[size] = b * nx + a
                    size += 1
        best, best2 = members[first], 1e18
        for s in range(first, size):
            j, i = members[s] // nx, members[s] % nx
            ex, ey = i - sum_x / (size - first), j - sum_y / (size - first)
            if ex * ex + ey * ey < best2:
                best, best2 = members[s], ex * ex + ey * ey
        out[groups, 0] = best // nx
        out[groups, 1] = best % nx
        out[groups, 2] = first
        out[groups, 3] = size
        groups += 1
    return groups


@numba.njit(
    "int64(int32[::1], int64[:,::1], int64, float64, float64, int64, int64, int64, uint8[::1], int16[::1], int64)",
    cache=True,
)
def watch_groups(
    members: Any,
    groups: Any,
    count: int,
    cell: float,
    least: float,
    width: int,
    columns: int,
    offset: int,
    state: Any,
    names: Any,
    number: int,
) -> int:
    """Let a search stop at the members of the large groups, whose numbers are written to ``names``.

    Args:
        groups: ``count`` groups from `group_cells`; the large groups are moved to the front.
        cell, least: a group is large if its number of members times ``cell`` is at least ``least``.
        width: columns of the map. columns: of the search's window. offset: of the map's cell 0 in the window.
        number: the number of the last group before these.

    Returns:
        How many groups are large.
    """
    large = 0
    for k in range(count):
        first, last = groups[k, 2], groups[k, 3]
        if (last - first) * cell < least:
            continue
        for c in range(4):
            groups[large, c] = groups[k, c]
        large += 1
        for s in range(first, last):
            row = members[s] // width
            here = row * columns + members[s] - row * width + offset
            state[here] |= WATCHED
            names[here] = number + large
    return large


@numba.njit(
    "int64(int16[:,::1], uint8[::1], int64, uint8[::1], int32[::1], int8[::1], int64, int32[::1], int32[::1],"
    " int32[::1], int64[::1])",
    cache=True,
)
def reach_group(
    names: Any,
    known: Any,
    goal: int,
    state: Any,
    cost: Any,
    came: Any,
    width: int,
    heads: Any,
    chain: Any,
    item: Any,
    memo: Any,
) -> int:
    """Spread (see `grid_search_kernel.spread`) to the cell ``goal`` or a cell of a group not ``known``; -1 for none."""
    while True:
        here = spread(state, cost, came, width, 1, FAR, heads, chain, item, memo)
        if here < 0 or here == goal or not (known[names[0, here]] and known[names[1, here]]):
            return int(here)
