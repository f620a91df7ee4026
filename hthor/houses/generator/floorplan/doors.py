"""Chooses the rooms that doors join, and where doors stand and swing."""

import math
from collections.abc import Iterable, Sequence

from msgspec import Struct

from hthor.geometry.plane import inside
from hthor.houses.generator.draws import Dice
from hthor.houses.generator.floorplan.layout import OUTSIDE, FloorPlan, Seam
from hthor.houses.generator.floorplan.room_specs import (
    BATHROOM,
    BEDROOM,
    KITCHEN,
    LIVING,
    RoomGroup,
    RoomLeaf,
    iter_leaves,
)
from hthor.houses.space.solids import WALL_M
from hthor.types import Vec2

HIGH_M = 2.05
LEAF_M = (-0.03, 0.11)
"""The stretch that an open leaf and its handles take, along the wall from the opening's end with the hinge."""
_WIDTH_M, _OUTSIDE_M = 0.95, 1.0
_HINGE_M = 0.14
"""Distance from the corner of two walls' lines to the hinge of a leaf that opens along a wall."""
_JAMB_M = 0.2
_OPEN = 0.75
_STUB_M = 0.4


class Door(Struct, frozen=True):
    """An opening from ``a`` to ``b`` [m] between ``room0`` and ``room1``.

    Its ``sort`` is "leaf" (hinged at ``a``, open in room0, square to the wall), "frame" (without a leaf), "open" (no
    wall at all) or "outside" (the closed front door).
    """

    sort: str
    room0: int
    room1: int
    seam: Seam
    a: Vec2
    b: Vec2

    @property
    def width(self) -> float:
        """Width of the opening [m]."""
        return math.dist(self.a, self.b)


def choose_doors(tree: RoomGroup, plan: FloorPlan, dice: Dice) -> list[tuple[int, int]] | None:
    """Pairs of rooms to join so that all are connected; None when the walls do not allow that.

    At each level the parts are joined one by one, bathrooms last and never as a passage; a bathroom within a part
    is private to it.
    """
    found: list[tuple[int, int]] = []
    return found if _join(tree, OUTSIDE + 1, plan, dice, found) else None


def _join(tree: RoomGroup, first: int, plan: FloorPlan, dice: Dice, found: list[tuple[int, int]]) -> bool:
    starts = []
    for number, part in enumerate(tree.parts):
        starts.append(first)
        if isinstance(part, RoomGroup) and not _join(part, first, plan, dice.of("part", number), found):
            return False
        first += sum(1 for _ in iter_leaves(part))
    rooms = [_members(part, start) for part, start in zip(tree.parts, starts, strict=True)]
    baths = [isinstance(part, RoomLeaf) and part.room == BATHROOM for part in tree.parts]
    order = sorted(dice.order(range(len(rooms)), "order"), key=lambda k: baths[k])
    joined, waiting = [order[0]], order[1:]
    while waiting:
        options = [
            (one, two, new)
            for new in waiting
            for old in joined
            for one in rooms[old]
            for two in rooms[new]
            if not baths[old] and _doorways(plan, one, two)
        ]
        if any(not baths[new] for _, _, new in options):
            options = [option for option in options if not baths[option[2]]]
        if not options:
            return False
        weights = [_wish(plan, one, two) for one, two, _ in options]
        one, two, new = dice.weighted(options, weights, "join", len(waiting))
        found.append((one, two))
        joined.append(new)
        waiting.remove(new)
    return True


def _members(part: RoomLeaf | RoomGroup, start: int) -> list[int]:
    """Rooms of a part that a door to other parts may lead into."""
    if isinstance(part, RoomLeaf):
        return [start]
    return [start + k for k, leaf in enumerate(iter_leaves(part)) if leaf.room != BATHROOM]


def _doorways(plan: FloorPlan, one: int, two: int) -> list[Seam]:
    """The seams of two rooms that are long enough for a door."""
    return [seam for seam in plan.between(one, two) if seam.length >= _WIDTH_M + 2 * _JAMB_M]


def _wish(plan: FloorPlan, one: int, two: int) -> float:
    """The weight of a door between two rooms: people walk through living rooms, not from kitchen to bathroom."""
    kinds = {plan.room(one).kind, plan.room(two).kind}
    if kinds == {KITCHEN, BATHROOM}:
        return 0.05
    if LIVING in kinds:
        return 4.0
    return 1.0 if kinds in ({BEDROOM}, {BEDROOM, BATHROOM}) else 0.6


def place(pairs: list[tuple[int, int]], plan: FloorPlan, dice: Dice) -> list[Door] | None:
    """A doorway for each pair, and the front door; None when doors would collide."""
    doors: list[Door] = []
    for one, two in pairs:
        door = _inner(one, two, plan, dice.of(one, two), doors)
        if door is None:
            return None
        doors.append(door)
    front = _front(plan, dice.of("front"), doors)
    return None if front is None else [*doors, front]


def _inner(one: int, two: int, plan: FloorPlan, dice: Dice, others: list[Door]) -> Door | None:
    seams = _doorways(plan, one, two)
    seam = dice.weighted(seams, [seam.length for seam in seams], "seam")
    kinds = {plan.room(one).kind, plan.room(two).kind}
    if kinds == {KITCHEN, LIVING} and dice.chance(_OPEN, "open"):
        width = min(dice.between(1.3, 1.9, "width"), seam.length - 2 * _STUB_M)
        if dice.chance(0.5, "no wall") and seam.length >= 1.6 + 2 * _STUB_M:
            door = _at(seam, "open", one, two, _STUB_M, seam.length - 2 * _STUB_M)
        else:
            share = dice.unit("place") * (seam.length - width - 2 * _STUB_M)
            door = _at(seam, "frame", one, two, _STUB_M + share, round(width, 2))
        return _first_apart([door], others)
    private = [room for room in (one, two) if plan.room(room).kind in (BEDROOM, BATHROOM)]
    leaves = dice.order([door for room in private for door in _leaves(seam, room, plan)], "leaf")
    slack = seam.length - _WIDTH_M - 2 * _JAMB_M
    offsets = (_JAMB_M + slack * dice.unit("frame", attempt) for attempt in range(8))
    return _first_apart([*leaves, *(_at(seam, "frame", one, two, offset, _WIDTH_M) for offset in offsets)], others)


