"""Shortest paths of a round body on a map that is still being made; knows nothing of goals or of motions."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hthor.navigation import marching, pulling, searching
from hthor.navigation.map import CELL_M, GridMap
from hthor.types import Vec2

_HARD_M = 0.026
"""Kept between the body and the middle of an occupied cell: less, and it would scrape along walls."""
_SOFT_M = 0.10
"""A path avoids coming this close where there is room: it costs a fifth more."""
_ESCAPE_CELLS = 14
_BORDER_CELLS = 12


class Planner:
    """Plans on a `GridMap` for a disc of ``radius`` metres; follows the map as it changes.

    With ``optimistic`` unknown cells count as passable, so that every place can be tried; without, only free cells do.
    Cells where the body would touch are closed, cells where it would come close cost a fifth more.
    """

    def __init__(self, grid: GridMap, radius: float, optimistic: bool = True) -> None:
        self.grid, self.radius, self.optimistic = grid, radius, optimistic
        self._disc = _disc(radius)
        self._version, self._stamped = -1, 0
        self._cells: NDArray[np.uint8] = grid.cells
        self._allocate()

    def path(self, a: Vec2, b: Vec2, within: float = 0.0) -> tuple[Vec2, ...] | None:
        """Way points [m] from ``a`` to ``b``, both included, or None when there is no way.

        Args:
            a: where the body is. When it stands too close to something it first leaves by the nearest free cell.
            b: where to go. A place that the body cannot stand on is replaced by the nearest one within 0.7 m.
            within: [m] being this close to ``b`` is enough; the path then ends where that is first so.
        """
        self._follow()
        start, escape = self._enter(a)
        goal = self._cell(b)
        if start < 0:
            return None
        if within <= 0.0:
            spot = self._nearest(b)
            if spot < 0:
                return None
            snapped = spot != self._flat(b)
            goal = self._centre(spot) if snapped else goal
        else:
            snapped = True
        nx = self._cells.shape[1]
        found = searching.search(
            self._cells,
            self._level,
            self.optimistic,
            start // nx,
            start % nx,
            goal[0],
            goal[1],
            within / CELL_M,
            True,
            self._window((a, b)),
            self._cost,
            self._came,
            self._chain,
            self._item,
        )
        if found < 0:
            return None
        return self._pulled(self._cost, self._came, start, int(found), a, None if snapped else b, escape)

    def distance(self, a: Vec2, b: Vec2, within: float = 0.0) -> float:
        """Length [m] of `path`; infinite when there is none."""
        way = self.path(a, b, within)
        return math.inf if way is None else length(way)

    def field(self, a: Vec2, cover: Sequence[Vec2] = ()) -> Field:
        """Shortest ways from ``a`` to every cell of the known map and of the box around ``cover`` [m]."""
        self._follow()
        start, escape = self._enter(a)
        cost = np.empty(self._cells.shape, dtype=np.int32)
        came = np.empty(self._cells.shape, dtype=np.int8)
        window = self._window((a, *cover))
        if start < 0:
            _window_view(cost, window)[:] = searching.FAR
        else:
            nx = self._cells.shape[1]
            searching.search(
                self._cells,
                self._level,
                self.optimistic,
                start // nx,
                start % nx,
                0.0,
                0.0,
                0.0,
                False,
                window,
                cost,
                came,
                self._chain,
                self._item,
            )
        return Field(self, a, start, escape, cost, came, window)

    def distances(self, a: Vec2, points: Sequence[Vec2], within: float = 0.0) -> tuple[float, ...]:
        """Walking distance [m] from ``a`` to (within ``within`` metres of) each point; infinite where there is no way.

        One search serves all points. Distances follow the lattice and the costs: up to 8 % longer than the way walked.
        """
        field = self.field(a, points)
        return tuple(field.distance(point, within) for point in points)

    def fits(self, x: float, y: float) -> bool:
        """Whether the body may stand at (``x``, ``y``) [m], as far as the map tells."""
        self._follow()
        flat = self._flat((x, y))
        nx = self._cells.shape[1]
        return flat >= 0 and bool(
            searching.passable(self._cells, self._level, self.optimistic, flat // nx, flat % nx),
        )

    def straight(self, a: Vec2, b: Vec2) -> bool:
        """Whether the body can go straight from ``a`` to ``b``; where it stands now does not count."""
        self._follow()
        ax, ay = self._cell(a)
        bx, by = self._cell(b)
        return bool(pulling.line_cost(self._cells, self._level, self.optimistic, ax, ay, bx, by) >= 0.0)

    @property
    def levels(self) -> NDArray[np.uint8]:
        """(ny, nx) uint8 over the map: 0 clear, 1 tight, 2 no room for the body."""
        self._follow()
        return self._level

    def _follow(self) -> None:
        """Take over what the map has learnt since."""
        grid = self.grid
        if self._version == grid.version:
            return
        if self._frame != (grid.left, grid.bottom, *grid.cells.shape):
            self._allocate()
        self._cells = grid.cells
        obstacles = grid.obstacles
        marching.inflate(self._level, obstacles, self._stamped, len(obstacles), grid.left, grid.bottom, self._disc)
        self._stamped = len(obstacles)
        self._version = grid.version

    def _allocate(self) -> None:
        grid = self.grid
        shape = grid.cells.shape
        self._frame = (grid.left, grid.bottom, *shape)
        self._cells = grid.cells
        self._level: NDArray[np.uint8] = np.zeros(shape, dtype=np.uint8)
        self._cost: NDArray[np.int32] = np.empty(shape, dtype=np.int32)
        self._came: NDArray[np.int8] = np.empty(shape, dtype=np.int8)
        self._chain: NDArray[np.int32] = np.empty(8 * grid.cells.size + 8, dtype=np.int32)
        self._item: NDArray[np.int32] = np.empty(8 * grid.cells.size + 8, dtype=np.int32)
        self._stamped = 0

    def _window(self, points: Sequence[Vec2]) -> NDArray[np.int64]:
        """First and last column, first and last row of the known map and the points, with a border."""
        ny, nx = self._cells.shape
        x0, x1, y0, y1 = (int(bound) for bound in self.grid.bounds)
        for point in points:
            x, y = self._cell(point)
            x0, x1, y0, y1 = min(x0, int(x)), max(x1, int(x)), min(y0, int(y)), max(y1, int(y))
        border = _BORDER_CELLS
        return np.array(
            [max(x0 - border, 0), min(x1 + border, nx - 1), max(y0 - border, 0), min(y1 + border, ny - 1)],
            dtype=np.int64,
        )

    def _cell(self, point: Vec2) -> Vec2:
        """The point [cells] of the map's array, columns first."""
        return point[0] / CELL_M - self.grid.left, point[1] / CELL_M - self.grid.bottom

    def _metres(self, x: float, y: float) -> Vec2:
        return (x + self.grid.left) * CELL_M, (y + self.grid.bottom) * CELL_M

    def _centre(self, flat: int) -> Vec2:
        nx = self._cells.shape[1]
        return flat % nx + 0.5, flat // nx + 0.5

    def _flat(self, point: Vec2) -> int:
        """Index of the point's cell; -1 outside the map."""
        ny, nx = self._cells.shape
        x, y = self._cell(point)
        column, row = math.floor(x), math.floor(y)
        return row * nx + column if 0 <= column < nx and 0 <= row < ny else -1

    def _nearest(self, point: Vec2) -> int:
        """Index of the nearest cell the body may be in; -1 when there is none close by or the point is far outside."""
        x, y = self._cell(point)
        return int(
            searching.nearest(self._cells, self._level, self.optimistic, math.floor(y), math.floor(x), _ESCAPE_CELLS)
        )

    def _enter(self, a: Vec2) -> tuple[int, bool]:
        """The cell where a path from ``a`` begins, and whether that is a way out of a too tight spot."""
        start = self._nearest(a)
        return start, start >= 0 and start != self._flat(a)

    def _pulled(
        self,
        cost: NDArray[np.int32],
        came: NDArray[np.int8],
        start: int,
        end: int,
        a: Vec2,
        b: Vec2 | None,
        escape: bool,
    ) -> tuple[Vec2, ...]:
        """The way from ``start`` to ``end`` with the string pulled tight, from ``a`` and to ``b`` exactly."""
        points, costs = _trace(cost, came, start, end)
        first = self._cell(a)
        if not escape:
            points[0] = first
        if b is not None:
            points[-1] = self._cell(b)
        keep = np.empty(len(points), dtype=np.int64)
        kept = pulling.straighten(self._cells, self._level, self.optimistic, points, costs, keep)
        bends = np.ascontiguousarray(points[keep[:kept]])
        kept = pulling.tighten(self._cells, self._level, self.optimistic, bends, kept)
        way = [self._metres(x, y) for x, y in bends[:kept].tolist()]
        if b is not None:
            way[-1] = b
        if escape:
            return (a, *way)
        way[0] = a
        return tuple(way)


