"""The free-space grid: where a body's axis may be in a house; knows nothing of paths, minds or engines.

The world stops bodies with this very grid, so what a planner calls free is free.
"""

from __future__ import annotations

import functools
import math
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from hthor import rules
from hthor.errors import HthorError
from hthor.houses import solids
from hthor.types import HouseSpec, Room, Vec2

STEP_M = 0.05
"""What is no higher than this (a rug) stops nobody."""
_PAD = 2
_SEAM_M = 2e-3
_EPS_M = 1e-6
"""Slack of every contact with a blocked cell's edge, so that rounding never stops a body that slides along it."""

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]


class FreeSpace:
    """Where the axis of an upright cylinder may be.

    A cell is free when a disc of ``radius`` about its centre touches no wall, no furniture that stands in the way of a
    body ``height`` tall, and stays inside the rooms. A place is free when its cell is; a cell's edge belongs to both
    sides. Where two blocked cells meet only at a corner, nothing passes between them.

    Args:
        house: the floor plan.
        radius, height: of the body [m].

    Attributes:
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
        rectangles = obstacles(house, height)
        self.free: Bools = _frozen(_clear(indoors, rectangles, *self.origin, self.cell, radius))
        self.raw: Bools = _frozen(_clear(indoors, rectangles, *self.origin, self.cell, self.cell / 2))

    @staticmethod
    @functools.lru_cache(maxsize=32)
    def of(house: HouseSpec, radius: float, height: float = 1.8) -> FreeSpace:
        """The same as the constructor, worked out once a process."""
        return FreeSpace(house, radius, height)

    def cell_of(self, x: float, y: float) -> tuple[int, int]:
        """Row and column of the cell that holds the place, inside the grid or not."""
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
        return bool(_stand(self.free, (x - self.origin[0]) / self.cell, (y - self.origin[1]) / self.cell))

    def segment_free(self, a: Vec2, b: Vec2) -> bool:
        """Whether the axis can go straight from ``a`` to ``b`` through free places only."""
        ox, oy, c = *self.origin, self.cell
        return bool(_walk(self.free, (a[0] - ox) / c, (a[1] - oy) / c, (b[0] - ox) / c, (b[1] - oy) / c) >= 1.0)

    def advance(self, a: Vec2, b: Vec2) -> float:
        """The share [0, 1] of the way from ``a`` straight to ``b`` that is free; 0 when ``a`` is not."""
        ox, oy, c = *self.origin, self.cell
        return float(_walk(self.free, (a[0] - ox) / c, (a[1] - oy) / c, (b[0] - ox) / c, (b[1] - oy) / c))

    def nearest_free(self, x: float, y: float, within: Bools | None = None) -> Vec2:
        """The place itself when free, or else the middle of the nearest free cell.

        Args:
            within: (ny, nx) mask that narrows the choice, such as a component; then the place itself must be in it.

        Raises:
            HthorError: when no cell is free.
        """
        cells = self.free if within is None else self.free & within
        if _stand(cells, (x - self.origin[0]) / self.cell, (y - self.origin[1]) / self.cell):
            return (x, y)
        rows, columns = np.nonzero(cells)
        if not len(rows):
            raise HthorError(f"house '{self.house.id}' has no free floor for a body of radius {self.radius} m")
        dx = self.origin[0] + (columns + 0.5) * self.cell - x
        dy = self.origin[1] + (rows + 0.5) * self.cell - y
        nearest = int(np.argmin(dx * dx + dy * dy))
        return self.centre_of(int(rows[nearest]), int(columns[nearest]))

    def component(self, x: float, y: float) -> Bools:
        """(ny, nx) mask of the cells that can be reached from the place; all false where it is not free."""
        label = self.label(x, y)
        mask: Bools = (self.components == label) & (label > 0)
        return mask

    def label(self, x: float, y: float) -> int:
        """The number of the place's component, 0 where it is not free."""
        return int(
            _label_at(self.free, self.components, (x - self.origin[0]) / self.cell, (y - self.origin[1]) / self.cell)
        )

    @functools.cached_property
    def components(self) -> NDArray[np.int32]:
        """(ny, nx) int32: 0 for blocked cells, else the number of the cell's component, counted row by row from 1."""
        labels: NDArray[np.int32] = _label(self.free)
        labels.setflags(write=False)
        return labels

    def room_mask(self, room: Room) -> Bools:
        """(ny, nx) mask of the cells whose middle lies in the room, free or not."""
        ny, nx = self.free.shape
        return np.asarray(_inside(np.array(room.polygon), *self.origin, self.cell, ny, nx, 0.0), dtype=bool)


