"""Solid parts of a house's things as turned boxes, with doors closed or open.

A cylinder or a sphere counts as the box around it.
"""

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hthor import catalog
from hthor.geometry import plane
from hthor.houses.space.solids import Slab
from hthor.types import Joint, Part, Surface, Thing, Vec3

Floats = NDArray[np.float64]


class Box(NamedTuple):
    """A box in the house frame: ``centre`` and half extents ``half`` [m], ``turn`` (3, 3) from box to house."""

    centre: Vec3
    half: Vec3
    turn: Floats


def boxes_of(thing: Thing, share: float = 0.0) -> Iterator[tuple[Part, Box]]:
    """Every part of a thing with its box, its doors and drawers ``share`` of the way open, 0 to 1."""
    kind = catalog.kind(thing.kind)
    return posed_boxes(kind.parts(thing.size, thing.variant), kind.joints(thing.size), thing, share)


def posed_boxes(
    parts: Iterable[Part], joints: Iterable[Joint], thing: Thing, share: float
) -> Iterator[tuple[Part, Box]]:
    """Every part with its box, given in the frame of ``thing``, the joints ``share`` of the way open, 0 to 1."""
    named = {joint.name: joint for joint in joints}
    house = rotation((0.0, 0.0, 1.0), thing.yaw)
    for part in parts:
        centre, turn = part.centre, house
        if part.moves and share > 0.0:
            centre, inner = joint_motion(named[part.moves], part.centre, share)
            turn = house @ inner
        yield part, Box(plane.to_house(centre, thing.centre, thing.yaw), part.half, turn)


def joint_motion(joint: Joint, point: Vec3, share: float) -> tuple[Vec3, Floats]:
    """Where a joint, open by ``share``, moves a point of the local frame, and the rotation (3, 3) there."""
    if joint.kind == "slide":
        x, y, z = (p + a * joint.travel * share for p, a in zip(point, joint.axis, strict=True))
        return (x, y, z), np.eye(3)
    turn = rotation(joint.axis, joint.travel * share)
    x, y, z = (float(v) for v in np.array(joint.anchor) + turn @ (np.array(point) - np.array(joint.anchor)))
    return (x, y, z), turn


def rotation(axis: Vec3, angle: float) -> Floats:
    """(3, 3) the turn by ``angle`` [rad] about a unit vector, right-handed."""
    x, y, z = axis
    cos, sin = math.cos(angle), math.sin(angle)
    cross = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
    outer = np.outer(axis, axis)
    turn: Floats = cos * np.eye(3) + sin * cross + (1.0 - cos) * outer
    return turn


def bounding_slab(box: Box) -> Slab:
    """The upright box around a box: exact for a box that is turned only about z."""
    upright = abs(abs(box.turn[2, 2]) - 1.0) < 1e-12
    if upright:
        yaw = math.atan2(box.turn[1, 0], box.turn[0, 0])
        size = (2 * box.half[0], 2 * box.half[1])
        return Slab(box.centre[:2], size, yaw, box.centre[2] - box.half[2], box.centre[2] + box.half[2])
    # Tilted, like an oven's door: turned about a level axis, so one edge of the box is still level.
    level = min(range(3), key=lambda axis: abs(box.turn[2, axis]))
    yaw = math.atan2(box.turn[1, level], box.turn[0, level])
    frame = rotation((0.0, 0.0, 1.0), yaw).T @ box.turn
    x, y, z = (float(v) for v in np.abs(frame) @ np.array(box.half))
    return Slab(box.centre[:2], (2 * x, 2 * y), yaw, box.centre[2] - z, box.centre[2] + z)


def surface_below(thing: Thing, support: Thing) -> tuple[Surface, float] | None:
    """The surface of ``support`` that is nearest below or above the thing's underside, and the gap [m] between them.

    Positive when the thing is above the surface; None when its middle is over no surface.
    """
    bottom = (thing.centre[0], thing.centre[1], thing.centre[2] - thing.size[2] / 2)
    x, y, z = plane.to_local(bottom, support.centre, support.yaw)
    best: tuple[Surface, float] | None = None
    for surface in catalog.kind(support.kind).surfaces(support.size):
        if all(abs(p - c) <= h for p, c, h in zip((x, y), surface.centre[:2], surface.half, strict=True)):
            gap = z - surface.centre[2]
            if best is None or abs(gap) < abs(best[1]):
                best = surface, gap
    return best
