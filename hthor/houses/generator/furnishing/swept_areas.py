"""The room that doors and drawers of a thing take while they open, in its own frame."""

import math
from functools import lru_cache

from hthor import catalog
from hthor.houses.generator.furnishing.pieces import Piece
from hthor.houses.space import boxes
from hthor.types import Thing, Vec3

_STEPS = 6
Box = tuple[float, float, float, float, float, float]
"""x0, y0, x1, y1, z0, z1 [m]."""


@lru_cache(maxsize=512)
def swept_boxes(kind: str, size: Vec3) -> tuple[Box, ...]:
    """For each door or drawer, the box around all its places, from the thing's middle on the plan and the floor up."""
    row = catalog.kind(kind)
    if not row.joints(size):
        return ()
    thing = Thing(id=kind, kind=kind, asset="", centre=(0.0, 0.0, size[2] / 2), size=size, yaw=0.0)
    found: dict[str, Box] = {}
    for step in range(1, _STEPS + 1):
        for part, box in boxes.boxes_of(thing, step / _STEPS):
            if part.moves:
                slab = boxes.bounding_slab(box)
                cos, sin = abs(math.cos(slab.yaw)), abs(math.sin(slab.yaw))
                hx = (cos * slab.size[0] + sin * slab.size[1]) / 2
                hy = (sin * slab.size[0] + cos * slab.size[1]) / 2
                x, y = slab.centre
                new = (x - hx, y - hy, x + hx, y + hy, slab.low, slab.high)
                old = found.get(part.moves, new)
                found[part.moves] = (
                    min(old[0], new[0]),
                    min(old[1], new[1]),
                    max(old[2], new[2]),
                    max(old[3], new[3]),
                    min(old[4], new[4]),
                    max(old[5], new[5]),
                )
    return tuple(found.values())


def swept_boxes_of_piece(piece: Piece) -> list[Box]:
    """The same for a piece where it stands; its yaw must be whole quarter turns."""
    cos, sin = round(math.cos(piece.yaw)), round(math.sin(piece.yaw))
    placed = []
    for x0, y0, x1, y1, z0, z1 in swept_boxes(piece.kind, piece.size):
        xs = (cos * x0 - sin * y0, cos * x1 - sin * y1, cos * x0 - sin * y1, cos * x1 - sin * y0)
        ys = (sin * x0 + cos * y0, sin * x1 + cos * y1, sin * x0 + cos * y1, sin * x1 + cos * y0)
        x, y = piece.middle
        placed.append((x + min(xs), y + min(ys), x + max(xs), y + max(ys), piece.bottom + z0, piece.bottom + z1))
    return placed