def obstacles(house: HouseSpec, height: float) -> Floats:
    """(N, 5) rectangles in the way of a body ``height`` [m] tall: centre x, y, half width, half depth [m], yaw."""
    slabs = [*solids.walls(house), *(slab for _, slab in solids.furniture(house))]
    rows = [
        (*slab.centre, slab.size[0] / 2, slab.size[1] / 2, slab.yaw)
        for slab in slabs
        if slab.low < height and slab.high > STEP_M
    ]
    return np.array(rows + list(_borders(house)), dtype=float).reshape(-1, 5)


def _frozen(cells: Bools) -> Bools:
    cells.setflags(write=False)
    return cells


def _indoors(house: HouseSpec, origin: Vec2, shape: tuple[int, int]) -> Bools:
    cells = np.zeros(shape, dtype=bool)
    for room in house.rooms:
        cells |= _inside(np.array(room.polygon), *origin, rules.GRID_M, *shape, _SEAM_M)
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
        if length < _EPS_M:
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


# ------------------------------------------------------------------------------- compiled; lengths below are in cells


@numba.njit(cache=True)
def _inside(polygon: Floats, ox: float, oy: float, cell: float, ny: int, nx: int, slack: float) -> Any:
    """Cells whose middle lies in the polygon, or within ``slack`` of it (tested at the corners of a small square)."""
    out = np.zeros((ny, nx), dtype=np.bool_)
    for j in range(ny):
        for i in range(nx):
            for k in range(1 if slack == 0.0 else 4):
                x = ox + (i + 0.5) * cell + (slack if k & 1 else -slack)
                y = oy + (j + 0.5) * cell + (slack if k & 2 else -slack)
                odd = False
                n = len(polygon)
                for e in range(n):
                    ax, ay = polygon[e, 0], polygon[e, 1]
                    bx, by = polygon[(e + 1) % n, 0], polygon[(e + 1) % n, 1]
                    if (ay > y) != (by > y) and x < (bx - ax) * (y - ay) / (by - ay) + ax:
                        odd = not odd
                if odd:
                    out[j, i] = True
                    break
    return out


@numba.njit(cache=True)
def _clear(indoors: Any, rectangles: Floats, ox: float, oy: float, cell: float, radius: float) -> Any:
    """The indoor cells whose middle is at least ``radius`` [m] from every rectangle (and in none)."""
    out = indoors.copy()
    ny, nx = out.shape
    for k in range(len(rectangles)):
        cx, cy, hw, hd, yaw = rectangles[k]
        cos, sin = math.cos(yaw), math.sin(yaw)
        ex = abs(cos) * hw + abs(sin) * hd + radius
        ey = abs(sin) * hw + abs(cos) * hd + radius
        for j in range(max(0, int((cy - ey - oy) / cell) - 1), min(ny, int((cy + ey - oy) / cell) + 2)):
            for i in range(max(0, int((cx - ex - ox) / cell) - 1), min(nx, int((cx + ex - ox) / cell) + 2)):
                dx, dy = ox + (i + 0.5) * cell - cx, oy + (j + 0.5) * cell - cy
                u = max(abs(cos * dx + sin * dy) - hw, 0.0)
                v = max(abs(cos * dy - sin * dx) - hd, 0.0)
                if u * u + v * v < radius * radius or (u == 0.0 and v == 0.0):
                    out[j, i] = False
    return out


