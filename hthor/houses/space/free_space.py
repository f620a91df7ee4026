"""The free-space grid: where a body's axis may be in a house.

The world stops bodies with the same grid, so every place that is free for a planner is free in the world.
"""

from __future__ import annotations

import functools
import math

import numpy as np
from numpy.typing import NDArray

from hthor import rules
from hthor.errors import HthorError
from hthor.houses.space import solids
from hthor.houses.space.grid_kernel import (
    cells_in_polygon,
    clear_cells,
    free_share,
    is_free_point,
    label_at,
    nearest_free_cell,
)
from hthor.houses.space.obstacles import STEP_M, furniture_in_the_way
from hthor.types import HouseSpec, Room, Vec2

_PAD = 2
_SEAM_M = 2e-3
_SHORT_M = 1e-6

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]


class FreeSpace:
    """The places where the axis of an upright cylinder may be.

    A cell is free when a disc of ``radius`` about its centre touches no wall, no furniture that stands in the way of a
    body ``height`` tall (`hthor.houses.space.obstacles`), and stays inside the rooms. A place is free if its cell is
    free; a cell's edge belongs to both sides. Where two blocked cells meet only at a corner, nothing passes between
    them.

    Attributes:
        radius, height: of the body [m].
        free: (ny, nx) bool; ``free[j, i]`` is the cell with its lower left corner at ``origin + (i, j) * cell``.
        raw: (ny, nx) bool, true where a range scan's beam passes: no obstacle within half a cell of the centre.
        origin: [m] house frame. cell: side of a cell [m].

    Raises:
        HthorError: when the house has no rooms, or the radius or height is not positive.
    """

    def __init__(self, house: HouseSpec, radius: float, height: float = 1.8) -> None:
        if not (radius >= 0.0 and height > STEP_M and math.isfinite(radius)):
            raise HthorError(
                f"a body needs radius >= 0 and height > {STEP_M} m, got radius {radius} and height {height}"
            )
        if not house.rooms:
            raise HthorError(f"house '{house.id}' has no rooms, so nobody can stand anywhere; add a room to its file")
        self.house, self.radius, self.height, self.cell = house, radius, height, rules.GRID_M
        corners = np.array([corner for room in house.rooms for corner in room.polygon])
        low = np.floor(corners.min(0) / self.cell + 1e-6).astype(int) - _PAD
        high = np.ceil(corners.max(0) / self.cell - 1e-6).astype(int) + _PAD
        self.origin: Vec2 = (float(low[0]) * self.cell, float(low[1]) * self.cell)
        indoors = _indoors(house, self.origin, (int(high[1] - low[1]), int(high[0] - low[0])))
        rectangles = obstacle_rectangles(house, height)
        self.free: Bools = _frozen(clear_cells(indoors, rectangles, *self.origin, self.cell, radius))
        self.raw: Bools = _frozen(clear_cells(indoors, rectangles, *self.origin, self.cell, self.cell / 2))

    @staticmethod
    @functools.lru_cache(maxsize=32)
    def of(house: HouseSpec, radius: float, height: float = 1.8) -> FreeSpace:
        """The same as the constructor, computed once per process."""
        return FreeSpace(house, radius, height)

    def cell_of(self, x: float, y: float) -> tuple[int, int]:
        """Row and column of the cell that contains the place, inside the grid or not."""
        return math.floor((y - self.origin[1]) / self.cell), math.floor((x - self.origin[0]) / self.cell)

    def centre_of(self, row: int, column: int) -> Vec2:
        """The middle of a cell, house frame."""
        return self.origin[0] + (column + 0.5) * self.cell, self.origin[1] + (row + 0.5) * self.cell

    def centres(self, cells: Bools) -> Floats:
        """(N, 2) [m] middles of the true cells of a (ny, nx) mask, row by row."""
        rows, columns = np.nonzero(cells)
        return np.column_stack(
            (self.origin[0] + (columns + 0.5) * self.cell, self.origin[1] + (rows + 0.5) * self.cell)
        )

    def is_free(self, x: float, y: float) -> bool:
        """Whether the body's axis may be here."""
        return bool(is_free_point(self.free, (x - self.origin[0]) / self.cell, (y - self.origin[1]) / self.cell))

    def segment_free(self, a: Vec2, b: Vec2) -> bool:
        """Whether the axis can go straight from ``a`` to ``b`` through free places only."""
        (ox, oy), c = self.origin, self.cell
        return free_share(self.free, (a[0] - ox) / c, (a[1] - oy) / c, (b[0] - ox) / c, (b[1] - oy) / c) >= 1.0  # type: ignore[no-any-return]

    def advance(self, a: Vec2, b: Vec2) -> float:
        """The share [0, 1] of the straight way from ``a`` to ``b`` that is free; 0 when ``a`` is not free."""
        ox, oy, c = *self.origin, self.cell
        return float(free_share(self.free, (a[0] - ox) / c, (a[1] - oy) / c, (b[0] - ox) / c, (b[1] - oy) / c))

    def nearest_free(self, x: float, y: float, within: Bools | None = None) -> Vec2:
        """The place itself if it is free, else the middle of the nearest free cell.

        Args:
            within: (ny, nx) mask, such as a component, in which the result must be.

        Raises:
            HthorError: when no cell is free.
        """
        cells = self.free if within is None else self.free & within
        if is_free_point(cells, (x - self.origin[0]) / self.cell, (y - self.origin[1]) / self.cell):
            return (x, y)
        row, column = nearest_free_cell(cells, *self.origin, self.cell, float(x), float(y))
        if row < 0:
            raise HthorError(f"house '{self.house.id}' has no free floor for a body of radius {self.radius} m")
        return self.centre_of(row, column)

    def component(self, x: float, y: float) -> Bools:
        """(ny, nx) mask of the cells that can be reached from the place; all false when the place is not free."""
        label = self.label(x, y)
        mask: Bools = (self.components == label) & (label > 0)
        return mask

    def label(self, x: float, y: float) -> int:
        """The number of the place's component, 0 when the place is not free."""
        return int(
            label_at(self.free, self.components, (x - self.origin[0]) / self.cell, (y - self.origin[1]) / self.cell)
        )

    @functools.cached_property
    def components(self) -> NDArray[np.int32]:
        """(ny, nx) int32: 0 for blocked cells, else the number of the cell's component, counted row by row from 1."""
        from skimage.measure import label  # late: a slow import, and not every use of a grid needs it

        labels: NDArray[np.int32] = label(self.free, connectivity=1).astype(np.int32)
        labels.setflags(write=False)
        return labels

    def room_mask(self, room: Room) -> Bools:
        """(ny, nx) mask of the cells whose middle lies in the room, free or not."""
        ny, nx = self.free.shape
        return np.asarray(cells_in_polygon(np.array(room.polygon), *self.origin, self.cell, ny, nx, 0.0), dtype=bool)


