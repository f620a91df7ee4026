"""Walls as boxes: every face is a slab of half a wall's thickness, cut at doors and windows."""

import math
from collections.abc import Iterator
from typing import Literal, NamedTuple

from hthor.geometry import plane
from hthor.houses.space.solids import WALL_M
from hthor.looks import finishes
from hthor.types import HouseSpec, Opening, Rgba, Vec2, Vec3, Wall

_LINE_M = 0.08
"""[m] An opening cuts a face if its ends lie no farther than this from the face's line."""
_OVERLAP_M = WALL_M / 2 - 0.002
"""[m] How far a face reaches past its ends to close corners, a little less than would be visible behind them."""
_CAP_M = 0.002
"""[m] Outdoor faces are this much taller, so that only their colour is visible from above."""
_PANE_M, _LEAF_M = 0.01, 0.04
"""[m] Thickness of a window pane and of a closed door."""
_PANE: Rgba = (0.70, 0.84, 0.92, 0.25)
_DOOR: Rgba = (0.42, 0.28, 0.20, 1.0)
"""Colour of the outside door."""


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


class FaceLine:
    """The line on the floor along which a wall's face stands, from its end ``a`` to ``b``."""

    def __init__(self, face: Wall) -> None:
        self.face, self.length = face, math.dist(face.a, face.b)
        self.along = ((face.b[0] - face.a[0]) / self.length, (face.b[1] - face.a[1]) / self.length)

    def at(self, along: float, left: float) -> Vec2:
        """The point at ``along`` [m] on the line and ``left`` [m] to the left of it."""
        (x, y), (dx, dy) = self.face.a, self.along
        return (x + dx * along - dy * left, y + dy * along + dx * left)

    def cut(self, opening: Opening) -> Vec2:
        """The stretch [m] of the face that an opening cuts out, (0, 0) when the opening is in another wall."""
        dx, dy = self.along
        offsets = [(x - self.face.a[0], y - self.face.a[1]) for x, y in (opening.a, opening.b)]
        if any(abs(dx * oy - dy * ox) > _LINE_M for ox, oy in offsets):
            return (0.0, 0.0)
        ends = sorted(dx * ox + dy * oy for ox, oy in offsets)
        return max(ends[0], 0.0), min(ends[1], self.length)

    def slabs(self, house: HouseSpec, side: float, first: float, last: float, top: float) -> Iterator[WallSlab]:
        """The face's pieces around its holes, from ``first`` to ``last`` [m] along it and up to ``top`` [m].

        ``side`` is +1 for a face that stands left of its line, -1 for right.
        """
        start = first
        for begin, end, low, high in sorted(self._cuts(house, first, last)):
            yield from self._slab(side, (start, begin), (0.0, top))
            yield from self._slab(side, (begin, end), (0.0, low))
            yield from self._slab(side, (begin, end), (high, top))
            start = max(start, end)
        yield from self._slab(side, (start, last), (0.0, top))

    def _cuts(self, house: HouseSpec, first: float, last: float) -> Iterator[tuple[float, float, float, float]]:
        """The (begin, end, low, high) [m] along and up the face that its openings cut out."""
        for opening in house.openings:
            begin, end = self.cut(opening)
            if end - begin > 1e-6:
                begin, end = begin if begin > 1e-6 else first, end if end < self.length - 1e-6 else last
                yield (begin, end, opening.low, opening.high)

    def _slab(self, side: float, reach: Vec2, heights: Vec2) -> Iterator[WallSlab]:
        (begin, end), (low, high) = reach, heights
        if end - begin > 1e-6 and high - low > 1e-6:
            x, y = self.at((begin + end) / 2, side * WALL_M / 4)
            half = ((end - begin) / 2, WALL_M / 4, (high - low) / 2)
            yield WallSlab(self.face, (x, y, (low + high) / 2), half, math.atan2(self.along[1], self.along[0]))


def face_lines(house: HouseSpec) -> Iterator[FaceLine]:
    """The lines of all faces whose length is not zero."""
    return (FaceLine(face) for face in house.walls if math.dist(face.a, face.b) > 1e-6)


class Panel(NamedTuple):
    """One upright box, ``half`` its half extents along, across and up."""

    name: str
    sort: Literal["wall", "lintel", "pane", "door"]
    centre: Vec3
    half: Vec3
    yaw: float
    rgba: Rgba


def wall_panels(house: HouseSpec) -> Iterator[Panel]:
    """Every wall piece, sill, lintel, window pane and closed door of the house."""
    for line in face_lines(house):
        face = line.face
        top, colour = face.height + (_CAP_M if face.room == "exterior" else 0.0), _colour(face)
        for slab in line.slabs(house, _side(house, line), -_OVERLAP_M, line.length + _OVERLAP_M, top):
            yield Panel(face.id, "lintel" if slab.low > 0.0 else "wall", *slab[1:], colour)
    for opening in house.openings:
        if not opening.passable:
            yield _filling(opening)


def _side(house: HouseSpec, line: FaceLine) -> float:
    """The side of its line on which a face stands: +1 left, -1 right; a room's face stands on the room's side."""
    left, owner = line.at(line.length / 2, WALL_M / 2), line.face.room
    within = any(plane.inside(left, room.polygon) for room in house.rooms if owner in (room.id, "exterior"))
    return 1.0 if within == (owner != "exterior") else -1.0


def _colour(face: Wall) -> Rgba:
    """The colour that the house gives a face; without one, an outdoor face has the colour of brick."""
    name = face.material or ("brick" if face.room == "exterior" else "")
    return (*(finishes.wall(name)[1] if face.rgb is None else face.rgb), 1.0)


def _filling(opening: Opening) -> Panel:
    """The panel that closes an opening: glass in a window, a door in a doorway that is never opened."""
    (ax, ay), (bx, by) = opening.a, opening.b
    window = opening.kind == "window"
    half = (math.dist(opening.a, opening.b) / 2, (_PANE_M if window else _LEAF_M) / 2, (opening.high - opening.low) / 2)
    centre = ((ax + bx) / 2, (ay + by) / 2, (opening.low + opening.high) / 2)
    yaw = math.atan2(by - ay, bx - ax)
    return Panel(opening.id, "pane" if window else "door", centre, half, yaw, _PANE if window else _DOOR)
