"""Shortest ways through a known house to where a place comes into view; knows nothing of messages."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from hthor import geometry
from hthor.houses.freespace import FreeSpace
from hthor.houses.geodesic import geodesics
from hthor.types import BodySpec, HouseSpec, Room, Vec2, Vec3

_MARGIN_M = 0.1
_MISS_M = 0.4


class Routes:
    """Ways of one body through one house."""

    def __init__(self, house: HouseSpec, body: BodySpec) -> None:
        self.house, self.body = house, body
        self.space = FreeSpace.of(house, body.radius, body.height)
        self.ways = geodesics(house, body.radius, body.height)

    def fits(self, a: Vec2, b: Vec2) -> bool:
        """Whether the body can go straight from ``a`` to ``b``."""
        return self.space.segment_free(a, b)

    def near(self, a: Vec2, place: Vec3) -> float:
        """Walking distance [m] between the free places nearest to ``a`` and to ``place``."""
        return self.ways.distance(self.space.nearest_free(*a), self.space.nearest_free(place[0], place[1]))

    def same_room(self, a: Vec2, place: Vec3) -> bool:
        """Whether both lie in one room; so nothing but furniture can be between them."""
        room = self._room((place[0], place[1]))
        return room is None or geometry.inside(a, room.polygon)

    def to_view(self, here: Vec2, place: Vec3, but: Sequence[Vec2] = ()) -> tuple[Vec2, ...]:
        """The shortest way to a spot from which ``place`` is within range in the same room, () when there is none.

        Args:
            but: spots that turned out to be no good; nothing within 0.4 m of them is proposed.
        """
        spots = self._spots(place, but)
        if not len(spots):
            return ()
        lengths = self.ways.distances(here, spots)
        best = int(np.argmin(lengths))
        if not math.isfinite(lengths[best]):
            return ()
        return self.ways.path(here, (float(spots[best][0]), float(spots[best][1])))

    def _spots(self, place: Vec3, but: Sequence[Vec2]) -> np.ndarray:
        """(N, 2) middles of free cells from which the eye is within range; the nearest ones when none is."""
        cells = self.space.centres(self.space.free)
        room = self._room((place[0], place[1]))
        if room is not None:
            mask = self.space.room_mask(room)
            cells = self.space.centres(self.space.free & mask) if mask.any() else cells
        for miss in but:
            cells = cells[np.hypot(cells[:, 0] - miss[0], cells[:, 1] - miss[1]) > _MISS_M]
        if not len(cells):
            return cells
        apart = np.hypot(cells[:, 0] - place[0], cells[:, 1] - place[1])
        rise = self.body.eye - place[2]
        reach = math.sqrt(max(self.body.sight_range**2 - rise**2, 0.0)) - _MARGIN_M
        return cells[apart <= max(reach, float(apart.min()) + _MARGIN_M)]

    def _room(self, point: Vec2) -> Room | None:
        return next((room for room in self.house.rooms if geometry.inside(point, room.polygon)), None)
