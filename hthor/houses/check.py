"""Is a house fit for a body to live in? Findings in words; knows nothing of tasks or minds.

Errors make a house unsound for a body: a start that is not free, a room that it cannot reach. Everything else is a
warning, because real floor plans are full of it: a receptacle out of reach, a narrow door, furniture in a wall or in
other furniture.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Literal

import numpy as np
from msgspec import Struct

from hthor import catalog
from hthor.geometry import distance_to_rectangle, inside
from hthor.houses import solids
from hthor.houses.freespace import Bools, FreeSpace
from hthor.types import HouseSpec, Thing

STAND_M = 1.0
"""A receptacle counts as reachable when a body can stand within this distance of its edge."""
_DEEP_M = 0.15
"""How far a thing may reach into a wall before it is worth a word."""


class Finding(Struct, frozen=True, kw_only=True):
    """Something wrong with a house: which ``rule``, ``where`` (an id), what the ``problem`` is, in words."""

    severity: Literal["error", "warning"]
    rule: str
    where: str
    problem: str

    def __str__(self) -> str:
        return f"{self.severity}: {self.where}: {self.problem} ({self.rule})"


def check(house: HouseSpec, radius: float, height: float = 1.8) -> tuple[Finding, ...]:
    """Everything that is wrong with a house for a body of this radius and height [m]; errors come first."""
    space = FreeSpace.of(house, radius, height)
    start, errors = house.start, []
    if not space.free.any():
        return (_error("start-free", house.id, f"no floor is free for a body of radius {radius} m"),)
    if not space.is_free(start.x, start.y):
        problem = f"the start ({start.x:.2f}, {start.y:.2f}) is not free for a body of radius {radius} m"
        errors.append(_error("start-free", house.id, problem))
    reached = space.component(*space.nearest_free(start.x, start.y))
    warnings = (
        *_doors(house, radius, height),
        *_receptacles(house, space, reached),
        *_strays(house),
        *_overlaps(house),
    )
    return (*errors, *_rooms(house, space, reached), *warnings)


def sound(findings: Iterable[Finding]) -> bool:
    """Whether no finding is an error."""
    return not any(finding.severity == "error" for finding in findings)


def _error(rule: str, where: str, problem: str) -> Finding:
    return Finding(severity="error", rule=rule, where=where, problem=problem)


def _warning(rule: str, where: str, problem: str) -> Finding:
    return Finding(severity="warning", rule=rule, where=where, problem=problem)


def _rooms(house: HouseSpec, space: FreeSpace, reached: Bools) -> Iterator[Finding]:
    for room in house.rooms:
        if not (reached & space.room_mask(room)).any():
            problem = f"the {room.name or room.kind} cannot be reached from the start with a radius of {space.radius} m"
            yield _error("room-reachable", room.id, problem)


def _doors(house: HouseSpec, radius: float, height: float) -> Iterator[Finding]:
    for opening in house.openings:
        width = float(np.hypot(opening.b[0] - opening.a[0], opening.b[1] - opening.a[1]))
        if opening.passable and width < 2 * radius:
            yield _warning("door-width", opening.id, f"{width:.2f} m wide; the body needs {2 * radius:.2f} m")
        if opening.passable and opening.high < height:
            yield _warning("door-height", opening.id, f"{opening.high:.2f} m high; the body is {height:.2f} m tall")


def _receptacles(house: HouseSpec, space: FreeSpace, reached: Bools) -> Iterator[Finding]:
    places = space.centres(reached)
    for thing in house.things:
        if thing.kind in catalog.RECEPTACLES:
            near = places[np.hypot(places[:, 0] - thing.centre[0], places[:, 1] - thing.centre[1]) < _radius(thing)]
            gaps = (distance_to_rectangle((x, y), thing.centre[:2], thing.size[:2], thing.yaw) for x, y in near)
            if not any(gap <= STAND_M for gap in gaps):
                problem = f"nowhere to stand within {STAND_M} m of the {thing.kind.replace('_', ' ')}"
                yield _warning("receptacle-reachable", thing.id, problem)


def _radius(thing: Thing) -> float:
    return float(np.hypot(thing.size[0], thing.size[1])) / 2 + STAND_M


def _strays(house: HouseSpec) -> Iterator[Finding]:
    for thing, _ in solids.furniture(house):
        if not any(inside(thing.centre[:2], room.polygon) for room in house.rooms):
            yield _warning("thing-indoors", thing.id, f"the {thing.kind.replace('_', ' ')} stands outside every room")


def _overlaps(house: HouseSpec) -> Iterator[Finding]:
    pieces, walls = solids.furniture(house), solids.walls(house)
    for k, (thing, box) in enumerate(pieces):
        if any(solids.overlap(box, wall) > _DEEP_M for wall in walls):
            yield _warning("thing-in-wall", thing.id, f"reaches more than {_DEEP_M} m into a wall")
        for other, rival in pieces[k + 1 :]:
            shallow = min(*box.size, *rival.size) / 2
            if solids.overlap(box, rival) > shallow:
                yield _warning("thing-in-thing", thing.id, f"stands deep inside {other.id}")
