"""Walls as upright boxes for the eye: cut at openings, with corners that close and no two faces in one plane.

The boxes of `hthor.world.model.walls`, which bodies run into, overlap at their ends; here materials would flicker
there.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

from hthor.geometry import plane
from hthor.houses.space.solids import WALL_M
from hthor.types import HouseSpec, Opening, Vec2, Vec3, Wall

_LINE_M = 0.08
"""How far an opening's ends may lie from a face's line and still cut it."""
_BIT_M = 0.02


def is_exterior(face: Wall) -> bool:
    """Whether a face looks outdoors; ProcTHOR's own files say so in its id only."""
    return face.room == "exterior" or face.id.startswith("wall|exterior|")


class WallSlab(NamedTuple):
    """A box ``half`` [m] along, across and up, turned by ``yaw`` [rad]; ``low`` and ``top`` [m] are its heights."""

    face: Wall
    centre: Vec3
    half: Vec3
    yaw: float

    @property
    def low(self) -> float:
        return self.centre[2] - self.half[2]

    @property
    def top(self) -> float:
        return self.centre[2] + self.half[2]


class WallFace:
    """One face of a wall: a slab of half a wall's thickness on the side of its room."""

    def __init__(self, house: HouseSpec, face: Wall) -> None:
        self._house, self._face = house, face
        self.length = math.dist(face.a, face.b)
        self._along = ((face.b[0] - face.a[0]) / self.length, (face.b[1] - face.a[1]) / self.length)
        middle = self._at(self.length / 2, WALL_M / 2)
        self._side = 1.0 if self._within(middle) else -1.0

    def slabs(self) -> Iterator[WallSlab]:
        """The face's pieces: beside, below and above its openings."""
        first, last = -self._reach(0.0, -1.0), self.length + self._reach(self.length, 1.0)
        start = first
        for begin, end, low, high in sorted(self._cuts(first, last)):
            yield from self._slab((start, begin), (0.0, self._face.height))
            yield from self._slab((begin, end), (0.0, low))
            yield from self._slab((begin, end), (high, self._face.height))
            start = max(start, end)
        yield from self._slab((start, last), (0.0, self._face.height))

    def _reach(self, end: float, way: float) -> float:
        """How far the slab goes on past an end: round an outward corner if it runs along x, else not at all."""
        beyond = end + way * _BIT_M
        outward = all(self._within(self._at(beyond, self._side * off)) for off in (_BIT_M, -_BIT_M))
        return WALL_M / 2 if outward and abs(self._along[0]) > 0.5 else 0.0

    def _within(self, point: Vec2) -> bool:
        rooms = self._house.rooms
        if is_exterior(self._face):
            return not any(plane.inside(point, room.polygon) for room in rooms)
        return any(room.id == self._face.room and plane.inside(point, room.polygon) for room in rooms)

    def _at(self, along: float, left: float) -> Vec2:
        (x, y), (dx, dy) = self._face.a, self._along
        return (x + dx * along - dy * left, y + dy * along + dx * left)

    def _cuts(self, first: float, last: float) -> Iterator[tuple[float, float, float, float]]:
        """Stretches (begin, end) [m] along the face and the heights (low, high) that its openings take out."""
        for opening in self._house.openings:
            begin, end = self.cut(opening)
            if end - begin > 1e-6:
                begin, end = begin if begin > 1e-6 else first, end if end < self.length - 1e-6 else last
                yield (begin, end, opening.low, opening.high)

    def cut(self, opening: Opening) -> Vec2:
        """The stretch [m] along the face that an opening takes out, (0, 0) when it is in another wall."""
        dx, dy = self._along
        offsets = [(x - self._face.a[0], y - self._face.a[1]) for x, y in (opening.a, opening.b)]
        if any(abs(dx * oy - dy * ox) > _LINE_M for ox, oy in offsets):
            return (0.0, 0.0)
        ends = sorted(dx * ox + dy * oy for ox, oy in offsets)
        return max(ends[0], 0.0), min(ends[1], self.length)

    def _slab(self, reach: Vec2, heights: Vec2) -> Iterator[WallSlab]:
        (begin, end), (low, high) = reach, heights
        if end - begin > 1e-6 and high - low > 1e-6:
            x, y = self._at((begin + end) / 2, self._side * WALL_M / 4)
            half = ((end - begin) / 2, WALL_M / 4, (high - low) / 2)
            yaw = math.atan2(self._along[1], self._along[0])
            yield WallSlab(self._face, (x, y, (low + high) / 2), half, yaw)


def wall_slabs(house: HouseSpec) -> Iterator[WallSlab]:
    """Every piece of wall of the house."""
    for face in house.walls:
        if math.dist(face.a, face.b) > 1e-6:
            yield from WallFace(house, face).slabs()


def wall_of(house: HouseSpec, opening: Opening) -> str:
    """Id of a wall face that the opening is in, empty for none."""
    for face in house.walls:
        if math.dist(face.a, face.b) > 1e-6:
            begin, end = WallFace(house, face).cut(opening)
            if end - begin > 1e-6:
                return face.id
    return ""
