"""Shortest paths of a round body on a map that is still being explored."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hthor.navigation import grid_search_kernel, path_smoothing_kernel, scan_kernel
from hthor.navigation.distance_field import Field
from hthor.navigation.grid_map import CELL_M, GridMap
from hthor.navigation.search_window import ESCAPE_CELLS, SearchWindow, path_cost
from hthor.types import Vec2

_HARD_M = 0.026
"""[m] Clearance between the body and the centre of an occupied cell: with less, the body would scrape along walls."""
_SOFT_M = 0.10
"""[m] A path that comes closer to obstacles than this costs a fifth more."""
_BORDER_CELLS = 12


class Planner:
    """Plans paths on a `GridMap` for a disc of ``radius`` [m]; keeps up with changes of the map.

    If ``optimistic``, unknown cells count as passable, so that a path to any place can be tried; else only free cells.
    Cells where the body would touch an obstacle are closed; cells close to an obstacle cost a fifth more.
    """

    def __init__(self, grid: GridMap, radius: float, optimistic: bool = True) -> None:
        self.grid, self.radius, self.optimistic = grid, radius, optimistic
        self._disc = _disc(radius)
        self._version, self._stamped = -1, 0
        self._cells: NDArray[np.uint8] = grid.cells
        self._allocate()

    def path(self, a: Vec2, b: Vec2, within: float = 0.0, most: float = math.inf) -> tuple[Vec2, ...] | None:
        """Way points [m] from ``a`` to ``b``, both included, or None when there is no path.

        Args:
            a: where the body is [m]. A body too close to an obstacle first goes to the nearest free cell.
            b: where to go [m]. A place where the body cannot stand is replaced by the nearest free place within 0.7 m.
            within: [m] the path ends as soon as it is this close to ``b``.
            most: [m] ignore paths whose cost on the lattice is above that of this length of clear cells.
        """
        self._follow()
        start, escape = self._enter(a)
        if start is None:
            return None
        goal, snapped = self._cell(b), True
        if within <= 0.0:
            spot = self._nearest(b)
            if spot is None:
                return None
            snapped = spot != self._row_column(b)
            goal = (spot[1] + 0.5, spot[0] + 0.5) if snapped else goal
        apart = abs(start[1] - math.floor(goal[0])), abs(start[0] - math.floor(goal[1]))
        key = grid_search_kernel.rank(*apart, within / CELL_M)
        window = SearchWindow(self._cells, self._level, self.optimistic, self._window(start, (a, b)), start, key)
        end = window.seek(*goal, within / CELL_M, path_cost(most))
        return None if end < 0 else self._pulled(window, end, a, None if snapped else b, escape)

    def distance(self, a: Vec2, b: Vec2, within: float = 0.0) -> float:
        """Length [m] of `path`; infinite when there is none."""
        way = self.path(a, b, within)
        return math.inf if way is None else path_length(way)

    def field(self, a: Vec2, cover: Sequence[Vec2] = ()) -> Field:
        """Shortest paths from ``a`` to every cell of the known map and of the box around ``cover`` [m]."""
        self._follow()
        start, escape = self._enter(a)
        edges = self._window(start, (a, *cover))
        window = None if start is None else SearchWindow(self._cells, self._level, self.optimistic, edges, start)
        return Field(self.grid, window, lambda window, end, b: self._pulled(window, end, a, b, escape))

    def distances(self, a: Vec2, points: Sequence[Vec2], most: float = math.inf) -> tuple[float, ...]:
        """Walking distance [m] from ``a`` to each point; infinite without a path of at most ``most`` [m].

        One search serves all points and goes no farther than necessary. Distances follow the lattice and its costs, and
        are up to 8 % longer than the walked path.
        """
        return self.field(a, points).distances(points, most)

    def nearest(self, a: Vec2, groups: Sequence[Sequence[Vec2]]) -> tuple[tuple[float, int], ...]:
        """For each group, the walking distance [m] to its nearest point, as from `distances`, and that point's index.

        Infinity and -1 for a group without a path to any of its points. One search serves all groups.
        """
        return self.field(a, [point for group in groups for point in group]).nearest(groups)

    def fits(self, x: float, y: float) -> bool:
        """Whether the body can stand at (``x``, ``y``) [m], according to the map."""
        self._follow()
        row, column = self._row_column((x, y))
        ny, nx = self._cells.shape
        inside = 0 <= row < ny and 0 <= column < nx
        return inside and bool(grid_search_kernel.passable(self._cells, self._level, self.optimistic, row, column))

    def straight(self, a: Vec2, b: Vec2) -> bool:
        """Whether the body can go straight from ``a`` to ``b`` [m]; its present cell is not checked."""
        self._follow()
        ax, ay = self._cell(a)
        bx, by = self._cell(b)
        return bool(path_smoothing_kernel.line_cost(self._cells, self._level, self.optimistic, ax, ay, bx, by) >= 0.0)

    def clear(self, points: Sequence[Vec2]) -> bool:
        """Whether the body can go straight from each point [m] to the next; its present cell is not checked."""
        self._follow()
        known, ends = (self._cells, self._level, self.optimistic), [self._cell(point) for point in points]
        return all(path_smoothing_kernel.line_cost(*known, *a, *b) >= 0.0 for a, b in pairwise(ends))

    @property
    def levels(self) -> NDArray[np.uint8]:
        """(ny, nx) uint8 over the map: 0 clear, 1 tight, 2 no room for the body."""
        self._follow()
        return self._level

    def _follow(self) -> None:
        """Update the levels from the map."""
        grid = self.grid
        if self._version == grid.version:
            return
        if self._frame != (grid.left, grid.bottom, *grid.cells.shape):
            self._grow()
        self._cells = grid.cells
        obstacles = grid.obstacles
        scan_kernel.inflate(self._level, obstacles, self._stamped, len(obstacles), grid.left, grid.bottom, self._disc)
        self._stamped = len(obstacles)
        self._version = grid.version

    def _grow(self) -> None:
        """Move levels to a larger array after the map has grown, and inflate obstacles at the old edges again."""
        (left, bottom, ny, nx), level, stamped = self._frame, self._level, self._stamped
        self._allocate()
        column, row = left - self.grid.left, bottom - self.grid.bottom
        self._level[row : row + ny, column : column + nx] = level
        x, y = (self.grid.obstacles[:stamped, axis] - edge for axis, edge in ((0, left), (1, bottom)))
        reach = int(self._disc.max())
        off = (x < reach) | (y < reach) | (x >= nx - reach) | (y >= ny - reach)
        obstacles = self.grid.obstacles[:stamped][off]
        frame = self.grid.left, self.grid.bottom
        scan_kernel.inflate(self._level, obstacles, 0, len(obstacles), *frame, self._disc)
        self._stamped = stamped

    def _allocate(self) -> None:
        grid = self.grid
        shape = grid.cells.shape
        self._frame = (grid.left, grid.bottom, *shape)
        self._cells = grid.cells
        self._level: NDArray[np.uint8] = np.zeros(shape, dtype=np.uint8)
        self._stamped = 0

    def _window(self, start: tuple[int, int] | None, points: Sequence[Vec2]) -> tuple[int, int, int, int]:
        """First and last column, first and last row of a window around the known map and the points, with a border."""
        ny, nx = self._cells.shape
        x0, x1, y0, y1 = self.grid.bounds.tolist()
        for point in points:
            row, column = self._row_column(point)
            x0, x1, y0, y1 = min(x0, column), max(x1, column), min(y0, row), max(y1, row)
        border = _BORDER_CELLS
        x0, x1, y0, y1 = max(x0 - border, 0), min(x1 + border, nx - 1), max(y0 - border, 0), min(y1 + border, ny - 1)
        if start is None:
            return x0, x1, y0, y1
        return min(x0, start[1]), max(x1, start[1]), min(y0, start[0]), max(y1, start[0])

    def _cell(self, point: Vec2) -> Vec2:
        """The point in cells of the map's array, (column, row)."""
        return point[0] / CELL_M - self.grid.left, point[1] / CELL_M - self.grid.bottom

    def _metres(self, x: float, y: float) -> Vec2:
        return (x + self.grid.left) * CELL_M, (y + self.grid.bottom) * CELL_M

    def _row_column(self, point: Vec2) -> tuple[int, int]:
        """The point's cell, which may lie outside the map."""
        x, y = self._cell(point)
        return math.floor(y), math.floor(x)

    def _nearest(self, point: Vec2) -> tuple[int, int] | None:
        """The nearest cell that the body can be in; None if no such cell is close by or the point is far outside."""
        row, column = self._row_column(point)
        flat = grid_search_kernel.nearest(self._cells, self._level, self.optimistic, row, column, ESCAPE_CELLS)
        return None if flat < 0 else divmod(int(flat), self._cells.shape[1])

    def _enter(self, a: Vec2) -> tuple[tuple[int, int] | None, bool]:
        """The cell where a path from ``a`` begins, and whether the body must first leave a tight place to get there."""
        start = self._nearest(a)
        return start, start is not None and start != self._row_column(a)

    def _pulled(self, window: SearchWindow, end: int, a: Vec2, b: Vec2 | None, escape: bool) -> tuple[Vec2, ...]:
        """The smoothed path [m] that a search found to its cell ``end``, from exactly ``a`` to exactly ``b``.

        If ``escape``, the path first leads from ``a`` to the cell where the search began.
        """
        points, costs = window.trace(end)
        first = self._cell(a)
        if not escape:
            points[0] = first
        if b is not None:
            points[-1] = self._cell(b)
        keep = np.empty(len(points), dtype=np.int64)
        kept = path_smoothing_kernel.straighten(self._cells, self._level, self.optimistic, points, costs, keep)
        bends = np.ascontiguousarray(points[keep[:kept]])
        kept = path_smoothing_kernel.tighten(self._cells, self._level, self.optimistic, bends, kept)
        way = [self._metres(x, y) for x, y in bends[:kept].tolist()]
        if b is not None:
            way[-1] = b
        if escape:
            return (a, *way)
        way[0] = a
        return tuple(way)


def path_length(way: Sequence[Vec2]) -> float:
    """Length [m] of a path."""
    return math.fsum(math.dist(way[k], way[k + 1]) for k in range(len(way) - 1))


def _disc(radius: float) -> NDArray[np.int64]:
    """(N, 3) column and row offsets, and the level that an occupied cell gives to the cell at that offset."""
    reach = math.ceil((radius + _SOFT_M) / CELL_M)
    rows = []
    for row in range(-reach, reach + 1):
        for column in range(-reach, reach + 1):
            apart = math.hypot(column, row) * CELL_M
            if apart <= radius + _SOFT_M:
                rows.append((column, row, 2 if apart <= radius + _HARD_M else 1))
    return np.array(rows, dtype=np.int64)
