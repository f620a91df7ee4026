"""The rules that a house must follow, and their findings in words.

They are about the size of rooms, the width of doorways, and how things stand, with space for their doors.
"""

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Literal

from msgspec import Struct

from hthor import catalog
from hthor.geometry.plane import inside, signed_area, turn
from hthor.houses.checks import polygons
from hthor.houses.space import boxes, obstacles, solids
from hthor.houses.space.solids import Slab
from hthor.types import HouseSpec, Joint, Opening, Part, Thing, Vec2

AREA_M2 = 4.0
WIDTH_M = 1.4
"""Least area of a room, and least width of any stretch of it."""
CLEAR_M = 0.8
"""Least clear width of a doorway."""
BEFORE_M = 0.3
"""Things nearer than this to a doorway, on either side, narrow it."""
LEAF_M = 0.06
"""Width of a doorway that an open leaf and its frame take up."""
_DOUBLE_M = 1.3
"""Wider doorways have two leaves."""
_HAIR_M = 1e-6
CODE_PART = "tools"

_DEEP_M = 0.15
"""How far a thing of a foreign house may reach into a wall without a finding."""
FLOAT_M = 0.01
"""How far above or below the floor or its support a thing may be."""
HANG_M = 0.02
"""How far the back of a hanging thing may be from the wall's face."""
GRAZE_M = 0.005
"""How deep a swinging door may cut into something."""
_STEPS = 12
"""Number of positions in which an opening door or drawer is tested."""


class Finding(Struct, frozen=True, kw_only=True):
    """A fault of a house: the ``rule`` that is broken, ``where`` (an id), and the ``problem`` in words.

    ``field`` is the place in the house's file, such as ``objects[3].position.y``; empty if no single field is at fault.
    """

    severity: Literal["error", "warning"]
    rule: str
    where: str
    problem: str
    field: str = ""

    def __str__(self) -> str:
        place = f", {self.field}" if self.field else ""
        return f"{self.severity}: {self.where}: {self.problem} ({self.rule}{place})"


def error(rule: str, where: str, problem: str, field: str = "") -> Finding:
    """A finding that makes a house unsound."""
    return Finding(severity="error", rule=rule, where=where, problem=problem, field=field)


def warning(rule: str, where: str, problem: str, field: str = "") -> Finding:
    """A finding that does not make a house unsound."""
    return Finding(severity="warning", rule=rule, where=where, problem=problem, field=field)


def is_sound(findings: Iterable[Finding]) -> bool:
    """Whether no finding is an error."""
    return not any(finding.severity == "error" for finding in findings)


def readable_kind(kind: str) -> str:
    """A kind's name as people write it."""
    return kind.replace("_", " ")


def check_rooms(house: HouseSpec) -> Iterator[Finding]:
    """``room-size``: a room smaller than `AREA_M2`, or narrower than `WIDTH_M` at some place."""
    for room in house.rooms:
        area, width = abs(signed_area(room.polygon)), least_width(room.polygon)
        if area < AREA_M2:
            problem = f"the {room.name or room.kind} has {area:.2f} m2; a room needs {AREA_M2} m2"
            yield warning("room-size", room.id, problem)
        if width < WIDTH_M - _HAIR_M:
            problem = f"the {room.name or room.kind} is only {width:.2f} m wide somewhere; it needs {WIDTH_M} m"
            yield warning("room-size", room.id, problem)


def least_width(polygon: tuple[Vec2, ...]) -> float:
    """Shortest cut [m] through the polygon along x or y; the polygon's least width if its corners are square."""
    turned = tuple((y, x) for x, y in polygon)
    return min(_narrowest(polygon), _narrowest(turned))


def _narrowest(polygon: tuple[Vec2, ...]) -> float:
    marks = sorted({round(x, 6) for x, _ in polygon})
    middles = [(a + b) / 2 for a, b in itertools.pairwise(marks) if b - a > 1e-3]
    return min((high - low for x in middles for low, high in polygons.vertical_spans(x, polygon)), default=0.0)


