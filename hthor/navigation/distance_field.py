"""Shortest paths from one place of a map, computed only as far as needed."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from hthor.navigation import grid_search_kernel
from hthor.navigation.grid_map import CELL_M, GridMap
from hthor.navigation.search_window import ESCAPE_CELLS, SearchWindow, path_cost
from hthor.types import Vec2

Pull = Callable[[SearchWindow, int, Vec2 | None], tuple[Vec2, ...]]
"""Returns the smoothed path [m] to a cell of the window, given by its flat index, and on to a point [m] if given."""


class Field:
    """Shortest paths from one place to everywhere in a window, on the map as it was when this object was made.

    Args:
        grid: the map.
        window: the search from that place; None when the body can stand nowhere near it.
        pull: makes a smoothed path from the cells on the search's way.
    """

    def __init__(self, grid: GridMap, window: SearchWindow | None, pull: Pull) -> None:
        self._grid, self.window, self._pull = grid, window, pull
        self._frame = (grid.left, grid.bottom, *grid.cells.shape)

    def distance(self, b: Vec2, within: float = 0.0) -> float:
        """Walking distance [m] to ``b``, or to the nearest place within ``within`` [m] of it; infinite without a path.

        Without ``within``, a place where the body cannot stand is replaced by the nearest free place within 0.7 m.
        """
        flat = self._best(b, within)
        return math.inf if flat < 0 else self.metres(flat)

    def distances(self, points: Sequence[Vec2], most: float = math.inf) -> tuple[float, ...]:
        """Walking distance [m] to each point, as from `distance`; infinite if it is more than ``most`` [m]."""
        window = self.window
        if window is None:
            return (math.inf,) * len(points)
        spots = [self._spot(point) for point in points]
        news = sum(window.watch(spot) for spot in spots if spot >= 0)
        endless = math.isinf(most)
        if news:
            window.spread(news, path_cost(most))
        found = []
        for point, spot in zip(points, spots, strict=True):
            if spot >= 0 and window.settled(spot):
                found.append(self.metres(spot))
            else:
                found.append(self.distance(point) if endless else math.inf)
        return tuple(found)

    def nearest(self, groups: Sequence[Sequence[Vec2]]) -> tuple[tuple[float, int], ...]:
        """For each group, the walking distance [m] to its nearest point, as from `distance`, and that point's index.

        Infinity and -1 for a group without a path to any of its points.
        """
        window = self.window
        if window is None:
            return ((math.inf, -1),) * len(groups)
        spots = [[self._spot(point) for point in group] for group in groups]
        cells = [{spot for spot in group if spot >= 0} for group in spots]
        for spot in set().union(*cells):
            window.watch(spot)
        missing = [number for number, group in enumerate(cells) if group]
        while missing:
            found = window.spread(len(missing))  # each missing group needs at least one more watched cell
            if found < 0:
                break
            left = [number for number in missing if not any(map(window.settled, cells[number]))]
            wanted = set().union(*(cells[number] for number in left))
            for spot in set().union(*(cells[number] for number in missing)) - wanted:
                window.ignore(spot)
            missing = left
        return tuple(self._nearest(group, cells) for group, cells in zip(groups, spots, strict=True))

    def _nearest(self, points: Sequence[Vec2], spots: Sequence[int]) -> tuple[float, int]:
        """The nearest of the ``spots`` of these points that was reached, else by `distance`: distance [m] and index."""
        assert self.window is not None
        reached = [(self.metres(spot), k) for k, spot in enumerate(spots) if spot >= 0 and self.window.settled(spot)]
        least = min(reached or ((self.distance(point), k) for k, point in enumerate(points)), default=(math.inf, -1))
        return least if math.isfinite(least[0]) else (math.inf, -1)

    def path(self, b: Vec2, within: float = 0.0) -> tuple[Vec2, ...] | None:
        """Way points [m] as from `Planner.path`; None if there is no path, or if the map has become larger since."""
        flat, grid = self._best(b, within), self._grid
        if flat < 0 or self.window is None or self._frame != (grid.left, grid.bottom, *grid.cells.shape):
            return None
        exact = b if flat == self._index(b) else None
        return self._pull(self.window, flat, exact)

    def metres(self, flat: int) -> float:
        """Length [m] of the path to a cell that the search has reached."""
        assert self.window is not None
        return int(self.window.cost[flat]) / grid_search_kernel.STEP * CELL_M

    @property
    def reached(self) -> float:
        """All cells at a smaller path length [m] than this have been reached."""
        return 0.0 if self.window is None else self.window.reached / grid_search_kernel.STEP * CELL_M

    def _cell(self, b: Vec2) -> tuple[int, int]:
        """Row and column of the cell at a point."""
        return math.floor(b[1] / CELL_M) - self._frame[1], math.floor(b[0] / CELL_M) - self._frame[0]

    def _index(self, b: Vec2) -> int:
        assert self.window is not None
        row, column = self._cell(b)
        return self.window.flat(row, column) if self.window.holds(row, column) else -1

    def _spot(self, b: Vec2) -> int:
        """The cell where the path of `distance` ends, if there is a path; -1 when no free cell is close by."""
        assert self.window is not None
        flat = self._index(b)
        if flat >= 0 and self.window.open(flat):
            return flat
        return self._pick(b, 0.0, False)

    def _best(self, b: Vec2, within: float) -> int:
        """The reached cell for ``b``: the cheapest within ``within``, or else the nearest to ``b``; -1 for none."""
        window = self.window
        if window is None:
            return -1
        flat = self._index(b)
        if within <= 0.0 and flat >= 0 and window.settled(flat):
            return flat
        window.spread(0)
        return self._pick(b, within, True)

    def _pick(self, b: Vec2, within: float, reached: bool) -> int:
        """The cell for ``b``, as in `_best`, among cells that were ``reached``, or else that may be; -1 for none."""
        assert self.window is not None
        window, (row, column), (left, bottom, _, _) = self.window, self._cell(b), self._frame
        x0, x1, y0, y1 = window.edges
        span = max(math.ceil(within / CELL_M), 0) if within > 0.0 else ESCAPE_CELLS
        i0, i1, j0, j1 = max(column - span, x0), min(column + span, x1), max(row - span, y0), min(row + span, y1)
        if i0 > i1 or j0 > j1:
            return -1
        box = (slice(j0 - window.bottom, j1 + 1 - window.bottom), slice(i0 - window.left, i1 + 1 - window.left))
        cost = window.cost.reshape(-1, window.width)[box]
        good = cost < grid_search_kernel.FAR
        if not reached:
            good |= window.state.reshape(-1, window.width)[box] != grid_search_kernel.CLOSED
        dx = np.arange(i0, i1 + 1) + (0.5 + left) - b[0] / CELL_M
        dy = np.arange(j0, j1 + 1) + (0.5 + bottom) - b[1] / CELL_M
        apart = dy[:, None] ** 2 + dx[None, :] ** 2
        good &= apart <= ((within / CELL_M) ** 2 if within > 0.0 else span * span)
        rank = np.where(good, cost if within > 0.0 else apart, np.inf)
        j, i = divmod(int(np.argmin(rank)), i1 + 1 - i0)
        return window.flat(j + j0, i + i0) if good[j, i] else -1
