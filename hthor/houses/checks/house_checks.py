"""Checks whether a body can live in a house; findings in words.

Errors make a house unsound for a body: a start that is not free, a room that it cannot reach. All other findings are
warnings, because they are frequent in real floor plans: a receptacle out of reach, a narrow door, furniture in a wall
or in other furniture. hthor's own houses are judged strictly: more rules apply, and nearly all findings are errors.
"""

import math
from collections.abc import Iterator

import msgspec
import numpy as np

from hthor import catalog, rules
from hthor.geometry.plane import distance_to_rectangle, to_house, to_local
from hthor.houses.checks import house_rules, placing_rules
from hthor.houses.checks.house_rules import Finding, error, is_sound, readable_kind, warning
from hthor.houses.space import boxes
from hthor.houses.space.free_space import Bools, FreeSpace
from hthor.houses.space.visibility import with_all_open
from hthor.types import HouseSpec, Thing, Vec3

CODE_PART = "tools"

__all__ = ["STAND_M", "STRICT", "Finding", "check", "is_sound"]

STAND_M = 1.0
"""A receptacle counts as reachable when a body can stand within this distance of its edge."""
EYE_M = 1.6
"""Height of a standing person's eyes."""
STRICT = (
    "start-free",
    "room-reachable",
    "room-size",
    "door-clear",
    "door-height",
    "receptacle-reachable",
    "receptacles-present",
    "thing-indoors",
    "thing-floats",
    "thing-tilted",
    "swing-free",
    "object-visible",
)
"""Rules that are errors when a house is judged strictly."""


def check(house: HouseSpec, radius: float, height: float = 1.8, *, strict: bool = False) -> tuple[Finding, ...]:
    """All findings about a house for a body of this radius and height [m]; errors come first.

    Args:
        strict: judge as one of hthor's own houses: the rules of `STRICT`, also those about a lived-in home, are errors.
    """
    space = FreeSpace.of(house, radius, height)
    start, findings = house.start, []
    if not space.free.any():
        return (error("start-free", house.id, f"no floor is free for a body of radius {radius} m"),)
    if not space.is_free(start.x, start.y):
        problem = f"the start ({start.x:.2f}, {start.y:.2f}) is not free for a body of radius {radius} m"
        x, y = space.nearest_free(start.x, start.y)
        nearest = f"the nearest free floor is at x {x:.3f}, {'z' if house.start_source else 'y'} {y:.3f}"
        field = f"{house.start_source}.position" if house.start_source else ""
        findings.append(error("start-free", house.id, f"{problem}; {nearest}", field))
    reached = space.component(*space.nearest_free(start.x, start.y))
    findings += _rooms(house, space, reached)
    findings += _doors(house, radius, height)
    findings += _receptacles(house, space, reached)
    findings += house_rules.check_indoors(house)
    findings += placing_rules.check_upright(house)
    findings += placing_rules.check_movable(house)
    if strict:
        findings += house_rules.check_rooms(house)
        findings += house_rules.check_doors(house, height)
        findings += _present(house)
        findings += house_rules.check_supported(house)
        findings += house_rules.check_swings(house)
        findings += _objects(house, space, reached)
        findings = [msgspec.structs.replace(one, severity="error") if one.rule in STRICT else one for one in findings]
    else:
        findings += house_rules.check_overlaps(house)
        findings += placing_rules.check_carried(house)
    return tuple(sorted(findings, key=lambda finding: finding.severity != "error"))


def _rooms(house: HouseSpec, space: FreeSpace, reached: Bools) -> Iterator[Finding]:
    for index, room in enumerate(house.rooms):
        if not (reached & space.room_mask(room)).any():
            problem = f"the {room.name or room.kind} cannot be reached from the start with a radius of {space.radius} m"
            yield error("room-reachable", room.id, problem, f"rooms[{index}]")


