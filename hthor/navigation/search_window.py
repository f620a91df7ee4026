"""One search over a window of a map, and its result."""

import math

import numpy as np
from numpy.typing import NDArray

from hthor.navigation import frontier_kernel, grid_search_kernel
from hthor.navigation.grid_map import CELL_M

ESCAPE_CELLS = 14
"""[cells] A place where the body cannot stand is replaced by the nearest free place within this distance."""
_LONGEST = 8192


def path_cost(metres: float) -> int:
    """The cost of a path of length ``metres`` [m] through clear cells, rounded up."""
    return grid_search_kernel.FAR if math.isinf(metres) else math.floor(metres / CELL_M * grid_search_kernel.STEP) + 1


class SearchWindow:
    """The cheapest paths from one cell through a window of a map.

    Rows and columns are those of the map; ``flat`` indices are those of the window, which has a border of one cell.

    Attributes:
        state, cost, came: flat arrays, see `grid_search_kernel.prepare`. start: flat index of the first cell.
        edges: (4,) first and last column, first and last row. width: columns of the bordered window.
    """

    def __init__(
        self,
        cells: NDArray[np.uint8],
        level: NDArray[np.uint8],
        optimistic: bool,
        edges: tuple[int, int, int, int],
        start: tuple[int, int],
        key: int = 0,
    ) -> None:
        """``start`` is a (row, column), ``key`` the least possible cost of the path to the goal."""
        x0, x1, y0, y1 = self.edges = edges
        self.left, self.bottom, self.width = x0 - 1, y0 - 1, x1 - x0 + 3
        size = self.width * (y1 - y0 + 3)
        self.state: NDArray[np.uint8] = np.empty(size, dtype=np.uint8)
        self.cost: NDArray[np.int32] = np.empty(size, dtype=np.int32)
        self.came: NDArray[np.int8] = np.empty(size, dtype=np.int8)
        self.start = self.flat(*start)
        heads = np.empty(grid_search_kernel.BUCKETS, dtype=np.int32)
        chain, item = np.empty(8 * size, dtype=np.int32), np.empty(8 * size, dtype=np.int32)
        self._queue = (heads, chain, item, np.empty(3, dtype=np.int64))
        window = np.array(edges, dtype=np.int64)
        grid_search_kernel.prepare(
            cells, level, optimistic, window, self.start, self.state, self.cost, self.came, *self._queue, key
        )

    def flat(self, row: int, column: int) -> int:
        """The flat index of a cell of the map."""
        return (row - self.bottom) * self.width + column - self.left

    def cell(self, flat: int) -> tuple[int, int]:
        """The map's row and column of the cell with a flat index."""
        row, column = divmod(flat, self.width)
        return row + self.bottom, column + self.left

    def holds(self, row: int, column: int) -> bool:
        """Whether the cell lies in the window."""
        x0, x1, y0, y1 = self.edges
        return x0 <= column <= x1 and y0 <= row <= y1

    def seek(self, x: float, y: float, within: float, most: int = grid_search_kernel.FAR) -> int:
        """The flat index of the last cell of the cheapest path to within ``within`` cells of (``x``, ``y``) [cells].

        -1 when no path costs ``most`` or less.
        """
        arrays = self.state, self.cost, self.came, self.width, self.left, self.bottom
        return int(grid_search_kernel.seek(*arrays, x, y, within, most, *self._queue))

    def watch(self, flat: int) -> bool:
        """Let searches stop at this cell; returns False if it is closed or watched already."""
        news = grid_search_kernel.CLOSED < int(self.state[flat]) < grid_search_kernel.WATCHED
        if news:
            self.state[flat] |= grid_search_kernel.WATCHED
        return news

    def ignore(self, flat: int) -> None:
        """Let searches no longer stop at this cell."""
        self.state[flat] &= ~np.uint8(grid_search_kernel.WATCHED)

    def spread(self, watched: int, most: int = grid_search_kernel.FAR) -> int:
        """Search on until ``watched`` more watched cells are reached; returns the last, -1 if ``most`` came first."""
        return int(grid_search_kernel.spread(self.state, self.cost, self.came, self.width, watched, most, *self._queue))

    def reach(self, names: NDArray[np.int16], known: NDArray[np.uint8], goal: int) -> int:
        """Search on to the watched cell ``goal``, or to a cell of a group that is not ``known``; -1 for none."""
        arrays = self.state, self.cost, self.came, self.width
        return int(frontier_kernel.reach_group(names, known, goal, *arrays, *self._queue))

    def open(self, flat: int) -> bool:
        """Whether there may be a path to this cell."""
        return bool(self.state[flat] != grid_search_kernel.CLOSED or self.cost[flat] < grid_search_kernel.FAR)

    def settled(self, flat: int) -> bool:
        """Whether the cheapest path to this cell is known."""
        return bool(self.state[flat] == grid_search_kernel.CLOSED and self.cost[flat] < grid_search_kernel.FAR)

    @property
    def reached(self) -> int:
        """The cost below which every cell has been reached."""
        return int(self._queue[3][0])

    def trace(self, end: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Cell centres (N, 2) [cells of the map] and costs (N,) on the path to the cell ``end``."""
        count = grid_search_kernel.steps(self.came, self.width, self.start, end, min(self.cost.size, _LONGEST))
        points, costs = np.empty((count, 2), dtype=np.float64), np.empty(count, dtype=np.float64)
        grid_search_kernel.trace(self.came, self.cost, self.width, end, self.left, self.bottom, points, costs)
        return points, costs
