"""Shells, doors and drawers for things that open, measured from a thing's left, back, bottom corner. ``size``, ``lo``
and ``hi`` are as in ``solids``; a shell is open in front.
"""

import math

from hthor.catalog.solids import box, rest
from hthor.types import Joint, Part, Rgba, Surface, Vec3

SWING_RAD = math.radians(100.0)
"""How far a door turns."""
FLAP_RAD = math.radians(85.0)
"""How far a flap that is hinged at its lower edge falls."""
PULL = 0.85
"""Share of its depth that a drawer is pulled out."""


def shell(size: Vec3, lo: Vec3, hi: Vec3, wall: float, rgba: Rgba, inner: Rgba) -> tuple[Part, ...]:
    """Two sides, a back, a floor and a ceiling, each ``wall`` thick, around an empty space that is open in front."""
    (x0, y0, z0), (x1, y1, z1) = lo, hi
    return (
        box(size, (x0, y0, z0), (x0 + wall, y1, z1), rgba),
        box(size, (x1 - wall, y0, z0), (x1, y1, z1), rgba),
        box(size, (x0 + wall, y0, z0), (x1 - wall, y0 + wall, z1), inner),
        box(size, (x0 + wall, y0 + wall, z0), (x1 - wall, y1, z0 + wall), inner),
        box(size, (x0 + wall, y0 + wall, z1 - wall), (x1 - wall, y1, z1), rgba),
    )


def inside(size: Vec3, name: str, lo: Vec3, hi: Vec3, *, moves: str = "") -> Surface:
    """The floor of the space from ``lo`` to ``hi``, drawn in by a little on every side; its height is the clearance."""
    e = min(0.01, 0.05 * (hi[0] - lo[0]), 0.05 * (hi[1] - lo[1]))
    corner, far = (lo[0] + e, lo[1] + e), (hi[0] - e, hi[1] - e)
    return rest(size, name, corner, far, lo[2], hi[2] - lo[2], inside=True, moves=moves)


def hinge(size: Vec3, name: str, x: float, y: float, *, left: bool) -> Joint:
    """An upright hinge at ``x``, ``y``: of a door that reaches to the right of it when ``left``, else to the left."""
    anchor = (x - size[0] / 2, y - size[1] / 2, 0.0)
    return Joint(name=name, kind="hinge", anchor=anchor, axis=(0.0, 0.0, 1.0 if left else -1.0), travel=SWING_RAD)


def flap(size: Vec3, name: str, y: float, z: float) -> Joint:
    """A hinge along the lower edge of a flap, which falls open to the front."""
    anchor = (0.0, y - size[1] / 2, z - size[2] / 2)
    return Joint(name=name, kind="hinge", anchor=anchor, axis=(-1.0, 0.0, 0.0), travel=FLAP_RAD)


def slide(name: str, travel: float) -> Joint:
    """A drawer's way out to the front."""
    return Joint(name=name, kind="slide", anchor=(0.0, 0.0, 0.0), axis=(0.0, 1.0, 0.0), travel=travel)


def tray(size: Vec3, name: str, lo: Vec3, hi: Vec3, wall: float, rgba: Rgba) -> tuple[Part, ...]:
    """An open box from ``lo`` to ``hi`` with a floor and four walls, the hindmost first, that moves with a joint."""
    (x0, y0, z0), (x1, y1, z1) = lo, hi
    return (
        box(size, (x0, y0, z0), (x1, y0 + wall, z1), rgba, moves=name),
        box(size, (x0, y0 + wall, z0), (x0 + wall, y1 - wall, z1), rgba, moves=name),
        box(size, (x1 - wall, y0 + wall, z0), (x1, y1 - wall, z1), rgba, moves=name),
        box(size, (x0 + wall, y0 + wall, z0), (x1 - wall, y1 - wall, z0 + wall), rgba, moves=name),
        box(size, (x0, y1 - wall, z0), (x1, y1, z1), rgba, moves=name),
    )
