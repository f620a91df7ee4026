"""Walls as boxes: every face a slab of half a wall's thickness, cut at doors and windows."""

import math
from collections.abc import Iterator
from typing import Literal, NamedTuple

from hthor.geometry import plane
from hthor.houses.space.solids import WALL_M
from hthor.types import HouseSpec, Opening, Rgba, Vec2, Vec3, Wall
from hthor.world.model import colors

_LINE_M = 0.08
"""How far an opening's ends may lie from a face's line and still cut it."""
_OVERLAP_M = WALL_M / 2 - 0.002
"""How far a face reaches past its ends to close corners, a little less than what would show on the other side."""
_CAP_M = 0.002
"""Outdoor faces are this much taller, so that seen from above one colour wins."""
_PANE_M, _LEAF_M = 0.01, 0.04
"""Thickness of a window pane and of a closed door."""


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
    for face in house.walls:
        yield from _face(house, face)
    for opening in house.openings:
        if not opening.passable:
            yield _filling(opening)


def _face(house: HouseSpec, face: Wall) -> Iterator[Panel]:
    length = math.dist(face.a, face.b)
    if length < 1e-6:
        return
    along = ((face.b[0] - face.a[0]) / length, (face.b[1] - face.a[1]) / length)
    side = _side(house, face, along)
    top = face.height + (_CAP_M if face.room == "exterior" else 0.0)
    start = -_OVERLAP_M
    for begin, end, low, high in sorted(_cuts(house, face, along, length)):
        yield from _slab(face, along, side, (start, begin), (0.0, top))
        yield from _slab(face, along, side, (begin, end), (0.0, low))
        yield from _slab(face, along, side, (begin, end), (high, top))
        start = max(start, end)
    yield from _slab(face, along, side, (start, length + _OVERLAP_M), (0.0, top))


def _side(house: HouseSpec, face: Wall, along: Vec2) -> float:
    """On which side of its line a face stands: +1 left of it, -1 right; a room's face on the room's side."""
    middle = ((face.a[0] + face.b[0]) / 2, (face.a[1] + face.b[1]) / 2)
    left = (middle[0] - along[1] * WALL_M / 2, middle[1] + along[0] * WALL_M / 2)
    polygons = [room.polygon for room in house.rooms if face.room in (room.id, "exterior")]
    within = any(plane.inside(left, polygon) for polygon in polygons)
    return 1.0 if within == (face.room != "exterior") else -1.0


def _cuts(house: HouseSpec, face: Wall, along: Vec2, length: float) -> Iterator[tuple[float, float, float, float]]:
    """Stretches (begin, end) [m] along the face and the heights (low, high) that its openings take out."""
    for opening in house.openings:
        offsets = [(x - face.a[0], y - face.a[1]) for x, y in (opening.a, opening.b)]
        if any(abs(along[0] * dy - along[1] * dx) > _LINE_M for dx, dy in offsets):
            continue
        ends = sorted(along[0] * dx + along[1] * dy for dx, dy in offsets)
        begin, end = max(ends[0], 0.0), min(ends[1], length)
        if end - begin > 1e-6:
            begin = begin if begin > 1e-6 else -_OVERLAP_M
            yield (begin, end if end < length - 1e-6 else length + _OVERLAP_M, opening.low, opening.high)


def _slab(face: Wall, along: Vec2, side: float, reach: Vec2, heights: Vec2) -> Iterator[Panel]:
    (begin, end), (low, high) = reach, heights
    if end - begin < 1e-6 or high - low < 1e-6:
        return
    middle, off = (begin + end) / 2, side * WALL_M / 4
    x = face.a[0] + along[0] * middle - along[1] * off
    y = face.a[1] + along[1] * middle + along[0] * off
    half = ((end - begin) / 2, WALL_M / 4, (high - low) / 2)
    yaw = math.atan2(along[1], along[0])
    yield Panel(face.id, "lintel" if low > 0.0 else "wall", (x, y, (low + high) / 2), half, yaw, colors.wall(face))


def _filling(opening: Opening) -> Panel:
    """What closes an opening: glass in a window, a leaf in a door that nobody opens."""
    (ax, ay), (bx, by) = opening.a, opening.b
    window = opening.kind == "window"
    half = (math.dist(opening.a, opening.b) / 2, (_PANE_M if window else _LEAF_M) / 2, (opening.high - opening.low) / 2)
    centre = ((ax + bx) / 2, (ay + by) / 2, (opening.low + opening.high) / 2)
    yaw = math.atan2(by - ay, bx - ax)
    return Panel(opening.id, "pane" if window else "door", centre, half, yaw, colors.PANE if window else colors.DOOR)