def check_doors(house: HouseSpec, height: float) -> Iterator[Finding]:
    """``door-clear``: a doorway with less than `CLEAR_M` between its jambs and the furniture near it."""
    pieces = list(obstacles.furniture_in_the_way(house, height))
    for opening in house.openings:
        if not opening.passable:
            continue
        near = [(thing, span) for thing, slab in pieces if (span := _shadow(opening, slab)) is not None]
        width = math.dist(opening.a, opening.b)
        clear = widest_gap(width, [*_leaves(opening, width), *(span for _, span in near)])
        if clear < CLEAR_M - _HAIR_M:
            who = ", ".join(f"'{thing.id}' ({readable_kind(thing.kind)})" for thing, _ in near)
            problem = f"{clear:.2f} m clear; a doorway needs {CLEAR_M} m"
            yield warning("door-clear", opening.id, problem + (f"; in the way: {who}" if who else ""))


def _leaves(opening: Opening, width: float) -> list[tuple[float, float]]:
    """The stretches [m] along a doorway that its open leaves take: at its end ``a``, in wide doorways at both ends."""
    if not opening.openable:
        return []
    return [(0.0, LEAF_M)] if width <= _DOUBLE_M else [(0.0, LEAF_M), (width - LEAF_M, width)]


def widest_gap(width: float, spans: list[tuple[float, float]]) -> float:
    """The longest stretch [m] of ``[0, width]`` that no span covers."""
    best, start = 0.0, 0.0
    for low, high in sorted(spans):
        best, start = max(best, min(low, width) - start), max(start, high)
    return max(best, width - start)


def _shadow(opening: Opening, slab: Slab) -> tuple[float, float] | None:
    """The stretch [m] along the doorway in front of which a box stands; None for a box that is elsewhere."""
    width = math.dist(opening.a, opening.b)
    if width < _HAIR_M:
        return None
    ux, uy = (opening.b[0] - opening.a[0]) / width, (opening.b[1] - opening.a[1]) / width
    deep = solids.WALL_M / 2 + BEFORE_M
    cos, sin = math.cos(slab.yaw), math.sin(slab.yaw)
    corners = []
    for sx, sy in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)):
        x = slab.centre[0] + sx * slab.size[0] * cos - sy * slab.size[1] * sin - opening.a[0]
        y = slab.centre[1] + sx * slab.size[0] * sin + sy * slab.size[1] * cos - opening.a[1]
        corners.append((x * ux + y * uy, y * ux - x * uy))
    inside = _below(_below(corners, deep), deep, -1.0)
    if not inside:
        return None
    low, high = max(0.0, min(u for u, _ in inside)), min(width, max(u for u, _ in inside))
    return (low, high) if high - low > _HAIR_M else None


def _below(corners: list[Vec2], limit: float, sign: float = 1.0) -> list[Vec2]:
    """The part of a convex polygon where ``sign * v`` is below the limit."""
    kept: list[Vec2] = []
    for (u0, v0), (u1, v1) in zip(corners, (*corners[1:], *corners[:1]), strict=True):
        if sign * v0 < limit:
            kept.append((u0, v0))
        if (sign * v0 < limit) != (sign * v1 < limit):
            share = (sign * limit - v0) / (v1 - v0)
            kept.append((u0 + share * (u1 - u0), sign * limit))
    return kept


def check_indoors(house: HouseSpec) -> Iterator[Finding]:
    """``thing-indoors``: a thing whose middle is in no room."""
    for thing, _ in solids.furniture_slabs(house):
        if not any(inside(thing.centre[:2], room.polygon) for room in house.rooms):
            problem = f"the {readable_kind(thing.kind)} stands outside every room"
            yield warning("thing-indoors", thing.id, problem, thing.source)


def check_overlaps(house: HouseSpec) -> Iterator[Finding]:
    """``thing-in-wall`` and ``thing-in-thing``: bounding boxes that overlap deeply with a wall or with each other."""
    pieces, walls = solids.furniture_slabs(house), solids.wall_slabs(house)
    for k, (thing, box) in enumerate(pieces):
        if any(solids.overlap_depth(box, wall) > _DEEP_M for wall in walls):
            yield warning("thing-in-wall", thing.id, f"reaches more than {_DEEP_M} m into a wall", thing.source)
        for other, rival in pieces[k + 1 :]:
            shallow = min(*box.size, *rival.size) / 2
            if solids.overlap_depth(box, rival) > shallow:
                yield warning("thing-in-thing", thing.id, f"stands deep inside {other.id}", thing.source)