def _leaves(seam: Seam, room: int, plan: FloorPlan) -> list[Door]:
    """Doors whose open leaf stands along a side wall of the room: one for each end of the seam in a corner of it."""
    beyond = seam.right if seam.left == room else seam.left
    found = []
    for start, end in ((seam.a, seam.b), (seam.b, seam.a)):
        if start in plan.room(room).polygon and not _inner_corner(start, room, plan):
            ends = _along(start, end, _HINGE_M), _along(start, end, _HINGE_M + _WIDTH_M)
            found.append(Door("leaf", room, beyond, seam, *ends))
    return found


def _inner_corner(corner: Vec2, room: int, plan: FloorPlan) -> bool:
    """Whether the room fills three of the four quarters around its corner."""
    x, y = corner
    polygon = plan.room(room).polygon
    return sum(inside((x + dx, y + dy), polygon) for dx in (-0.2, 0.2) for dy in (-0.2, 0.2)) != 1


def _along(a: Vec2, b: Vec2, distance: float) -> Vec2:
    share = distance / math.dist(a, b)
    return (round(a[0] + share * (b[0] - a[0]), 4), round(a[1] + share * (b[1] - a[1]), 4))


def _at(seam: Seam, sort: str, one: int, two: int, offset: float, width: float) -> Door:
    offset = round(offset, 2)
    return Door(sort, one, two, seam, _along(seam.a, seam.b, offset), _along(seam.a, seam.b, offset + width))


def _front(plan: FloorPlan, dice: Dice, others: list[Door]) -> Door | None:
    kinds = [(LIVING,), (KITCHEN,)] if dice.chance(0.65, "room") else [(KITCHEN,), (LIVING,)]
    for wanted in (*kinds, (BEDROOM,)):
        seams = [
            seam
            for seam in plan.seams
            if OUTSIDE in (seam.left, seam.right)
            and plan.room(max(seam.left, seam.right)).kind in wanted
            and seam.length >= _OUTSIDE_M + 2 * _JAMB_M
        ]
        for number, seam in enumerate(dice.order(seams, *wanted)):
            slack = seam.length - _OUTSIDE_M - 2 * _JAMB_M
            room = max(seam.left, seam.right)
            door = _at(seam, "outside", room, room, _JAMB_M + slack * dice.unit(*wanted, number), _OUTSIDE_M)
            if _first_apart([door], others):
                return door
    return None


def inward(door: Door, room: int) -> Vec2:
    """The unit vector from the doorway into one of its rooms."""
    (ax, ay), (bx, by) = door.seam.a, door.seam.b
    length = math.dist((ax, ay), (bx, by))
    sign = 1.0 if door.seam.left == room else -1.0
    return (-sign * (by - ay) / length, sign * (bx - ax) / length)


def zones(door: Door) -> list[tuple[int, float, float, float, float]]:
    """Floor that must stay free: (room, x0, y0, x1, y1) [m], in front of the doorway and where its leaf swings."""
    found = []
    for room in (door.room0,) if door.sort == "outside" else (door.room0, door.room1):
        swing = door.sort == "leaf" and room == door.room0
        depth = {"leaf": 0.8, "frame": 0.8, "open": 0.5, "outside": 0.9}[door.sort]
        found.append((room, *_strip(door, room, 0.02, door.width + 0.12 if swing else depth)))
        found.append((room, *_strip(door, room, 0.36, 0.42)))
    return found


def leaf(door: Door) -> tuple[float, float, float, float]:
    """The floor under an open leaf: x0, y0, x1, y1 [m]."""
    nx, ny = inward(door, door.room0)
    x, y = door.a
    ux, uy = (door.b[0] - x) / door.width, (door.b[1] - y) / door.width
    corners = [(x + ux * s + nx * t, y + uy * s + ny * t) for s in LEAF_M for t in (0.0, WALL_M / 2 + door.width)]
    xs, ys = zip(*corners, strict=True)
    return (min(xs), min(ys), max(xs), max(ys))


def _strip(door: Door, room: int, beside: float, depth: float) -> tuple[float, float, float, float]:
    nx, ny = inward(door, room)
    (ax, ay), (bx, by) = door.a, door.b
    ux, uy = (bx - ax) / door.width, (by - ay) / door.width
    xs = (ax - ux * beside, bx + ux * beside, ax + nx * depth, bx + nx * depth)
    ys = (ay - uy * beside, by + uy * beside, ay + ny * depth, by + ny * depth)
    return (min(xs), min(ys), max(xs), max(ys))


def apart(one: Door, two: Door) -> bool:
    """Whether neither door blocks the other."""
    return not any(
        room == other and min(x1, u1) - max(x0, u0) > 0.0 and min(y1, v1) - max(y0, v0) > 0.0
        for room, x0, y0, x1, y1 in zones(one)
        for other, u0, v0, u1, v1 in zones(two)
    )


def _first_apart(doors: Iterable[Door], others: Sequence[Door]) -> Door | None:
    return next((door for door in doors if all(apart(door, other) for other in others)), None)
