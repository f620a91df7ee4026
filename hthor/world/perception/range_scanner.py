"""Range scans of the static obstacles of a house; bodies and movable objects are not in them."""

import math

import numba
import numpy as np
from msgspec import UNSET

from hthor.geometry import plane
from hthor.geometry.ray_casting import Bools, Floats
from hthor.houses.space import grid_kernel, obstacles, solids
from hthor.houses.space.free_space import FreeSpace
from hthor.types import BodySpec, HouseSpec, Pose, RobotSpec, Scan


class RangeScanner:
    """The range sensor of one body: beams evenly spread over its horizontal field of view, both edges included."""

    def __init__(self, spec: BodySpec, space: FreeSpace, house: HouseSpec) -> None:
        half = spec.fov[0] / 2
        self._bearings = np.linspace(-half, half, spec.scan_beams)
        self._bearings.setflags(write=False)
        self._limit = spec.scan_range
        self._tops = _tops(house, space, spec.height)
        self._over = 0.0 if isinstance(spec, RobotSpec) else spec.eye  # a robot's range finder cannot look over things

    def scan(self, pose: Pose, space: FreeSpace) -> Scan:
        """The scan from the head at ``pose``, exact on the obstacle grid ``space`` of 5 cm cells."""
        if pose.head is not UNSET:
            pose = Pose(x=pose.x, y=pose.y, yaw=plane.wrap(pose.gaze), pitch=pose.pitch)
        bearings, limit, place = self._bearings, self._limit, (*space.origin, space.cell, pose.x, pose.y, pose.yaw)
        ranges, tops, walls = np.empty(len(bearings)), np.empty(len(bearings)), np.empty(len(bearings))
        _march(space.raw, self._tops, *place, bearings, limit, self._over, ranges, tops, walls)
        beyond = walls if self._over else None
        return Scan(origin=pose, bearings=bearings, ranges=ranges, limit=limit, tops=tops, beyond=beyond)


def _tops(house: HouseSpec, space: FreeSpace, height: float) -> np.ndarray:
    """(ny, nx) [m], the height of the tallest furniture that stops a body in each cell; infinite in other cells."""
    tops = np.full(space.raw.shape, np.inf)
    slabs = [slab for _, slab in obstacles.furniture_in_the_way(house, height)]
    walls = np.array(
        [(*slab.centre, slab.size[0] / 2, slab.size[1] / 2, slab.yaw) for slab in solids.wall_slabs(house)]
    )
    everywhere, half = np.ones_like(space.raw), space.cell / 2
    for slab in sorted(slabs, key=lambda slab: slab.high):
        row = np.array([(*slab.centre, slab.size[0] / 2, slab.size[1] / 2, slab.yaw)])
        tops[~grid_kernel.clear_cells(everywhere, row, *space.origin, space.cell, half)] = slab.high
    tops[~grid_kernel.clear_cells(everywhere, walls.reshape(-1, 5), *space.origin, space.cell, half)] = np.inf
    return tops


@numba.njit(cache=True)
def _march(
    raw: Bools, tops: Floats, ox: float, oy: float, cell: float, x: float, y: float, yaw: float, bearings: Floats,
    limit: float, over: float, ranges: Floats, met: Floats, beyond: Floats,
) -> None:  # fmt: skip
    """Fill arrays (N,) [m] of a `Scan`: ``ranges``, tops (``met``), ``beyond``. Each beam goes from cell edge to cell
    edge until it enters a cell that is not clear, and then on over obstacles lower than ``over`` [m].
    """
    ny, nx = raw.shape
    met[:], beyond[:] = np.inf, limit
    px, py, far = (x - ox) / cell, (y - oy) / cell, limit / cell
    for k in range(len(bearings)):
        ux, uy = math.cos(yaw + bearings[k]), math.sin(yaw + bearings[k])
        i, j = math.floor(px), math.floor(py)
        si, sj = (1 if ux > 0.0 else -1), (1 if uy > 0.0 else -1)
        dx = 1.0 / abs(ux) if ux != 0.0 else 1e30
        dy = 1.0 / abs(uy) if uy != 0.0 else 1e30
        tx = ((i + 1 - px) if si > 0 else (px - i)) * dx if ux != 0.0 else 1e30
        ty = ((j + 1 - py) if sj > 0 else (py - j)) * dy if uy != 0.0 else 1e30
        t, first = 0.0, far
        while t < far:
            if tx < ty:
                t, tx, i = tx, tx + dx, i + si
            else:
                t, ty, j = ty, ty + dy, j + sj
            if not (0 <= i < nx and 0 <= j < ny):
                break
            if not raw[j, i] and t < far:
                if first == far:
                    first, met[k] = t, tops[j, i]
                if tops[j, i] >= over:
                    beyond[k] = t * cell
                    break
        ranges[k] = min(t, first) * cell
