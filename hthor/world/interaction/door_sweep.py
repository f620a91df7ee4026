"""The space that a door or drawer sweeps on its whole way between closed and open."""

import math
from collections.abc import Iterator, Sequence

from hthor.geometry import plane
from hthor.houses.space import solids
from hthor.houses.space.obstacles import STEP_M
from hthor.houses.space.solids import Slab
from hthor.types import Joint, Part, Thing, Vec3
from hthor.world.state.body_state import BodyState
from hthor.world.state.movable_object import MovableObject
from hthor.world.state.overlap_test import OVERLAP_M

_ARC_M = 0.03
"""[m] How far the rim of a door turns between two of the boxes that stand for its sweep; less than a leaf is thick."""


class DoorSweep:
    """The boxes that all moving parts of a thing, or of a doorway, occupy somewhere on their way."""

    def __init__(self, thing: Thing, parts: Sequence[Part], joints: Sequence[Joint]) -> None:
        by_name = {joint.name: joint for joint in joints}
        self._slabs = [slab for part in parts for slab in _swept(thing, part, by_name[part.moves])]
        self._spans = [math.hypot(*slab.size) / 2 for slab in self._slabs]

    def hits_body(self, seat: BodyState) -> bool:
        """Whether a body stands in the way."""
        place, radius = (seat.pose.x, seat.pose.y), seat.spec.radius
        return any(
            slab.low < seat.spec.height
            and slab.high > STEP_M
            and math.dist(slab.centre, place) < radius + span
            and plane.distance_to_rectangle(place, slab.centre, slab.size, slab.yaw) < radius - OVERLAP_M
            for slab, span in zip(self._slabs, self._spans, strict=True)
        )

    def hits(self, item: MovableObject) -> bool:
        """Whether an object is in the way."""
        x, y, z = item.position
        w, d, h = item.size
        reach = math.hypot(w, d) / 2
        body = Slab((x, y), (w, d), item.yaw, z - h / 2 + OVERLAP_M, z + h / 2)
        return any(
            math.dist(slab.centre, body.centre) < reach + span and solids.overlap_depth(slab, body) > OVERLAP_M
            for slab, span in zip(self._slabs, self._spans, strict=True)
        )


def _swept(thing: Thing, part: Part, joint: Joint) -> Iterator[Slab]:
    """Upright boxes around one part: around its whole way if it slides, else around it at angles close together."""
    if joint.kind == "slide":
        way = (joint.axis[0] * joint.travel, joint.axis[1] * joint.travel)
        x, y, z = part.centre
        half = (part.half[0] + abs(way[0]) / 2, part.half[1] + abs(way[1]) / 2, part.half[2])
        yield _slab(thing, (x + way[0] / 2, y + way[1] / 2, z), half, 0.0)
        return
    arm = [at - anchor for at, anchor in zip(part.centre, joint.anchor, strict=True)]
    across = [axis for axis in (0, 1, 2) if not joint.axis[axis]]
    rim = math.hypot(*(abs(arm[axis]) + part.half[axis] for axis in across))
    count = max(1, math.ceil(rim * joint.travel / _ARC_M))
    for number in range(count + 1):
        yield _turned(thing, part, joint, arm, joint.travel * number / count)


def _turned(thing: Thing, part: Part, joint: Joint, arm: Sequence[float], angle: float) -> Slab:
    """An upright box around a part that is turned by ``angle`` [rad] about a vertical axis, or one along x."""
    x, y, z = arm
    ax, _, az = joint.axis
    if az:
        x, y = plane.turn((x, y), az * angle)
        yaw, half = az * angle, part.half
    else:
        y, z = plane.turn((y, z), ax * angle)
        cos, sin = abs(math.cos(angle)), abs(math.sin(angle))
        a, b, c = part.half
        yaw, half = 0.0, (a, cos * b + sin * c, sin * b + cos * c)
    px, py, pz = joint.anchor
    return _slab(thing, (px + x, py + y, pz + z), half, yaw)


def _slab(thing: Thing, centre: Vec3, half: Vec3, yaw: float) -> Slab:
    x, y, z = plane.to_house(centre, thing.centre, thing.yaw)
    return Slab((x, y), (2 * half[0], 2 * half[1]), thing.yaw + yaw, z - half[2], z + half[2])