@numba.njit(cache=True)
def _cell(free: Any, i: int, j: int) -> bool:
    return 0 <= j < free.shape[0] and 0 <= i < free.shape[1] and bool(free[j, i])


@numba.njit(cache=True)
def _stand(free: Any, x: float, y: float) -> bool:
    """Whether the point lies in a free cell or on its edge, and not where two blocked cells meet corner to corner."""
    eps = 2e-5
    i0, i1 = math.floor(x - eps), math.floor(x + eps)
    j0, j1 = math.floor(y - eps), math.floor(y + eps)
    a, d = _cell(free, i0, j0), _cell(free, i1, j1)
    if i0 == i1 or j0 == j1:
        return bool(a or d)
    b, c = _cell(free, i1, j0), _cell(free, i0, j1)
    if a == d and b == c and a != b:
        return False
    return bool(a or b or c or d)


@numba.njit(cache=True)
def _label_at(free: Any, labels: Any, x: float, y: float) -> int:
    eps = 2e-5
    if _stand(free, x, y):
        for j in (math.floor(y - eps), math.floor(y + eps)):
            for i in (math.floor(x - eps), math.floor(x + eps)):
                if _cell(free, i, j):
                    return int(labels[j, i])
    return 0


@numba.njit(cache=True)
def _walk(free: Any, ax: float, ay: float, bx: float, by: float) -> float:
    """The share of the segment that is free from its beginning on: 1.0 when all of it is."""
    eps = 2e-5
    if not _stand(free, ax, ay):
        return 0.0
    dx, dy = bx - ax, by - ay
    length = math.sqrt(dx * dx + dy * dy)
    if length == 0.0:
        return 1.0
    far = 1e30
    sx, sy = (1 if dx > 0.0 else -1), (1 if dy > 0.0 else -1)
    nextx = (math.floor(ax) + 1.0) if sx > 0 else (math.ceil(ax) - 1.0)
    nexty = (math.floor(ay) + 1.0) if sy > 0 else (math.ceil(ay) - 1.0)
    tx = (nextx - ax) / dx if dx != 0.0 else far
    ty = (nexty - ay) / dy if dy != 0.0 else far
    stepx = 1.0 / abs(dx) if dx != 0.0 else far
    stepy = 1.0 / abs(dy) if dy != 0.0 else far
    t = 0.0
    while t < 1.0:
        u = min(tx, ty, 1.0)
        if (u - t) * length > eps:
            m = 0.5 * (t + u)
            x, y = ax + m * dx, ay + m * dy
            i, j = math.floor(x), math.floor(y)
            if not (_cell(free, i, j) or _stand(free, x, y)):
                return t
        if u >= 1.0:
            break
        x, y = ax + u * dx, ay + u * dy
        if abs(x - round(x)) <= eps and abs(y - round(y)) <= eps and not _stand(free, x, y):
            return t
        if tx == u:
            tx += stepx
        if ty == u:
            ty += stepy
        t = u
    return 1.0 if _stand(free, bx, by) else t


@numba.njit(cache=True)
def _label(free: Any) -> Any:
    ny, nx = free.shape
    out = np.zeros((ny, nx), dtype=np.int32)
    stack = np.empty((ny * nx, 2), dtype=np.int64)
    count = 0
    for j0 in range(ny):
        for i0 in range(nx):
            if not free[j0, i0] or out[j0, i0]:
                continue
            count += 1
            out[j0, i0] = count
            stack[0, 0], stack[0, 1] = j0, i0
            top = 1
            while top:
                top -= 1
                j, i = stack[top, 0], stack[top, 1]
                for dj, di in ((0, 1), (1, 0), (0, -1), (-1, 0)):
                    jj, ii = j + dj, i + di
                    if _cell(free, ii, jj) and not out[jj, ii]:
                        out[jj, ii] = count
                        stack[top, 0], stack[top, 1] = jj, ii
                        top += 1
    return out
