"""Shut doorways, which stop bodies and range scans: each body's free-space grid with them taken out.

Grids are computed when a door is first shut, and kept. While all doorways are open they are those of the house.
"""

import copy
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from hthor.geometry import plane
from hthor.houses.space import grid_kernel
from hthor.houses.space.free_space import FreeSpace
from hthor.types import Opening
from hthor.world.model.door_geometry import LEAF_M
from hthor.world.state.body_state import BodyState


class Doorways:
    """The free-space grids of a world's seats, with what is shut taken out.

    Args:
        seats: whose ``space`` is kept up to date. spaces: the same grids by seat, kept up to date as well.
    """

    def __init__(self, seats: Iterable[BodyState], spaces: dict[str, FreeSpace]) -> None:
        self._seats, self._spaces = tuple(seats), spaces
        self._open = dict(spaces)
        self._shut: frozenset[str] = frozenset()
        self._known: dict[tuple[str, frozenset[str]], FreeSpace] = {}

    def update(self, shut: Mapping[str, Opening]) -> None:
        """Take over which doorways are shut; all others are open."""
        names = frozenset(shut)
        if names == self._shut:
            return
        self._shut = names
        for seat in self._seats:
            seat.space = self._spaces[seat.name] = self._space(seat.name, shut)

    def _space(self, seat: str, shut: Mapping[str, Opening]) -> FreeSpace:
        whole, key = self._open[seat], (seat, frozenset(shut))
        if shut and key not in self._known:
            self._known[key] = with_obstacles(whole, [leaf_rectangle(opening) for opening in shut.values()])
        return self._known[key] if shut else whole


def leaf_rectangle(opening: Opening) -> tuple[float, float, float, float, float]:
    """A shut door on the floor plan: centre x, y, half width, half depth [m], yaw [rad]."""
    (ax, ay), (bx, by) = opening.a, opening.b
    yaw, half = np.arctan2(by - ay, bx - ax), np.hypot(bx - ax, by - ay) / 2
    return ((ax + bx) / 2, (ay + by) / 2, float(half), LEAF_M / 2, float(yaw))


def in_doorway(seat: BodyState, opening: Opening) -> bool:
    """Whether a body stands where the shut leaf would be, or so near that its cell would be blocked."""
    x, y, half, deep, yaw = leaf_rectangle(opening)
    gap = plane.distance_to_rectangle((seat.pose.x, seat.pose.y), (x, y), (2 * half, 2 * deep), yaw)
    return gap < seat.spec.radius + seat.space.cell


def with_obstacles(space: FreeSpace, rectangles: list[tuple[float, float, float, float, float]]) -> FreeSpace:
    """A copy of a grid with these rectangles as further obstacles."""
    rows = np.array(rectangles, dtype=float).reshape(-1, 5)
    cut: Any = copy.copy(space)
    cut.__dict__.pop("components", None)
    cut.free = grid_kernel.clear_cells(space.free, rows, *space.origin, space.cell, space.radius)
    cut.raw = grid_kernel.clear_cells(space.raw, rows, *space.origin, space.cell, space.cell / 2)
    cut.free.setflags(write=False)
    cut.raw.setflags(write=False)
    narrowed: FreeSpace = cut
    return narrowed
