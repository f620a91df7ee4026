"""Builders of parts and surfaces, which are measured from a thing's left back bottom corner.

Every function takes the thing's ``size`` (width, depth, height) [m] and corners ``lo`` and ``hi`` [m] in a frame whose
origin is the left back bottom corner of the bounding box, and returns records in the thing's local frame. A
shell, for things that open, is open in front.
"""

import math
from typing import Literal

from hthor.types import Joint, Part, Rgba, Surface, Vec2, Vec3

OPEN_M = 1.0
"""[m] The clearance given for a surface that has no part of the same thing above it."""
_ROUND_M = 1e-6
SWING_RAD = math.radians(100.0)
"""[rad] How far a door turns."""
FLAP_RAD = math.radians(85.0)
"""[rad] How far a flap that is hinged at its lower edge turns."""
PULL = 0.85
"""Share of its depth by which an open drawer is pulled out."""


def _centre(size: Vec3, lo: Vec3, hi: Vec3) -> Vec3:
    x, y, z = ((a + b - s) / 2 for a, b, s in zip(lo, hi, size, strict=True))
    return (x, y, z)


def _half(lo: Vec3, hi: Vec3) -> Vec3:
    x, y, z = ((b - a) / 2 for a, b in zip(lo, hi, strict=True))
    return (x, y, z)


def box(size: Vec3, lo: Vec3, hi: Vec3, rgba: Rgba, *, moves: str = "") -> Part:
    """A box from corner to corner."""
    return Part(shape="box", centre=_centre(size, lo, hi), half=_half(lo, hi), rgba=rgba, moves=moves)


def rounded(size: Vec3, lo: Vec3, hi: Vec3, rgba: Rgba) -> Part:
    """The roundest primitive with exactly these corners: a sphere, else an upright cylinder, else a box."""
    half = _half(lo, hi)
    shape: Literal["box", "cylinder", "sphere"] = "box"
    if abs(half[0] - half[1]) < _ROUND_M:
        shape = "sphere" if abs(half[0] - half[2]) < _ROUND_M else "cylinder"
    return Part(shape=shape, centre=_centre(size, lo, hi), half=half, rgba=rgba)


def pillar(size: Vec3, at: Vec2, radius: float, low: float, high: float, rgba: Rgba) -> Part:
    """An upright cylinder around ``at`` [m], from height ``low`` to ``high`` [m]."""
    lo, hi = (at[0] - radius, at[1] - radius, low), (at[0] + radius, at[1] + radius, high)
    return Part(shape="cylinder", centre=_centre(size, lo, hi), half=_half(lo, hi), rgba=rgba)


def rest(
    size: Vec3,
    name: str,
    lo: Vec2,
    hi: Vec2,
    height: float,
    clearance: float = OPEN_M,
    *,
    inside: bool = False,
    moves: str = "",
) -> Surface:
    """A surface at ``height`` [m] where objects can rest."""
    corner, far = (lo[0], lo[1], height), (hi[0], hi[1], height)
    half = _half(corner, far)
    centre = _centre(size, corner, far)
    width = (half[0], half[1])
    return Surface(name=name, centre=centre, half=width, clearance=clearance, inside=inside, moves=moves)


def rest_on_top(size: Vec3) -> Surface:
    """The surface of the thing's top, slightly smaller than the top on every side."""
    w, d, h = size
    e = min(0.02, 0.05 * w, 0.05 * d)
    return rest(size, "top", (e, e), (w - e, d - e), h)


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
    """The floor of the space from ``lo`` to ``hi``, slightly reduced on every side, with the space above it."""
    e = min(0.01, 0.05 * (hi[0] - lo[0]), 0.05 * (hi[1] - lo[1]))
    corner, far = (lo[0] + e, lo[1] + e), (hi[0] - e, hi[1] - e)
    return rest(size, name, corner, far, lo[2], hi[2] - lo[2], inside=True, moves=moves)


def hinge(size: Vec3, name: str, x: float, y: float, *, left: bool) -> Joint:
    """An upright hinge at (``x``, ``y``) [m]: at the left edge of its door if ``left``, else at the right edge."""
    anchor = (x - size[0] / 2, y - size[1] / 2, 0.0)
    return Joint(name=name, kind="hinge", anchor=anchor, axis=(0.0, 0.0, 1.0 if left else -1.0), travel=SWING_RAD)


def flap(size: Vec3, name: str, y: float, z: float) -> Joint:
    """A hinge along the lower edge of a flap, which opens downwards to the front."""
    anchor = (0.0, y - size[1] / 2, z - size[2] / 2)
    return Joint(name=name, kind="hinge", anchor=anchor, axis=(-1.0, 0.0, 0.0), travel=FLAP_RAD)


def slide(name: str, travel: float) -> Joint:
    """The joint of a drawer, which slides out to the front."""
    return Joint(name=name, kind="slide", anchor=(0.0, 0.0, 0.0), axis=(0.0, 1.0, 0.0), travel=travel)


def tray(size: Vec3, name: str, lo: Vec3, hi: Vec3, wall: float, rgba: Rgba) -> tuple[Part, ...]:
    """An open box from ``lo`` to ``hi`` that moves with a joint: a floor and four walls, the rear wall first."""
    (x0, y0, z0), (x1, y1, z1) = lo, hi
    return (
        box(size, (x0, y0, z0), (x1, y0 + wall, z1), rgba, moves=name),
        box(size, (x0, y0 + wall, z0), (x0 + wall, y1 - wall, z1), rgba, moves=name),
        box(size, (x1 - wall, y0 + wall, z0), (x1, y1 - wall, z1), rgba, moves=name),
        box(size, (x0 + wall, y0 + wall, z0), (x1 - wall, y1 - wall, z0 + wall), rgba, moves=name),
        box(size, (x0, y1 - wall, z0), (x1, y1, z1), rgba, moves=name),
    )
