"""Rules about how things stand: indoors, apart, at rest, with room for their doors."""

import math
from collections.abc import Iterator, Sequence

from hthor import catalog
from hthor.geometry.plane import inside, turn
from hthor.houses.checks import polygons
from hthor.houses.checks.findings import Finding, readable_kind, warning
from hthor.houses.space import boxes, solids
from hthor.houses.space.solids import Slab
from hthor.types import HouseSpec, Joint, Part, Thing, Vec2

CODE_PART = "tools"

_DEEP_M = 0.15
"""How far a thing of a foreign house may reach into a wall without a finding."""
FLOAT_M = 0.01
"""How far above or below the floor or its support a thing may be."""
HANG_M = 0.02
"""How far off a wall's face the back of a thing that hangs there may be."""
GRAZE_M = 0.005
"""How deep a swinging door may cut into something."""
_STEPS = 12
"""At how many places of its travel a door or drawer is tried."""


def check_indoors(house: HouseSpec) -> Iterator[Finding]:
    """``thing-indoors``: a thing whose middle is in no room."""
    for thing, _ in solids.furniture_slabs(house):
        if not any(inside(thing.centre[:2], room.polygon) for room in house.rooms):
            yield warning("thing-indoors", thing.id, f"the {readable_kind(thing.kind)} stands outside every room")


def check_overlaps(house: HouseSpec) -> Iterator[Finding]:
    """``thing-in-wall`` and ``thing-in-thing``: bounding boxes that are deep in a wall or in one another."""
    pieces, walls = solids.furniture_slabs(house), solids.wall_slabs(house)
    for k, (thing, box) in enumerate(pieces):
        if any(solids.overlap_depth(box, wall) > _DEEP_M for wall in walls):
            yield warning("thing-in-wall", thing.id, f"reaches more than {_DEEP_M} m into a wall")
        for other, rival in pieces[k + 1 :]:
            shallow = min(*box.size, *rival.size) / 2
            if solids.overlap_depth(box, rival) > shallow:
                yield warning("thing-in-thing", thing.id, f"stands deep inside {other.id}")


def check_supported(house: HouseSpec) -> Iterator[Finding]:
    """``thing-floats``: a thing that neither stands on the floor, nor lies on its support, nor hangs on a wall.

    What lies on a support is judged by the height that the house's file gives it.
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
                yield warning("thing-floats", thing.id, problem)
            elif abs(below[1] + thing.lift) > FLOAT_M:
                gap = below[1] + thing.lift
                above = f"{abs(gap):.3f} m {'above' if gap > 0 else 'below'} the {below[0].name}"
                yield warning(
                    "thing-floats", thing.id, f"the {readable_kind(thing.kind)} lies {above} of '{support.id}'"
                )
        elif catalog.kind(thing.kind).wall_mounted:
            gap = _off_wall(thing, house)
            if gap > HANG_M:
                problem = f"the back of the {readable_kind(thing.kind)} is {gap:.3f} m from the nearest wall's face"
                yield warning("thing-floats", thing.id, problem)
        elif abs(bottom) > FLOAT_M:
            where = f"{abs(bottom):.3f} m {'above' if bottom > 0 else 'below'} the floor"
            problem = f"the {readable_kind(thing.kind)} stands {where}"
            yield warning("thing-floats", thing.id, problem)


def _off_wall(thing: Thing, house: HouseSpec) -> float:
    """Distance [m] from the middle of a thing's back to the nearest wall's face; inf where there is no wall."""
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
