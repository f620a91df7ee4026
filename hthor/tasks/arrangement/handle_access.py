"""Whether a thing with handles stands so that two bodies can take its ends."""

import math

import numpy as np
from numpy.typing import NDArray
from skimage.measure import label

from hthor import catalog
from hthor.geometry import plane
from hthor.houses.space.free_space import FreeSpace
from hthor.tasks.arrangement.free_spots import LANE_M, NEAR_M
from hthor.tasks.arrangement.reachability import HEIGHT_M
from hthor.types import HouseSpec, Placement, Vec2

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]

POCKET_M = 1.0
"""Floor within this distance of the thing may be cut off by it [m]; all other floor stays connected."""


def are_ends_accessible(house: HouseSpec, placement: Placement) -> bool:
    """Whether two bodies can take the ends one after the other, whichever end is taken first.

    The thing and a body that stands in line with it at one end are in the way; bodies are discs of radius
    `free_spots.LANE_M`. Nor may the thing cut the house in two.
    """
    space = FreeSpace.of(house, LANE_M, HEIGHT_M)
    centre, size = placement.position[:2], catalog.kind(placement.kind).size[:2]
    cells = space.centres(space.free & (space.components == _largest(space.components, space.free)))
    cells = cells[_distances(cells, centre, size, placement.yaw) >= LANE_M]
    around = _main(space, cells)
    far = np.hypot(*(cells - centre).T) > POCKET_M
    if not around[far].all():
        return False
    ends = [plane.to_house((side * size[0] / 2, 0.0, 0.0), placement.position, placement.yaw)[:2] for side in (1, -1)]
    for first, other in (ends, ends[::-1]):
        body = _in_line(first, centre)
        stands = cells[around & _at_end(cells, first, other)]
        if not len(stands) or np.hypot(*(stands - body).T).min() > LANE_M:
            return False
        beside = cells[np.hypot(*(cells - body).T) >= 2 * LANE_M]
        if not (_main(space, beside) & _at_end(beside, other, first)).any():
            return False
    return True


def _in_line(end: Vec2, middle: Vec2) -> Vec2:
    """Where a body stands that holds an end and is in line with the thing [m]."""
    apart = math.dist(end, middle)
    share = LANE_M / apart
    return (end[0] + share * (end[0] - middle[0]), end[1] + share * (end[1] - middle[1]))


def _at_end(cells: Floats, end: Vec2, other: Vec2) -> Bools:
    """(N,) The cells from which this end can be held, and is nearer than the other."""
    apart = np.hypot(*(cells - end).T)
    held: Bools = (apart <= NEAR_M) & (apart < np.hypot(*(cells - other).T))
    return held


def _main(space: FreeSpace, cells: Floats) -> Bools:
    """(N,) The cells (N, 2) [m] in the largest connected part of them."""
    rows, columns = ((cells - space.origin) / space.cell).astype(np.int64).T[::-1]
    grid = np.zeros(space.free.shape, dtype=bool)
    grid[rows, columns] = True
    parts = label(grid, connectivity=1)
    main: Bools = parts[rows, columns] == _largest(parts, grid)
    return main


def _largest(parts: NDArray[np.int32], cells: Bools) -> int:
    return int(np.bincount(parts[cells]).argmax()) if cells.any() else -1


def _distances(cells: Floats, centre: Vec2, size: Vec2, yaw: float) -> Floats:
    """(N,) [m] Distances of points (N, 2) to a turned rectangle."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    x, y = (cells - centre).T
    along, aside = np.abs(cos * x + sin * y) - size[0] / 2, np.abs(cos * y - sin * x) - size[1] / 2
    distances: Floats = np.hypot(np.maximum(along, 0.0), np.maximum(aside, 0.0))
    return distances
