"""Makes the engine's geoms from parts: shapes, colours, collision bits and draw groups."""

import math
from typing import Any

from hthor.geometry.plane import to_house
from hthor.types import Part, Vec3

Bits = dict[str, Any]

Quaternion = tuple[float, float, float, float]
"""A unit quaternion (w, x, y, z)."""
_HALF = math.sqrt(0.5)
_AXES: dict[str, Quaternion] = {
    "x": (_HALF, 0.0, _HALF, 0.0),
    "y": (_HALF, -_HALF, 0.0, 0.0),
    "z": (1.0, 0.0, 0.0, 0.0),
}
"""The turns that take an upright cylinder onto each axis."""

FURNITURE, WALLS, OBJECTS, BODIES, CEILINGS = range(5)
"""Draw groups. Ceilings and lintels are left out of the view from above."""

STATIC: Bits = {"contype": 1, "conaffinity": 0}
MOVABLE: Bits = {"contype": 2, "conaffinity": 3}
GHOST: Bits = {"contype": 0, "conaffinity": 0}
"""Collision bits: movable things collide with each other and static things; ghosts, such as bodies, with nothing."""
LEAF: Bits = {"contype": 5, "conaffinity": 0}
"""A door. Closed, it collides as static things do; moving or open (`SWUNG`), with nothing, but it hides things."""
SHUT, SWUNG = 1, 4


def quaternion(yaw: float) -> Quaternion:
    """The turn by ``yaw`` [rad] about z, as (w, x, y, z)."""
    return (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """The turn ``b`` followed by the turn ``a``."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def size(part: Part) -> tuple[float, ...]:
    """A part's half extents in MuJoCo's convention for its shape."""
    if part.shape == "sphere":
        return (part.half[0],)
    if part.shape == "cylinder":
        along = "xyz".index(part.axis)
        return (part.half[along - 1], part.half[along])
    return part.half


def volume(part: Part) -> float:
    """Volume of a part [m3]."""
    x, y, z = part.half
    return {"box": 8.0, "cylinder": 2.0 * math.pi, "sphere": 4.0 / 3.0 * math.pi}[part.shape] * x * y * z


def orientation(part: Part, yaw: float) -> Quaternion:
    """The turn of a part of a thing turned by ``yaw`` [rad]; without any turn, MuJoCo's cylinders stand upright."""
    return multiply(quaternion(yaw), _AXES[part.axis]) if part.shape == "cylinder" else quaternion(yaw)


def add_part(body: Any, name: str, part: Part, centre: Vec3 = (0.0, 0.0, 0.0), yaw: float = 0.0, **more: Any) -> Any:
    """Add to ``body`` a part of a thing that stands at ``centre`` [m], turned by ``yaw`` [rad], in the body's frame."""
    return body.add(
        "geom",
        name=name,
        type=part.shape,
        size=size(part),
        pos=to_house(part.centre, centre, yaw),
        quat=orientation(part, yaw),
        rgba=part.rgba,
        **more,
    )


def add_box(body: Any, name: str, centre: Vec3, half: Vec3, yaw: float, **more: Any) -> Any:
    """Add a box that stands upright."""
    return body.add("geom", name=name, type="box", size=half, pos=centre, quat=quaternion(yaw), **more)
