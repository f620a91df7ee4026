"""Where a map could be extended, and what on it was never seen from close by; knows nothing of what is looked for."""

from __future__ import annotations

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor.navigation import grouping, searching
from hthor.navigation.map import CELL_M, GridMap
from hthor.navigation.planner import Field, Planner
from hthor.types import Pose, Vec2

_MOST = 256


class Frontier(Struct, frozen=True, kw_only=True):
    """A group of neighbouring places worth going to.

    ``centre`` [m] is the member nearest to the group's middle, a place where the body can stand. ``size`` [m] is the
    number of cells times their width, ``distance`` [m] the way to the nearest member.
    """

    centre: Vec2
    size: float
    distance: float


class Survey:
    """Every place worth going to, by one search, with the ways there.

    Attributes:
        frontiers: groups of reachable free cells next to unknown ones.
        unvisited: groups along furniture that were never looked at from close by, see `GridMap.near`.
    """

    def __init__(self, grid: GridMap, planner: Planner, pose: Pose, least: float = 0.2) -> None:
        """Groups of at least ``least`` [m] are listed, in order of their place."""
        self._field = _known(planner, pose)
        self.frontiers = _groups(grid, self._field, planner, True, least)
        self.unvisited = _groups(grid, self._field, planner, False, least)

    def path(self, place: Frontier) -> tuple[Vec2, ...] | None:
        """The way to a place, through what is known to be free; ask before the map grows."""
        return self._field.path(place.centre)


def frontiers(grid: GridMap, planner: Planner, pose: Pose, least: float = 0.2) -> list[Frontier]:
    """Groups of at least ``least`` [m] of reachable free cells next to unknown ones, in order of their place."""
    return Survey(grid, planner, pose, least).frontiers


def unvisited(grid: GridMap, planner: Planner, pose: Pose, least: float = 0.3) -> list[Frontier]:
    """Groups of reachable free cells along furniture that were never looked at from close by, see `GridMap.near`."""
    return Survey(grid, planner, pose, least).unvisited


def _known(planner: Planner, pose: Pose) -> Field:
    """Ways through what is known to be free, whatever the planner thinks of the unknown."""
    hopeful, planner.optimistic = planner.optimistic, False
    try:
        return planner.field((pose.x, pose.y))
    finally:
        planner.optimistic = hopeful


def _groups(grid: GridMap, field: Field, planner: Planner, edges: bool, least: float) -> list[Frontier]:
    mask: NDArray[np.uint8] = np.zeros(grid.cells.shape, dtype=np.uint8)
    grouping.mark(grid.cells, planner.levels, grid.beside, grid.near, field.cost, field.window, edges, mask)
    out = np.empty((_MOST, 4), dtype=np.int64)
    stack = np.empty(grid.cells.size, dtype=np.int32)
    count = grouping.clusters(field.cost, field.window, mask, stack, out)
    found = []
    for row, column, size, cost in out[:count].tolist():
        if size * CELL_M >= least - 1e-9:
            centre = ((column + 0.5 + grid.left) * CELL_M, (row + 0.5 + grid.bottom) * CELL_M)
            found.append(Frontier(centre=centre, size=size * CELL_M, distance=cost / searching.STEP * CELL_M))
    return found
