"""Records of things to be placed and of groups of them, and the space that a thing's doors and drawers need.

A group's frame: origin in the middle of its back edge, x to its right for somebody in it, y to the front.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import msgspec
from msgspec import Struct

from hthor import catalog
from hthor.catalog.kind import Kind
from hthor.geometry.plane import turn
from hthor.houses.space import boxes
from hthor.types import Thing, Vec2, Vec3

Rect = tuple[float, float, float, float]
"""x0, y0, x1, y1 [m]."""
_STEPS = 6
Box = tuple[float, float, float, float, float, float]
"""x0, y0, x1, y1, z0, z1 [m]."""


class Piece(Struct, frozen=True, kw_only=True):
    """A thing with its ``middle`` [m] on the plan, the height of its ``bottom`` [m], and its ``yaw`` [rad].

    ``asset`` is its id in the house file. ``within`` names the surface of its parent that it rests on.
    """

    kind: str
    asset: str
    size: Vec3
    middle: Vec2 = (0.0, 0.0)
    bottom: float = 0.0
    yaw: float = 0.0
    children: tuple[Piece, ...] = ()

    @property
    def sort(self) -> Kind:
        """Its row of the catalogue."""
        return catalog.kind(self.kind)

    @property
    def top(self) -> float:
        """[m]"""
        return self.bottom + self.size[2]

    @property
    def rect(self) -> Rect:
        """The axis-parallel rectangle around its footprint."""
        return _rect(self.middle, self.size, self.yaw)


class PieceGroup(Struct, frozen=True, kw_only=True):
    """Things that are placed together.

    ``free`` are rectangles in front of and next to them that must stay free of furniture but may be shared; ``backs``
    are rectangles that a wall must pass through. ``anchors`` are the ways to place the group, best first: "corner"
    (either side against a wall), "left" or "right" corner, "wall", "middle". A body must be able to come to each of the
    first ``serve`` free rectangles.
    """

    name: str
    pieces: tuple[Piece, ...]
    free: tuple[Rect, ...] = ()
    backs: tuple[Rect, ...] = ()
    anchors: tuple[str, ...] = ("wall",)
    serve: int = 1

    @property
    def extent(self) -> Rect:
        """The rectangle around all pieces."""
        x0s, y0s, x1s, y1s = zip(*(piece.rect for piece in self.pieces), strict=True)
        return (min(x0s), min(y0s), max(x1s), max(y1s))


def move_piece(piece: Piece, origin: Vec2, yaw: float) -> Piece:
    """The piece of a group whose frame stands at ``origin`` [m], turned by ``yaw``."""
    x, y = turn(piece.middle, yaw)
    middle = (round(origin[0] + x, 4), round(origin[1] + y, 4))
    return msgspec.structs.replace(piece, middle=middle, yaw=piece.yaw + yaw)


@lru_cache(maxsize=512)
def swept_boxes(kind: str, size: Vec3) -> tuple[Box, ...]:
    """For each door or drawer, the box around all its positions; origin at the middle of the thing's bottom."""
    row = catalog.kind(kind)
    if not row.joints(size):
        return ()
    thing = Thing(id=kind, kind=kind, asset="", centre=(0.0, 0.0, size[2] / 2), size=size, yaw=0.0)
    places: dict[str, list[Box]] = {}
    for step in range(1, _STEPS + 1):
        for part, box in boxes.boxes_of(thing, step / _STEPS):
            if part.moves:
                slab = boxes.bounding_slab(box)
                rect = _rect(slab.centre, slab.size, slab.yaw)
                places.setdefault(part.moves, []).append((*rect, slab.low, slab.high))
    columns = [tuple(zip(*rows, strict=True)) for rows in places.values()]
    return tuple((min(a), min(b), max(c), max(d), min(low), max(high)) for a, b, c, d, low, high in columns)


def _rect(centre: Vec2, size: Sequence[float], yaw: float) -> Rect:
    """The axis-parallel rectangle around a rectangle that is turned by ``yaw``."""
    cos, sin = abs(math.cos(yaw)), abs(math.sin(yaw))
    hx, hy = (cos * size[0] + sin * size[1]) / 2, (sin * size[0] + cos * size[1]) / 2
    return (centre[0] - hx, centre[1] - hy, centre[0] + hx, centre[1] + hy)


def swept_boxes_of_piece(piece: Piece) -> list[Box]:
    """`swept_boxes` for a piece where it stands; its yaw must be whole quarter turns."""
    cos, sin = round(math.cos(piece.yaw)), round(math.sin(piece.yaw))
    placed = []
    for x0, y0, x1, y1, z0, z1 in swept_boxes(piece.kind, piece.size):
        xs = (cos * x0 - sin * y0, cos * x1 - sin * y1, cos * x0 - sin * y1, cos * x1 - sin * y0)
        ys = (sin * x0 + cos * y0, sin * x1 + cos * y1, sin * x0 + cos * y1, sin * x1 + cos * y0)
        x, y = piece.middle
        placed.append((x + min(xs), y + min(ys), x + max(xs), y + max(ys), piece.bottom + z0, piece.bottom + z1))
    return placed
