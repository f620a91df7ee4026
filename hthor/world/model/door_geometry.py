"""The geometry of everything that opens: doors and drawers of furniture, and doors in doorways."""

import math

from msgspec import Struct

from hthor import catalog
from hthor.catalog.colors import STEEL
from hthor.geometry import plane
from hthor.types import HouseSpec, Joint, Opening, Part, Rgba, Thing, Vec3

LEAF_M = 0.04
"""[m] Thickness of a door."""
GAP_M = 0.02
"""[m] Gap for the frame between a door and the wall, at the sides and the top."""
DOUBLE_M = 1.3
"""[m] Doorways wider than this have two doors."""
TURN_RAD = math.pi / 2
"""[rad] How far doors open."""
_LEAF: Rgba = (0.88, 0.87, 0.85, 1.0)
_SOLE_M = 0.008
"""[m] Gap below a door."""
_HANDLE_M = 1.02
"""[m] Height of a door handle."""


class Openable(Struct, frozen=True, kw_only=True):
    """A thing that opens: its moving ``parts`` and their ``joints``, closed, in the frame of ``thing``.

    ``opening`` is the doorway of a door in a doorway, else None; such doors stand open when an episode begins.
    """

    thing: Thing
    parts: tuple[Part, ...]
    joints: tuple[Joint, ...]
    opening: Opening | None = None

    @property
    def id(self) -> str:
        """The thing's id; for a door in a doorway, the doorway's id."""
        return self.thing.id


def openable_thing(thing: Thing) -> Openable:
    """The moving parts of a piece of furniture.

    Raises:
        ValueError: when the furniture does not open.
    """
    kind = catalog.kind(thing.kind)
    joints = kind.joints(thing.size)
    if not joints:
        raise ValueError(f"'{thing.id}' of kind '{thing.kind}' does not open")
    parts = tuple(part for part in kind.parts(thing.size, thing.variant) if part.moves)
    return Openable(thing=thing, parts=parts, joints=joints)


def doorway_leaves(house: HouseSpec) -> tuple[Openable, ...]:
    """The doors of all doorways that have any, in the order of the openings."""
    return tuple(_hung(house, opening) for opening in house.openings if opening.openable and opening.passable)


def _hung(house: HouseSpec, opening: Opening) -> Openable:
    """One door hinged at the opening's end ``a``, or two doors; they turn into its first room.

    The local frame has x from ``a`` to ``b`` and its origin in the middle of the hole.
    """
    (ax, ay), (bx, by) = opening.a, opening.b
    yaw, width = math.atan2(by - ay, bx - ax), math.dist(opening.a, opening.b)
    centre = ((ax + bx) / 2, (ay + by) / 2, (opening.low + opening.high) / 2)
    thing = Thing(
        id=opening.id,
        kind="door",
        asset=opening.asset,
        centre=centre,
        size=(width, LEAF_M, opening.high - opening.low),
        yaw=yaw,
    )
    side, edge = _side(house, opening, centre, yaw), width / 2 - GAP_M
    if width <= DOUBLE_M:
        spans: tuple[tuple[str, float, float], ...] = (("door", -edge, edge),)
    else:
        spans = (("left door", -edge, -0.002), ("right door", edge, 0.002))
    parts = tuple(part for name, hinge, rim in spans for part in _leaf(thing, name, hinge, rim))
    joints = tuple(_hinge(name, hinge, rim, side) for name, hinge, rim in spans)
    return Openable(thing=thing, parts=parts, joints=joints, opening=opening)


def _side(house: HouseSpec, opening: Opening, centre: Vec3, yaw: float) -> float:
    """The side of the wall on which the first room is: +1 left of the line from a to b, -1 right of it."""
    polygon = next((room.polygon for room in house.rooms if room.id == opening.rooms[0]), ())
    x, y = plane.turn((0.0, 0.25), yaw)
    return 1.0 if polygon and plane.inside((centre[0] + x, centre[1] + y), polygon) else -1.0


def _leaf(thing: Thing, name: str, hinge: float, rim: float) -> tuple[Part, Part]:
    low, high = -thing.size[2] / 2 + _SOLE_M, thing.size[2] / 2 - GAP_M
    centre, half = ((hinge + rim) / 2, 0.0, (low + high) / 2), (abs(rim - hinge) / 2, LEAF_M / 2, (high - low) / 2)
    grip = rim + math.copysign(0.09, hinge - rim)
    handle = (grip, 0.0, min(_HANDLE_M - thing.size[2] / 2, 0.0))
    return (
        Part(shape="box", centre=centre, half=half, rgba=_LEAF, moves=name),
        Part(shape="box", centre=handle, half=(0.06, LEAF_M / 2 + 0.045, 0.012), rgba=STEEL, moves=name),
    )


def _hinge(name: str, hinge: float, rim: float, side: float) -> Joint:
    turning = side * math.copysign(1.0, rim - hinge)
    anchor = (hinge, side * LEAF_M / 2, 0.0)
    return Joint(name=name, kind="hinge", anchor=anchor, axis=(0.0, 0.0, turning), travel=TURN_RAD)
