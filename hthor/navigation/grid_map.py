"""A grid map that grows with every range scan."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hthor.navigation import scan_kernel
from hthor.types import Scan, Vec2

CELL_M = 0.05
UNKNOWN, FREE, OCCUPIED = 0, 1, 2
LOW_M = 2.1
"""[m] Obstacles lower than this are furniture, with things on or in them; higher obstacles are walls."""
_BESIDE_CELLS = 8
_CHUNK = 64
_AROUND_M = 3.0
"""[m] How far a map reaches beyond a point that it is extended to: paths there may be roundabout."""


class GridMap:
    """Cells of 5 cm that are unknown, free or occupied, on a lattice fixed to the house frame.

    Attributes:
        cells: (ny, nx) uint8, row = y. Replaced by a larger array when the map grows.
        near: (ny, nx) uint8, 1 for free cells that were looked at from close by (see `integrate`).
        beside: (ny, nx) uint8, 1 within 0.4 m of furniture; for scans without ``tops``, of any obstacle.
        left, bottom: lattice indices of column 0 and row 0; cell (row, column) has its centre at
            ``((left + column + 0.5) * 0.05, (bottom + row + 0.5) * 0.05)`` metres.
        bounds: (4,) int64, first and last known column, first and last known row.
        version: grows with every change.

    Occupied cells stay occupied: furniture does not move, and range scans do not show bodies.
    """

    def __init__(self, x: float = 0.0, y: float = 0.0, extent_m: float = 12.8) -> None:
        """Start around (``x``, ``y``) [m] with a side of ``extent_m`` metres; the map grows when needed."""
        half = math.ceil(extent_m / CELL_M / 2.0)
        self.left, self.bottom = math.floor(x / CELL_M) - half, math.floor(y / CELL_M) - half
        self.cells: NDArray[np.uint8] = np.zeros((2 * half, 2 * half), dtype=np.uint8)
        self.near: NDArray[np.uint8] = np.zeros_like(self.cells)
        self.beside: NDArray[np.uint8] = np.zeros_like(self.cells)
        self._inner = self._inner_rectangle()
        self.bounds: NDArray[np.int64] = np.array([half, half, half, half], dtype=np.int64)
        self.version = 0
        self._given: Any = None
        self._obstacles: NDArray[np.int32] = np.empty((1024, 3), dtype=np.int32)
        self._count = 0

    @property
    def obstacles(self) -> NDArray[np.int32]:
        """(N, 3) x and y index of occupied cells, and 1 for furniture, else 0; new cells are appended at the end."""
        return self._obstacles[: self._count]

    def integrate(self, scan: Scan, look_m: float = 1.1, look_rad: float = math.pi) -> None:
        """Add a range scan.

        Args:
            scan: its bearings must increase.
            look_m: [m] distance within which free cells count as looked at from close by.
            look_rad: [rad] angle from the heading within which they do.
        """
        origin, margin = scan.origin, scan.limit + 0.2
        self._cover(origin.x - margin, origin.y - margin, origin.x + margin, origin.y + margin)
        self._reserve(16 * len(scan.ranges) + 64)
        first = self._count
        ranges = np.ascontiguousarray(scan.ranges, dtype=np.float64)
        bearings = self._as_bearings(scan.bearings)
        tops = np.zeros(len(ranges)) if scan.tops is None else np.ascontiguousarray(scan.tops, dtype=np.float64)
        place = self.left, self.bottom, CELL_M, origin.x, origin.y, origin.yaw
        looks = LOW_M, scan.limit, look_m, look_rad
        known = self.bounds, self._obstacles
        self._count = scan_kernel.integrate(
            self.cells, self.near, *place, bearings, ranges, tops, *looks, *known, self._count
        )
        if scan.beyond is not None:
            beyond = np.ascontiguousarray(scan.beyond, dtype=np.float64)
            self._count = scan_kernel.beyond(
                self.cells, *place, bearings, ranges, beyond, scan.limit, *known, self._count
            )
        scan_kernel.surround(self.beside, self._obstacles, first, self._count, self.left, self.bottom, _BESIDE_CELLS)
        self.version += 1

    def include(self, x: float, y: float) -> None:
        """Extend the map with unknown cells up to (``x``, ``y``) [m] and a few metres beyond."""
        self._cover(x - _AROUND_M, y - _AROUND_M, x + _AROUND_M, y + _AROUND_M)

    def mark_blocked(self, x: float, y: float) -> None:
        """Mark the cell at (``x``, ``y``) [m] as occupied, for an obstacle that no scan showed."""
        self._cover(x, y, x, y)
        self._reserve(1)
        column, row = self._index(x, y)
        if self.cells[row, column] == OCCUPIED:
            return
        self.cells[row, column] = OCCUPIED
        self._obstacles[self._count] = (column + self.left, row + self.bottom, 0)
        self._count += 1
        box = self.bounds
        box[0], box[1] = min(int(box[0]), column), max(int(box[1]), column)
        box[2], box[3] = min(int(box[2]), row), max(int(box[3]), row)
        self.version += 1

    def at(self, x: float, y: float) -> int:
        """State of the cell at (``x``, ``y``) [m]; `UNKNOWN` outside the map."""
        column, row = self._index(x, y)
        if not (0 <= row < self.cells.shape[0] and 0 <= column < self.cells.shape[1]):
            return UNKNOWN
        return int(self.cells[row, column])

    def seen(self, a: Vec2, b: Vec2) -> bool:
        """Whether the floor from ``a`` to ``b`` [m] is known to be free; one cell every 0.2 m is checked."""
        count = max(1, math.ceil(math.dist(a, b) / (4.0 * CELL_M)))
        line = self.left, self.bottom, CELL_M, *a, *b
        return bool(scan_kernel.along(self.cells, *line, 0, count, 1.0, float(count), FREE, True))

    def meets(self, a: Vec2, b: Vec2, margin: float) -> bool:
        """Whether a cell on the line from ``a`` to ``margin`` before ``b`` [m], except the first cell, is occupied.

        One cell every 5 cm is checked.
        """
        apart = math.dist(a, b)
        line = self.left, self.bottom, CELL_M, *a, *b
        count = int((apart - margin) / CELL_M)
        return count > 0 and not scan_kernel.along(self.cells, *line, 1, count, CELL_M, apart, OCCUPIED, False)

    def was_near(self, x: float, y: float) -> bool:
        """Whether the free cell at (``x``, ``y``) [m] was looked at from close by."""
        column, row = self._index(x, y)
        inside = 0 <= row < self.cells.shape[0] and 0 <= column < self.cells.shape[1]
        return inside and bool(self.near[row, column])

    def forget_near(self) -> None:
        """Mark every cell as not looked at from close by."""
        self.near[:] = 0

    def _as_bearings(self, bearings: Any) -> NDArray[np.float64]:
        """The bearings as an array for compiled loops; cached, because a sensor always has the same bearings."""
        if bearings is not self._given:
            self._given, self._bearings = bearings, np.array(bearings, dtype=np.float64)
        return self._bearings

    def _index(self, x: float, y: float) -> tuple[int, int]:
        return math.floor(x / CELL_M) - self.left, math.floor(y / CELL_M) - self.bottom

    def _reserve(self, room: int) -> None:
        if self._count + room > len(self._obstacles):
            larger = np.empty((2 * (self._count + room), 3), dtype=np.int32)
            larger[: self._count] = self.obstacles
            self._obstacles = larger

    def _cover(self, x0: float, y0: float, x1: float, y1: float) -> None:
        """Grow the map by whole chunks until it contains the rectangle [m] and a border of one cell."""
        west, south, east, north = self._inner
        if west <= x0 and south <= y0 and x1 <= east and y1 <= north:
            return
        ny, nx = self.cells.shape
        left, bottom = self.left, self.bottom
        column0, row0 = math.floor(x0 / CELL_M) - left, math.floor(y0 / CELL_M) - bottom
        column1, row1 = math.floor(x1 / CELL_M) - left, math.floor(y1 / CELL_M) - bottom
        if column0 >= 1 and row0 >= 1 and column1 + 2 <= nx and row1 + 2 <= ny:
            return
        left, bottom = _chunks(1 - column0), _chunks(1 - row0)
        right, top = _chunks(column1 + 2 - nx), _chunks(row1 + 2 - ny)
        shape, old = (ny + bottom + top, nx + left + right), np.s_[bottom : bottom + ny, left : left + nx]
        grown = []
        for layer in (self.cells, self.near, self.beside):
            grown.append(np.zeros(shape, dtype=np.uint8))
            grown[-1][old] = layer
        self.cells, self.near, self.beside = grown
        self.bounds += np.array([left, left, bottom, bottom], dtype=np.int64)
        self.left, self.bottom = self.left - left, self.bottom - bottom
        self._inner = self._inner_rectangle()
        self.version += 1

    def _inner_rectangle(self) -> tuple[float, float, float, float]:
        """West, south, east and north edge [m] of the map without the two outermost cells."""
        ny, nx = self.cells.shape
        west, south = (self.left + 2) * CELL_M, (self.bottom + 2) * CELL_M
        return west, south, (self.left + nx - 2) * CELL_M, (self.bottom + ny - 2) * CELL_M


def _chunks(missing: int) -> int:
    return 0 if missing <= 0 else math.ceil(missing / _CHUNK) * _CHUNK
