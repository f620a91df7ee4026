"""Finds frontiers, where a map could be extended, and furniture that was never seen from close by."""

import heapq
import math
from collections.abc import Callable, Iterator

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor.navigation import frontier_kernel
from hthor.navigation.distance_field import Field
from hthor.navigation.grid_map import CELL_M, GridMap
from hthor.navigation.planner import Planner
from hthor.types import Pose, Vec2

_MOST = 256
_EDGE, _UNVISITED = 1, 2


class Frontier(Struct, frozen=True, kw_only=True):
    """A group of neighbouring cells that are worth a visit.

    Attributes:
        centre: the cell of the group nearest to the group's mean [m]; the body can stand there.
        size: number of cells times their width [m]. distance: length of the path to the nearest cell [m].
        is_edge: True for free cells next to unknown cells, False for free cells along furniture that was never
            looked at from close by, see `GridMap.near`.
    """

    centre: Vec2
    size: float
    distance: float
    is_edge: bool = True


class _Group(Struct, frozen=True):
    """A group that may not be reachable; ``cell`` is the row and column of its centre."""

    cell: tuple[int, int]
    size: int
    is_edge: bool


class Survey:
    """All groups of cells worth a visit, with paths to them, found by one search that goes only as far as needed."""

    def __init__(self, grid: GridMap, planner: Planner, pose: Pose, least: float = 0.2) -> None:
        """Prepare the search; groups with a size below ``least`` [m] are left out."""
        self._field = _known(planner, pose)
        self._frame = (grid.left, grid.bottom)
        self._groups: list[_Group] = []
        self._found: dict[int, Frontier] = {}
        self._news: list[int] = []
        window = self._field.window
        if window is not None:
            self._names: NDArray[np.int16] = np.zeros((2, window.state.size), dtype=np.int16)
            mask: NDArray[np.uint8] = np.zeros(grid.cells.shape, dtype=np.uint8)
            cells: NDArray[np.int32] = np.empty(mask.size, dtype=np.int32)
            count = frontier_kernel.mark_cells(
                grid.cells, planner.levels, grid.beside, grid.near, grid.bounds, mask, cells
            )
            self._gather(grid, mask, cells[:count], _EDGE, least)
            self._gather(grid, mask, cells[:count], _UNVISITED, least)
        self._known: NDArray[np.uint8] = np.zeros(len(self._groups) + 1, dtype=np.uint8)
        self._known[0] = 1

    @property
    def frontiers(self) -> list[Frontier]:
        """Groups of reachable free cells next to unknown cells, in map order."""
        return self._all(is_edge=True)

    @property
    def unvisited(self) -> list[Frontier]:
        """Groups of reachable free cells along furniture never looked at from close by, in map order."""
        return self._all(is_edge=False)

    def ranked(self, extra: Callable[[Vec2], float]) -> Iterator[Frontier]:
        """All groups, by increasing ``distance + extra(centre)`` [m]."""
        more = {number: extra(self._centre(group)) for number, group in enumerate(self._groups, 1)}
        waiting: list[tuple[float, Vec2, int]] = []
        while True:
            on = self._reach()
            for number in self._news:
                place = self._found[number]
                heapq.heappush(waiting, (place.distance + more.pop(number), place.centre, number))
            self._news.clear()
            bound = self._field.reached + min(more.values(), default=math.inf) if on else math.inf
            while waiting and waiting[0][0] < bound:
                yield self._found[heapq.heappop(waiting)[2]]
            if not on:
                return

    def path(self, place: Frontier) -> tuple[Vec2, ...] | None:
        """The path [m] to a group through cells known to be free; None if the map has become larger since."""
        window = self._field.window
        if window is not None:
            column, row = (round(metres / CELL_M - 0.5) for metres in place.centre)
            goal = window.flat(row - self._frame[1], column - self._frame[0])
            while not window.settled(goal) and self._reach(goal):
                pass
        return self._field.path(place.centre)

    def _gather(
        self, grid: GridMap, mask: NDArray[np.uint8], marked: NDArray[np.int32], bit: int, least: float
    ) -> None:
        """Add the groups of marked cells that are large enough, and let the search stop at them."""
        window = self._field.window
        assert window is not None
        out: NDArray[np.int64] = np.empty((_MOST, 4), dtype=np.int64)
        members: NDArray[np.int32] = np.empty(len(marked), dtype=np.int32)
        count = frontier_kernel.group_cells(mask, marked, bit, members, out)
        names, columns, offset = self._names[bit - 1], grid.cells.shape[1], window.flat(0, 0)
        frame, number = (columns, window.width, offset), len(self._groups)
        count = frontier_kernel.watch_groups(
            members, out, count, CELL_M, least - 1e-9, *frame, window.state, names, number
        )
        for row, column, first, last in out[:count].tolist():
            self._groups.append(_Group((row, column), last - first, bit == _EDGE))

    def _reach(self, goal: int = -1) -> bool:
        """Continue the search to the next group, or to the cell ``goal``; False if nothing more can be reached."""
        window = self._field.window
        if window is None:
            return False
        here = window.reach(self._names, self._known, goal)
        if here < 0:
            return False
        for number in self._names[:, here].tolist():
            if not self._known[number]:
                self._known[number] = 1
                self._news.append(number)
                group = self._groups[number - 1]
                self._found[number] = Frontier(
                    centre=self._centre(group),
                    size=group.size * CELL_M,
                    distance=self._field.metres(here),
                    is_edge=group.is_edge,
                )
        return True

    def _centre(self, group: _Group) -> Vec2:
        (row, column), (left, bottom) = group.cell, self._frame
        return ((column + 0.5 + left) * CELL_M, (row + 0.5 + bottom) * CELL_M)

    def _all(self, is_edge: bool) -> list[Frontier]:
        while self._reach():
            pass
        return [place for _, place in sorted(self._found.items()) if place.is_edge == is_edge]


def frontiers(grid: GridMap, planner: Planner, pose: Pose, least: float = 0.2) -> list[Frontier]:
    """Groups of at least ``least`` [m] of reachable free cells next to unknown cells, in map order."""
    return Survey(grid, planner, pose, least).frontiers


def unvisited(grid: GridMap, planner: Planner, pose: Pose, least: float = 0.3) -> list[Frontier]:
    """Groups of reachable free cells along furniture never looked at from close by, see `GridMap.near`."""
    return Survey(grid, planner, pose, least).unvisited


def _known(planner: Planner, pose: Pose) -> Field:
    """Paths through cells known to be free, even if the planner is optimistic."""
    hopeful, planner.optimistic = planner.optimistic, False
    try:
        return planner.field((pose.x, pose.y))
    finally:
        planner.optimistic = hopeful