class Field:
    """Shortest ways from one place to everywhere, as the map stood when it was made."""

    def __init__(
        self,
        planner: Planner,
        a: Vec2,
        start: int,
        escape: bool,
        cost: NDArray[np.int32],
        came: NDArray[np.int8],
        window: NDArray[np.int64],
    ) -> None:
        self._planner, self._a, self._start, self._escape = planner, a, start, escape
        self._frame = (planner.grid.left, planner.grid.bottom)
        self.cost, self.came, self.window = cost, came, window

    def distance(self, b: Vec2, within: float = 0.0) -> float:
        """Walking distance [m] to ``b``, or to the nearest place within ``within`` metres of it; infinite if none.

        Without ``within``, a place that the body cannot stand on counts as the nearest one within 0.7 m.
        """
        flat = self._best(b, within)
        return math.inf if flat < 0 else int(self.cost.flat[flat]) / searching.STEP * CELL_M

    def path(self, b: Vec2, within: float = 0.0) -> tuple[Vec2, ...] | None:
        """Way points [m] as `Planner.path` gives them. Ask before the map grows; afterwards None is given."""
        planner = self._planner
        flat = self._best(b, within)
        if flat < 0 or planner._cells.shape != self.cost.shape:
            return None
        exact = b if flat == self._index(b) else None
        return planner._pulled(self.cost, self.came, self._start, flat, self._a, exact, self._escape)

    def _index(self, b: Vec2) -> int:
        column, row = math.floor(b[0] / CELL_M) - self._frame[0], math.floor(b[1] / CELL_M) - self._frame[1]
        return row * int(self.cost.shape[1]) + column

    def _best(self, b: Vec2, within: float) -> int:
        """Index of the reached cell that serves ``b``: the cheapest within reach, or else the nearest to it."""
        x0, x1, y0, y1 = (int(edge) for edge in self.window)
        column, row = math.floor(b[0] / CELL_M) - self._frame[0], math.floor(b[1] / CELL_M) - self._frame[1]
        nx = int(self.cost.shape[1])
        if x0 <= column <= x1 and y0 <= row <= y1 and within <= 0.0 and self.cost[row, column] < searching.FAR:
            return row * nx + column
        span = max(math.ceil(within / CELL_M), 0) if within > 0.0 else _ESCAPE_CELLS
        i0, i1, j0, j1 = max(column - span, x0), min(column + span, x1), max(row - span, y0), min(row + span, y1)
        if i0 > i1 or j0 > j1:
            return -1
        box = self.cost[j0 : j1 + 1, i0 : i1 + 1]
        dx = np.arange(i0, i1 + 1) + (0.5 + self._frame[0]) - b[0] / CELL_M
        dy = np.arange(j0, j1 + 1) + (0.5 + self._frame[1]) - b[1] / CELL_M
        apart = dy[:, None] ** 2 + dx[None, :] ** 2
        if within > 0.0:
            rank = np.where(apart <= (within / CELL_M) ** 2, box, searching.FAR)
        else:
            rank = np.where((box < searching.FAR) & (apart <= span * span), apart, np.inf)
        k = int(np.argmin(rank))
        j, i = divmod(k, int(box.shape[1]))
        if box[j, i] >= searching.FAR or not rank[j, i] < searching.FAR:
            return -1
        return (j + j0) * nx + i + i0


