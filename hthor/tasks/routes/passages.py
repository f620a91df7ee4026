"""The passages between a house's rooms: doorways, and stretches of their common border without a wall."""

import functools
import math
from collections.abc import Iterator, Sequence
from itertools import combinations

from msgspec import Struct

from hthor.houses.space.solids import WALL_M
from hthor.types import HouseSpec, Room, Vec2

OPEN_M = 0.9
"""Least width [m] of a passage without a doorway. Our choice: about that of a door."""
_LINE_M = 0.08
"""How far [m] walls and borders may lie from the line that they share, since a wall's two faces may be apart."""

Span = tuple[float, float]


class Passage(Struct, frozen=True, kw_only=True):
    """A way between two ``rooms`` (ids): the floor segment from ``a`` to ``b`` [m], house frame.

    ``is_door``: it is a doorway in a wall; otherwise the rooms are open to each other there.
    """

    id: str
    rooms: tuple[str, str]
    a: Vec2
    b: Vec2
    is_door: bool

    @property
    def middle(self) -> Vec2:
        """Its middle [m]."""
        return (self.a[0] + self.b[0]) / 2, (self.a[1] + self.b[1]) / 2

    def other_side(self, room: str) -> str:
        """The room on the other side."""
        return self.rooms[0] if self.rooms[1] == room else self.rooms[1]

    def heading(self, a: Vec2, b: Vec2) -> float:
        """The heading [rad] straight through, for a body that goes from ``a`` to ``b`` [m]."""
        nx, ny = self.b[1] - self.a[1], self.a[0] - self.b[0]
        sign = 1.0 if nx * (b[0] - a[0]) + ny * (b[1] - a[1]) > 0.0 else -1.0
        return math.atan2(sign * ny, sign * nx)


@functools.lru_cache(maxsize=32)
def passages(house: HouseSpec) -> tuple[Passage, ...]:
    """All passages between rooms: the doorways in the order of the house, then the open borders."""
    doors = [
        Passage(id=door.id, rooms=door.rooms, a=door.a, b=door.b, is_door=True)
        for door in house.openings
        if door.passable
    ]
    return (*doors, *(gap for one, two in combinations(house.rooms, 2) for gap in _open_borders(house, one, two)))


def exits(house: HouseSpec, room: str) -> tuple[Passage, ...]:
    """The passages by which a room can be left."""
    return tuple(passage for passage in passages(house) if room in passage.rooms)


def _open_borders(house: HouseSpec, one: Room, two: Room) -> Iterator[Passage]:
    """The parts of the common border of two rooms that no wall closes."""
    for a, b in _edges(one):
        length = math.dist(a, b)
        shared = [span for c, d in _edges(two) if (span := _overlap(a, b, length, c, d)) is not None]
        walls = [span for wall in house.walls if (span := _overlap(a, b, length, wall.a, wall.b)) is not None]
        for number, (low, high) in enumerate(_left(shared, walls)):
            ends = [(a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])) for s in (low / length, high / length)]
            id = f"open|{one.id.removeprefix('room|')}|{two.id.removeprefix('room|')}|{number}"
            yield Passage(id=id, rooms=(one.id, two.id), a=ends[0], b=ends[1], is_door=False)


def _edges(room: Room) -> Iterator[tuple[Vec2, Vec2]]:
    return zip(room.polygon, (*room.polygon[1:], room.polygon[0]), strict=True)


def _overlap(a: Vec2, b: Vec2, length: float, c: Vec2, d: Vec2) -> Span | None:
    """The part [m] of the edge from ``a`` to ``b`` that another segment on the same line covers; None for none."""
    if length < WALL_M:
        return None
    ux, uy = (b[0] - a[0]) / length, (b[1] - a[1]) / length
    if any(abs(ux * (y - a[1]) - uy * (x - a[0])) > _LINE_M for x, y in (c, d)):
        return None
    low, high = sorted(ux * (x - a[0]) + uy * (y - a[1]) for x, y in (c, d))
    low, high = max(low, 0.0), min(high, length)
    return (low, high) if high - low > WALL_M else None


def _left(shared: Sequence[Span], walls: Sequence[Span]) -> list[Span]:
    """What the walls leave of the shared parts, as far as it is wide enough."""
    found = []
    for low, high in sorted(shared):
        begin = low
        for start, end in [*sorted(walls), (high, high)]:
            if min(start, high) - begin >= OPEN_M:
                found.append((begin, min(start, high)))
            begin = max(begin, end)
    return found