def _doors(house: HouseSpec, radius: float, height: float) -> Iterator[Finding]:
    for index, opening in enumerate(house.openings):  # doors first, in the file's order
        width, field = math.dist(opening.a, opening.b), f"doors[{index}].holePolygon"
        if opening.passable and width < 2 * radius:
            yield warning("door-width", opening.id, f"{width:.2f} m wide; the body needs {2 * radius:.2f} m", field)
        if opening.passable and opening.high < height:
            yield warning(
                "door-height", opening.id, f"{opening.high:.2f} m high; the body is {height:.2f} m tall", field
            )


def _receptacles(house: HouseSpec, space: FreeSpace, reached: Bools) -> Iterator[Finding]:
    """The place to stand must be in the receptacle's own room, since nobody can reach through a wall."""
    floors = {room.id: space.centres(reached & space.room_mask(room)) for room in house.rooms}
    anywhere = space.centres(reached)
    for thing in house.things:
        if thing.kind in catalog.RECEPTACLES:
            places = floors.get(thing.room, anywhere)
            reach = math.hypot(*thing.size[:2]) / 2 + STAND_M
            near = places[np.hypot(places[:, 0] - thing.centre[0], places[:, 1] - thing.centre[1]) < reach]
            gaps = (distance_to_rectangle((x, y), thing.centre[:2], thing.size[:2], thing.yaw) for x, y in near)
            if not any(gap <= STAND_M for gap in gaps):
                problem = f"nowhere to stand within {STAND_M} m of the {readable_kind(thing.kind)}"
                yield warning("receptacle-reachable", thing.id, problem, thing.source)


def _present(house: HouseSpec) -> Iterator[Finding]:
    missing = [kind for kind in catalog.RECEPTACLES if all(thing.kind != kind for thing in house.things)]
    if missing:
        problem = f"has no {', no '.join(readable_kind(kind) for kind in missing)}; a home has all eight receptacles"
        yield warning("receptacles-present", house.id, problem)


def _objects(house: HouseSpec, space: FreeSpace, reached: Bools) -> Iterator[Finding]:
    """``object-visible``: every small thing must be visible from some place within `rules.FIND_RANGE_M` of it.

    The range is measured on the plan; for the benchmark's target kinds from the eyes, as a search requires.
    """
    things, sight, places = {thing.id: thing for thing in house.things}, with_all_open(house), space.centres(reached)
    for thing in house.things:
        if not (thing.parent or catalog.kind(thing.kind).pickable):
            continue
        at = _opened(thing, things.get(thing.parent))
        target = thing.kind in catalog.TARGETS
        above = EYE_M - at[2] if target else 0.0
        reach = math.sqrt(max(0.0, rules.FIND_RANGE_M**2 - above**2))
        gaps = np.hypot(places[:, 0] - at[0], places[:, 1] - at[1])
        order = np.argsort(gaps, kind="stable")
        near = places[order[: int(np.searchsorted(gaps[order], reach, side="right"))]]
        if not sight.visible(thing, at, np.column_stack((near, np.full(len(near), EYE_M)))):
            where = f"{f'none of {len(near)} places' if len(near) else 'no floor'} within {reach:.2f} m"
            what = f"the {readable_kind(thing.kind)} on or in '{thing.parent or 'the floor'}'"
            yield warning("object-visible", thing.id, f"{what} is hidden: {where} shows it")


def _opened(thing: Thing, support: Thing | None) -> Vec3:
    """The thing's place when its support is open: a thing in a drawer moves out with the drawer."""
    below = boxes.surface_below(thing, support) if support is not None else None
    if support is None or below is None or not below[0].moves:
        return thing.centre
    joints = {joint.name: joint for joint in catalog.kind(support.kind).joints(support.size)}
    local = to_local(thing.centre, support.centre, support.yaw)
    moved, _ = boxes.joint_motion(joints[below[0].moves], local, 1.0)
    return to_house(moved, support.centre, support.yaw)
