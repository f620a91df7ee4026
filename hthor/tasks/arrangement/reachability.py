"""The floor that an omniscient person walks on: where they can stand to see, to reach and to put down.

Places are cells of the free-space grid. A person anywhere in a cell counts as standing at its middle, so every range
is widened and every leg of a walk is shortened by half a cell's diagonal: the computed walks are never too long.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hthor import catalog, rules
from hthor.geometry.plane import to_house
from hthor.houses.space import boxes, visibility
from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.geodesic import DistanceField, Geodesics
from hthor.types import HouseSpec, Placement, Thing, Vec2

RADIUS_M = 0.20
"""Radius of the person's avatar. T* follows from an omniscient person with this body and the sizes below."""
HEIGHT_M = 1.75
EYE_M = 1.6
REACH_M = 1.2
"""Horizontal reach [m] from the body's axis, to an object's centre or to the nearest point of a surface."""
START_MARGIN_M = 0.30
"""Radius of free floor around every start."""
Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]

SLACK_M = rules.GRID_M * math.sqrt(0.5)


class ReachableFloor:
    """A house's floor for the person's avatar. Masks are (ny, nx) bool over the cells of ``space``, free cells only."""

    def __init__(self, house: HouseSpec) -> None:
        self.house = house
        self.space = FreeSpace.of(house, RADIUS_M, HEIGHT_M)
        self.paths = Geodesics.of(self.space)

    @staticmethod
    @functools.lru_cache(maxsize=32)
    def of(house: HouseSpec) -> ReachableFloor:
        """The same as the constructor, computed once per process."""
        return ReachableFloor(house)

    @functools.cached_property
    def joined(self) -> Bools:
        """The floor that is connected to the house's start."""
        return self.space.component(*self.space.nearest_free(self.house.start.x, self.house.start.y))

    def seeing(
        self, placement: Placement, opened: frozenset[str] = frozenset(), reach_m: float = rules.FIND_RANGE_M
    ) -> Bools:
        """Cells from which the object is within ``reach_m`` [m] of the eyes (in space, not on the plan) and in sight.

        The range is to its centre. In sight means that no wall or furniture lies between the eyes and its centre or a
        point near its top.
        """
        mask = self._disc((placement.position[0], placement.position[1]), reach_m + SLACK_M)
        places = self.space.centres(mask)
        eyes = np.column_stack((places, np.full(len(places), EYE_M)))
        lit = np.linalg.norm(eyes - placement.position, axis=1) <= reach_m + SLACK_M
        points = visibility.sighting_points(placement.position, catalog.kind(placement.kind).size[2])
        lit[lit] = lines_of_sight(self.house, opened).seen(eyes[lit], points)
        mask[mask] = lit
        return mask

    def touching(self, placement: Placement, spare: float = 0.0) -> Bools:
        """The cells from which the object's centre is within reach, or farther away by at most ``spare`` [m]."""
        return self._disc((placement.position[0], placement.position[1]), REACH_M + spare + SLACK_M)

    def beside(self, thing: Thing, reach_m: float = REACH_M) -> Bools:
        """The cells from which the nearest edge of the thing is within ``reach_m`` [m]."""
        return self._around(thing.centre[:2], thing.size[:2], thing.yaw, reach_m + SLACK_M)

    def serving(self, kind: str) -> Bools:
        """The cells from which the nearest point of any surface of any thing of this kind is within reach."""
        mask = np.zeros(self.space.free.shape, dtype=bool)
        for thing in self.house.things:
            if thing.kind == kind:
                for surface in catalog.kind(kind).rests(thing.size):
                    x, y, _ = to_house(surface.centre, thing.centre, thing.yaw)
                    mask |= self._around((x, y), (2 * surface.half[0], 2 * surface.half[1]), thing.yaw)
        return mask

    def walk(self, stops: Sequence[Bools]) -> Walk:
        """The shortest walk through one cell of each mask, in this order."""
        return Walk(self, stops)

    def within(self, mask: Bools, places: Floats) -> Bools:
        """(N,) Which of the places (N, 2) [m] lie in a cell of the mask."""
        return np.array([self._holds(mask, x, y) for x, y in places], dtype=bool)

    def _holds(self, mask: Bools, x: float, y: float) -> bool:
        row, column = self.space.cell_of(x, y)
        ny, nx = mask.shape
        return 0 <= row < ny and 0 <= column < nx and bool(mask[row, column])

    def _disc(self, centre: Vec2, radius: float) -> Bools:
        return self._around(centre, (0.0, 0.0), 0.0, radius)

    def _around(self, centre: Vec2, size: Vec2, yaw: float, radius: float = REACH_M + SLACK_M) -> Bools:
        """Free cells whose middle is within ``radius`` of a turned rectangle."""
        columns, rows = self._axes
        dx, dy = columns[None, :] - centre[0], rows[:, None] - centre[1]
        cos, sin = math.cos(yaw), math.sin(yaw)
        u = np.maximum(np.abs(cos * dx + sin * dy) - size[0] / 2, 0.0)
        v = np.maximum(np.abs(cos * dy - sin * dx) - size[1] / 2, 0.0)
        mask: Bools = self.space.free & (u * u + v * v <= radius * radius)
        return mask

    @functools.cached_property
    def _axes(self) -> tuple[Floats, Floats]:
        ny, nx = self.space.free.shape
        x, y = self.space.centre_of(0, 0)
        columns: Floats = x + np.arange(nx, dtype=np.float64) * self.space.cell
        rows: Floats = y + np.arange(ny, dtype=np.float64) * self.space.cell
        return columns, rows


