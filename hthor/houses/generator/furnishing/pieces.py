"""Things to be placed and groups of them, as records.

A group's frame: origin in the middle of its back edge, x to its right seen from inside it, y to the front.
"""

from __future__ import annotations

import math

from msgspec import Struct

from hthor import catalog
from hthor.catalog.kind import Kind
from hthor.geometry.plane import turn
from hthor.types import Vec2, Vec3

Rect = tuple[float, float, float, float]
"""x0, y0, x1, y1 [m]."""


class Piece(Struct, frozen=True, kw_only=True):
    """A thing with its ``middle`` [m] on the plan, the height of its ``bottom``, and its ``yaw`` [rad].

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
        """The upright rectangle about its footprint."""
        cos, sin = abs(math.cos(self.yaw)), abs(math.sin(self.yaw))
        hx = (cos * self.size[0] + sin * self.size[1]) / 2
        hy = (sin * self.size[0] + cos * self.size[1]) / 2
        return (self.middle[0] - hx, self.middle[1] - hy, self.middle[0] + hx, self.middle[1] + hy)


class PieceGroup(Struct, frozen=True, kw_only=True):
    """Things that are placed together.

    ``free`` are rectangles before and beside them that must stay free of furniture but may be shared; ``backs`` are
    rectangles that a wall must pass through. ``anchors`` are the ways to place it, best first: "corner" (either side
    against a wall), "left" or "right" corner, "wall", "middle". One must be able to come to each
    of the first ``serve`` free rectangles.
    """

    name: str
    pieces: tuple[Piece, ...]
    free: tuple[Rect, ...] = ()
    backs: tuple[Rect, ...] = ()
    anchors: tuple[str, ...] = ("wall",)
    serve: int = 1

    @property
    def extent(self) -> Rect:
        """The rectangle about all pieces."""
        rects = [piece.rect for piece in self.pieces]
        x0s, y0s, x1s, y1s = zip(*rects, strict=True)
        return (min(x0s), min(y0s), max(x1s), max(y1s))


def move_piece(piece: Piece, origin: Vec2, yaw: float) -> Piece:
    """The piece of a group whose frame stands at ``origin`` [m], turned by ``yaw``."""
    x, y = turn(piece.middle, yaw)
    return Piece(
        kind=piece.kind,
        asset=piece.asset,
        size=piece.size,
        middle=(round(origin[0] + x, 4), round(origin[1] + y, 4)),
        bottom=piece.bottom,
        yaw=piece.yaw + yaw,
        children=piece.children,
    )