def check_supported(house: HouseSpec) -> Iterator[Finding]:
    """``thing-floats``: a thing that neither stands on the floor, nor lies on its support, nor hangs on a wall.

    Things on a support are judged by the height in the house's file.
    """
    things = {thing.id: thing for thing in house.things}
    for thing in house.things:
        bottom = thing.centre[2] - thing.size[2] / 2
        if thing.parent and thing.parent in things:
            support = things[thing.parent]
            below = boxes.surface_below(thing, support)
            if below is None:
                kinds = readable_kind(thing.kind), readable_kind(support.kind)
                problem = f"the {kinds[0]} lies over no surface of '{support.id}' ({kinds[1]})"
                yield warning("thing-floats", thing.id, problem, thing.source)
            elif abs(below[1] + thing.lift) > FLOAT_M:
                gap = below[1] + thing.lift
                above = f"{abs(gap):.3f} m {'above' if gap > 0 else 'below'} the {below[0].name}"
                problem = f"the {readable_kind(thing.kind)} lies {above} of '{support.id}'"
                yield warning("thing-floats", thing.id, problem, thing.source)
        elif catalog.kind(thing.kind).wall_mounted:
            gap = _off_wall(thing, house)
            if gap > HANG_M:
                problem = f"the back of the {readable_kind(thing.kind)} is {gap:.3f} m from the nearest wall's face"
                yield warning("thing-floats", thing.id, problem, thing.source)
        elif abs(bottom) > FLOAT_M:
            where = f"{abs(bottom):.3f} m {'above' if bottom > 0 else 'below'} the floor"
            problem = f"the {readable_kind(thing.kind)} stands {where}"
            yield warning("thing-floats", thing.id, problem, thing.source)


def _off_wall(thing: Thing, house: HouseSpec) -> float:
    """Distance [m] from the middle of a thing's back to the nearest wall's face; inf if there is no wall."""
    x, y = turn((0.0, -thing.size[1] / 2), thing.yaw)
    back = (thing.centre[0] + x, thing.centre[1] + y)
    lines = (polygons.distance_to_segment(back, wall.a, wall.b) for wall in house.walls)
    return abs(min(lines, default=math.inf) - solids.WALL_M / 2)


def check_swings(house: HouseSpec) -> Iterator[Finding]:
    """``swing-free``: a door or drawer that would hit something else, or a wall, on its way."""
    for thing in house.things:
        kind = catalog.kind(thing.kind)
        joints = kind.joints(thing.size)
        if joints:
            moving = tuple(part for part in kind.parts(thing.size) if part.moves)
            yield from check_swing(house, thing, moving, joints, readable_kind(thing.kind))


def check_swing(
    house: HouseSpec, thing: Thing, parts: Sequence[Part], joints: Sequence[Joint], title: str
) -> Iterator[Finding]:
    """``swing-free`` for the moving ``parts`` of one thing, given in its frame; at most one finding."""
    reach = math.hypot(*thing.size)  # a door is no wider than its thing, a drawer no longer
    near = [
        (f"'{other.id}' ({readable_kind(other.kind)})", boxes.bounding_slab(box))
        for other in house.things
        if other.id not in (thing.id, thing.parent) and other.parent != thing.id
        if math.dist(thing.centre[:2], other.centre[:2]) < reach + math.hypot(*other.size[:2])
        for _, box in boxes.boxes_of(other)
    ]
    near += [("a wall", wall) for wall in solids.wall_slabs(house) if _gap(thing.centre[:2], wall) < reach]
    for step in range(1, _STEPS + 1):
        for _, box in boxes.posed_boxes(parts, joints, thing, step / _STEPS):
            moving = boxes.bounding_slab(box)
            depth, who = max(((solids.overlap_depth(moving, other), who) for who, other in near), default=(0.0, ""))
            if depth > GRAZE_M:
                problem = f"the {title}, {step / _STEPS:.0%} open, is {1000 * depth:.0f} mm in {who}"
                yield warning("swing-free", thing.id, problem)
                return


def _gap(point: Vec2, slab: Slab) -> float:
    """Distance [m] from a point to a box's footprint."""
    cos, sin = math.cos(slab.yaw), math.sin(slab.yaw)
    dx, dy = point[0] - slab.centre[0], point[1] - slab.centre[1]
    along, across = abs(cos * dx + sin * dy) - slab.size[0] / 2, abs(cos * dy - sin * dx) - slab.size[1] / 2
    return math.hypot(max(along, 0.0), max(across, 0.0))
