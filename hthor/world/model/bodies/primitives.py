"""Builders of the solids of bodies, in the body frame.

The body frame has x ahead, y left, z up, and its origin on the floor below the axis. ``moves`` is "head" for a solid
that turns with the camera, else empty.
"""

from typing import Literal

from hthor.types import Part, Rgba, Vec3

HEAD = "head"
"""The value of ``moves`` of a solid that tilts with the camera."""


def box(centre: Vec3, half: Vec3, rgba: Rgba, moves: str = "") -> Part:
    """A box, ``half`` [m] its half extents."""
    return Part(shape="box", centre=centre, half=half, rgba=rgba, moves=moves)


def ball(centre: Vec3, radius: float, rgba: Rgba, moves: str = "") -> Part:
    """A sphere."""
    return Part(shape="sphere", centre=centre, half=(radius, radius, radius), rgba=rgba, moves=moves)


def post(centre: Vec3, radius: float, half_length: float, rgba: Rgba, moves: str = "") -> Part:
    """An upright cylinder."""
    return _cylinder("z", centre, (radius, radius, half_length), rgba, moves)


def wheel(centre: Vec3, radius: float, half_width: float, rgba: Rgba, moves: str = "") -> Part:
    """A cylinder whose axis points left, as a wheel's does."""
    return _cylinder("y", centre, (radius, half_width, radius), rgba, moves)


def rod(centre: Vec3, radius: float, half_length: float, rgba: Rgba, moves: str = "") -> Part:
    """A cylinder that points ahead, such as an arm or a lens."""
    return _cylinder("x", centre, (half_length, radius, radius), rgba, moves)


def _cylinder(axis: Literal["x", "y", "z"], centre: Vec3, half: Vec3, rgba: Rgba, moves: str) -> Part:
    return Part(shape="cylinder", centre=centre, half=half, rgba=rgba, axis=axis, moves=moves)