def obstacle_rectangles(house: HouseSpec, height: float) -> Floats:
    """(N, 5) rectangles in the way of a body ``height`` [m] tall: centre x, y, half width, half depth [m], yaw."""
    slabs = [slab for slab in solids.wall_slabs(house) if slab.low < height and slab.high > STEP_M]
    slabs += [slab for _, slab in furniture_in_the_way(house, height)]
    rows = [(*slab.centre, slab.size[0] / 2, slab.size[1] / 2, slab.yaw) for slab in slabs]
    return np.array(rows + list(_borders(house)), dtype=float).reshape(-1, 5)


def _frozen(cells: Bools) -> Bools:
    cells.setflags(write=False)
    return cells


def _indoors(house: HouseSpec, origin: Vec2, shape: tuple[int, int]) -> Bools:
    cells = np.zeros(shape, dtype=bool)
    for room in house.rooms:
        cells |= cells_in_polygon(np.array(room.polygon), *origin, rules.GRID_M, *shape, _SEAM_M)
    return cells


def _borders(house: HouseSpec) -> list[tuple[float, float, float, float, float]]:
    """The rooms' edges that no other room shares, as rectangles of no width: beyond them the house ends."""
    edges = [
        (room.id, a, b)
        for room in house.rooms
        for a, b in zip(room.polygon, (*room.polygon[1:], room.polygon[0]), strict=True)
    ]
    borders = []
    for owner, a, b in edges:
        length = math.dist(a, b)
        if length < _SHORT_M:
            continue
        ux, uy = (b[0] - a[0]) / length, (b[1] - a[1]) / length
        shared = []
        for other, c, d in edges:
            offs = [abs(ux * (q[1] - a[1]) - uy * (q[0] - a[0])) for q in (c, d)]
            if other != owner and max(offs) <= 2 * _SEAM_M:
                shared.append(sorted(ux * (q[0] - a[0]) + uy * (q[1] - a[1]) for q in (c, d)))
        start = 0.0
        for begin, end in [*sorted(shared), [length, length]]:
            stop = min(begin, length)
            if stop - start > 2 * _SEAM_M:
                middle = (start + stop) / 2
                borders.append((a[0] + ux * middle, a[1] + uy * middle, (stop - start) / 2, 0.0, math.atan2(uy, ux)))
            start = max(start, end)
    return borders