class Walk:
    """The shortest walk from any place through one cell of each mask, in the masks' order."""

    def __init__(self, ground: ReachableFloor, stops: Sequence[Bools]) -> None:
        self._ground, self._stops = ground, tuple(stops)
        self._fields: dict[int, DistanceField] = {}
        for number in reversed(range(len(self._stops))):
            edge = ground.space.centres(entry_cells(self._stops[number], ground.space.free))
            self._fields[number] = ground.paths.field(edge, self._left(edge, number + 1))

    def lengths(self, starts: ArrayLike) -> Floats:
        """(N,) [m] for ``starts`` (N, 2), less the grid's slack; inf if there is no such walk."""
        slack = (2 * len(self._stops) - 1) * SLACK_M
        return np.maximum(self._left(np.asarray(starts, dtype=float).reshape(-1, 2), 0) - slack, 0.0)

    def _left(self, places: Floats, stop: int) -> Floats:
        """(N,) Length of the rest of the walk from ``places``, with the stops before ``stop`` done."""
        if stop == len(self._stops):
            return np.zeros(len(places))
        lengths = self._fields[stop].at(places)
        if (there := self._ground.within(self._stops[stop], places)).any():
            lengths[there] = self._left(places[there], stop + 1)
        return lengths


def entry_cells(mask: Bools, free: Bools) -> Bools:
    """The cells of a mask through which a walk can enter it."""
    out = np.zeros_like(mask)
    outside = free & ~mask
    out[1:, :] |= outside[:-1, :]
    out[:-1, :] |= outside[1:, :]
    out[:, 1:] |= outside[:, :-1]
    out[:, :-1] |= outside[:, 1:]
    return out & mask


@functools.lru_cache(maxsize=64)
def lines_of_sight(house: HouseSpec, opened: frozenset[str]) -> visibility.LinesOfSight:
    """Lines of sight past every opaque part of the house's walls and things, computed once per process.

    The doors of things whose ids are ``opened`` are left out, as if they were open.
    """
    parts = [
        box
        for thing in house.things
        for part, box in boxes.boxes_of(thing)
        if part.rgba[3] >= 1.0 and not (part.moves and thing.id in opened)
    ]
    return visibility.LinesOfSight([*visibility.wall_boxes(house), *parts])
