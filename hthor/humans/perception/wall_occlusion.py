"""Whether a known wall is between two points.

People look over a counter and past a lamp, but not through a wall: only what reaches higher than any furniture counts.
"""

import math

import numpy as np

from hthor.navigation.grid_map import CELL_M, GridMap
from hthor.types import Vec2

_THICK_M = 0.6 * CELL_M
"""[m] Half the thickness of a wall on the map. Our choice: a little more than half a cell."""
_SHORT_M = 0.02
"""[m] Walls this close to either end of the line do not count. Our choice."""


class Walls:
    """The walls on the map within ``reach`` metres of ``point`` [m]."""

    def __init__(self, grid: GridMap, point: Vec2, reach: float) -> None:
        self.point = point
        met = grid.obstacles
        walls = (met[met[:, 2] == 0, :2] + 0.5) * CELL_M - point
        self._offsets = walls[np.abs(walls).max(axis=1) <= reach] if len(walls) else walls

    def hide(self, spot: Vec2) -> bool:
        """Whether one of them is between the point and ``spot`` [m]."""
        dx, dy = spot[0] - self.point[0], spot[1] - self.point[1]
        apart = math.hypot(dx, dy)
        if apart <= _SHORT_M or not len(self._offsets):
            return False
        ux, uy = dx / apart, dy / apart
        along = self._offsets[:, 0] * ux + self._offsets[:, 1] * uy
        off = np.abs(self._offsets[:, 1] * ux - self._offsets[:, 0] * uy)
        return bool(((along > _SHORT_M) & (along < apart) & (off < _THICK_M)).any())
