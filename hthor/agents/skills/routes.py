"""Shortest paths of a body through a known house."""

import functools
import itertools
import math
from collections.abc import Sequence

import numpy as np

from hthor.agents.skills.viewpoints import keeps_clear
from hthor.geometry import plane
from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.geodesic import house_geodesics
from hthor.houses.space.grid_kernel import are_free_points
from hthor.houses.space.visibility import with_all_open
from hthor.navigation.detours import Disc, detour, without
from hthor.navigation.waiting_spots import park
from hthor.types import BodySpec, HouseSpec, Room, Thing, Vec2, Vec3

_MARGIN_M = 0.1
_MISS_M = 0.4
_BESIDE_M = 0.2
_BROAD_M = 0.38
_REFUGE_M = 5.0
"""Longest way to a place to wait [m]."""


_sight = functools.lru_cache(maxsize=8)(with_all_open)


class HouseRoutes:
    """Routes of one body through a house that it has a map of.

    Args:
        others: the other bodies, for which it keeps passages free where it waits; without them, bodies like itself.
    """

    def __init__(self, house: HouseSpec, body: BodySpec, others: Sequence[BodySpec] = ()) -> None:
        self.house, self.body = house, body
        self.space = FreeSpace.of(house, body.radius, body.height)
        bodies = (body, *others)
        widest, tallest = max(one.radius for one in bodies), max(one.height for one in bodies)
        self._passages = FreeSpace.of(house, widest, tallest)
        self.geodesics = house_geodesics(house, body.radius, body.height)
        self._beside = functools.lru_cache(maxsize=256)(self.space.nearest_free)
        self._near = functools.lru_cache(maxsize=256)(self._walk)

    def fits(self, a: Vec2, b: Vec2) -> bool:
        """Whether the body can go straight from ``a`` to ``b``."""
        return self.space.segment_free(a, b)

    def stands(self, spot: Vec2) -> bool:
        """Whether the body may be here."""
        return self.space.is_free(*spot)

    def standing(self, spots: Sequence[Vec2]) -> list[Vec2]:
        """The spots where the body may be."""
        (ox, oy), cell = self.space.origin, self.space.cell
        places = (np.array(spots, dtype=float).reshape(-1, 2) - (ox, oy)) / cell
        return list(itertools.compress(spots, are_free_points(self.space.free, places).tolist()))

    def lengths(self, here: Vec2, spots: Sequence[Vec2]) -> list[float]:
        """Lengths [m] of the shortest paths to free spots; inf where there is none."""
        lengths: list[float] = self.geodesics.distances(self.space.nearest_free(*here), spots).tolist()
        return lengths

    def way(self, here: Vec2, spot: Vec2) -> tuple[Vec2, ...]:
        """The shortest path from the body to a free spot; () when there is none."""
        return self.geodesics.path(self.space.nearest_free(*here), spot)

    def past(self, here: Vec2, goal: Vec2, discs: Sequence[Disc], most_m: float) -> tuple[Vec2, ...]:
        """A path of at most ``most_m`` [m] to a free spot that keeps out of the discs; () when there is none."""
        return detour(self.space.free, self.space.origin, self.space.cell, here, goal, discs, most_m)

    def refuge(self, here: Vec2, point: Vec2, apart_m: float, discs: Sequence[Disc]) -> tuple[Vec2, ...]:
        """Like `retreat`, on this side of the discs; () for no place that can be reached."""
        grid = self.space.origin, self.space.cell
        spot = park(without(self._passages.free, *grid, here, discs) > 0, *grid, here, point, apart_m)
        return () if spot is None else self.past(here, spot, discs, _REFUGE_M)

    def broad(self, here: Vec2, spot: Vec2) -> tuple[Vec2, ...]:
        """A short path that is broad enough to pull something along, or else the shortest path; () for none."""
        space = FreeSpace.of(self.house, max(self.body.radius, _BROAD_M), self.body.height)
        a, b = space.nearest_free(*here), space.nearest_free(*spot)
        if max(math.dist(a, here), math.dist(b, spot)) < _BROAD_M:
            way = house_geodesics(self.house, space.radius, space.height).path(a, b)
            if way:
                return (*way, self.space.nearest_free(*spot))
        return self.way(here, self.space.nearest_free(*spot))

    def loose(self, here: Vec2) -> Vec2:
        """Where to go first when the body is stopped here."""
        return self.clear(here)

    def sees(self, spot: Vec2, point: Vec3) -> bool:
        """Whether nothing of the house hides a point from the body's eye, with all doors of furniture open."""
        speck = Thing(id="", kind="", asset="", centre=point, size=(0.0, 0.0, 0.05), yaw=0.0)
        return _sight(self.house).visible(speck, point, np.array([(*spot, self.body.eye)]))

    def open_to(self, spot: Vec2, edge: Vec2) -> bool:
        """Whether no wall is between a spot and the edge of a thing."""
        return self.same_room(spot, (*edge, 0.0))

    def apart(self, here: Vec2, place: Vec3) -> float:
        """Like `near`; faster for few places and many starting points."""
        return self.geodesics.distance(self._beside(place[0], place[1]), self.space.nearest_free(*here))

    def near(self, a: Vec2, place: Vec3) -> float:
        """Walking distance [m] between the free places nearest to ``a`` and to ``place``."""
        return self._near(a[0], a[1], place[0], place[1])

    def _walk(self, x: float, y: float, px: float, py: float) -> float:
        return self.geodesics.distance(self.space.nearest_free(x, y), self._beside(px, py))

    def same_room(self, a: Vec2, place: Vec3) -> bool:
        """Whether both lie in one room; so nothing but furniture can be between them."""
        room = self._room((place[0], place[1]))
        return room is None or plane.inside(a, room.polygon)

    def clear(self, here: Vec2) -> Vec2:
        """The middle of the roomiest free cell close by."""
        row, column = self.space.cell_of(*here)
        free = self.space.free
        best, most = self.space.nearest_free(*here), -1
        for j in range(row - 2, row + 3):
            for i in range(column - 2, column + 3):
                room = int(free[max(j - 2, 0) : j + 3, max(i - 2, 0) : i + 3].sum())
                if 0 <= j < free.shape[0] and 0 <= i < free.shape[1] and free[j, i] and room > most:
                    best, most = self.space.centre_of(j, i), room
        return best

    def around(self, here: Vec2, place: Vec3, people: Sequence[Vec3]) -> Vec2:
        """A spot next to the nearest person with the shortest path to ``place``; ``here`` when none is free."""
        person = min(people, key=lambda other: math.dist(other[:2], here))
        radius = 2.0 * self.body.radius + _BESIDE_M
        spots = []
        for k in range(16):
            angle = 2.0 * math.pi * k / 16
            spot = (person[0] + radius * math.cos(angle), person[1] + radius * math.sin(angle))
            if self.space.segment_free(here, spot) and keeps_clear(here, spot, (person[0], person[1]), radius - 0.1):
                spots.append(spot)
        goal = self.space.nearest_free(place[0], place[1])
        return min(spots, key=lambda spot: math.dist(here, spot) + self.geodesics.distance(goal, spot), default=here)

    def retreat(self, here: Vec2, point: Vec2, apart_m: float) -> tuple[Vec2, ...]:
        """The path to a spot where the body blocks nobody, ``apart_m`` metres from ``point``; () to stay."""
        spot = park(self._passages.free, self.space.origin, self.space.cell, here, point, apart_m)
        return () if spot is None else self.geodesics.path(here, spot)

    def to_view(self, here: Vec2, place: Vec3, but: Sequence[Vec2] = ()) -> tuple[Vec2, ...]:
        """The shortest path to a spot from which ``place`` is within range in the same room; () when there is none.

        Nothing within 0.4 m of the spots ``but``, which failed, is proposed.
        """
        spots = self._spots(place, but)
        if not len(spots):
            return ()
        lengths = self.geodesics.distances(here, spots)
        best = int(np.argmin(lengths))
        if not math.isfinite(lengths[best]):
            return ()
        return self.geodesics.path(here, (float(spots[best][0]), float(spots[best][1])))

    def _spots(self, place: Vec3, but: Sequence[Vec2]) -> np.ndarray:
        """(N, 2) centres [m] of free cells within the camera's range; the nearest ones when none is."""
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
        return next((room for room in self.house.rooms if plane.inside(point, room.polygon)), None)