def length(way: Sequence[Vec2]) -> float:
    """Length [m] of a way."""
    return math.fsum(math.dist(way[k], way[k + 1]) for k in range(len(way) - 1))


def _window_view(array: NDArray[np.int32], window: NDArray[np.int64]) -> NDArray[np.int32]:
    x0, x1, y0, y1 = (int(edge) for edge in window)
    return array[y0 : y1 + 1, x0 : x1 + 1]


def _trace(
    cost: NDArray[np.int32], came: NDArray[np.int8], start: int, end: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cell centres (N, 2) [cells] and costs (N,) from ``start`` to ``end``."""
    buffer = np.empty(cost.size if cost.size < 8192 else 8192, dtype=np.int64)
    count = searching.trace(came, start, end, buffer)
    cells = buffer[:count][::-1]
    nx = cost.shape[1]
    points = np.empty((count, 2), dtype=np.float64)
    points[:, 0], points[:, 1] = cells % nx + 0.5, cells // nx + 0.5
    return points, cost.ravel()[cells].astype(np.float64)


def _disc(radius: float) -> NDArray[np.int64]:
    """Offsets (N, 3): column, row and the level that an occupied cell gives to the cell there."""
    reach = math.ceil((radius + _SOFT_M) / CELL_M)
    rows = []
    for row in range(-reach, reach + 1):
        for column in range(-reach, reach + 1):
            apart = math.hypot(column, row) * CELL_M
            if apart <= radius + _SOFT_M:
                rows.append((column, row, 2 if apart <= radius + _HARD_M else 1))
    return np.array(rows, dtype=np.int64)
