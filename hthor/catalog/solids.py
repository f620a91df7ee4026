"""Measuring out parts and surfaces from a thing's left, back, bottom corner.

Every function takes the thing's ``size`` (width, depth, height) [m] and corners ``lo`` and ``hi`` [m] in a frame whose
origin is the left back bottom corner of the bounding box, and returns records in the thing's local frame.
"""

from typing import Literal

from hthor.types import Part, Rgba, Surface, Vec2, Vec3

OPEN_M = 1.0
"""Clearance [m] given for a surface with nothing of the thing's own above it."""
_ROUND_M = 1e-6


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
    """The roundest primitive that fills the corners exactly: a sphere, else an upright cylinder, else a box."""
    half = _half(lo, hi)
    shape: Literal["box", "cylinder", "sphere"] = "box"
    if abs(half[0] - half[1]) < _ROUND_M:
        shape = "sphere" if abs(half[0] - half[2]) < _ROUND_M else "cylinder"
    return Part(shape=shape, centre=_centre(size, lo, hi), half=half, rgba=rgba)


def pillar(size: Vec3, at: Vec2, radius: float, low: float, high: float, rgba: Rgba) -> Part:
    """An upright cylinder around ``at``, from height ``low`` to ``high``."""
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
    """A resting place at ``height``."""
    corner, far = (lo[0], lo[1], height), (hi[0], hi[1], height)
    half = _half(corner, far)
    centre = _centre(size, corner, far)
    width = (half[0], half[1])
    return Surface(name=name, centre=centre, half=width, clearance=clearance, inside=inside, moves=moves)
