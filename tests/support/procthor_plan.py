"""Floor plans in the manner of ProcTHOR's files: rooms grown on a grid of cells, and the walls between them."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any, NamedTuple

Cell = tuple[int, int]
Point = tuple[float, float]
OUTSIDE = 0
FIRST = 2
"""ProcTHOR numbers rooms from 2."""
_STEPS = {(1, 0): ((1, 0), (1, 1)), (0, 1): ((1, 1), (0, 1)), (-1, 0): ((0, 1), (0, 0)), (0, -1): ((0, 0), (1, 0))}
"""Corners of a cell's side towards each neighbour, counter-clockwise."""


class Side(NamedTuple):
    """A straight stretch between two points [m], counter-clockwise around ``room``, with one neighbour behind it."""

    room: int
    beyond: int
    a: Point
    b: Point

    @property
    def length(self) -> float:
        return abs(self.b[0] - self.a[0]) + abs(self.b[1] - self.a[1])

    @property
    def inward(self) -> Point:
        """The unit vector from the side into its room."""
        (ax, ay), (bx, by) = self.a, self.b
        return (-(by - ay) / self.length, (bx - ax) / self.length)

    def wall(self, outer: bool = False) -> str:
        """The id of the wall along the side, as ProcTHOR writes it."""
        ends = "|".join(f"{value:.2f}" for end in sorted((self.a, self.b)) for value in end)
        return f"wall|{'exterior' if outer else self.room}|{ends}"


class Plan(NamedTuple):
    """The cells of all rooms, and the side of a cell [m]."""

    cells: dict[Cell, int]
    cell: float

    def rooms(self) -> list[int]:
        return sorted(set(self.cells.values()))

    def sides(self, room: int) -> list[Side]:
        """The sides of a room, in order around it, one for each neighbour."""
        steps = list(_around(self.cells, room))
        turns = [k for k in range(len(steps)) if steps[k][1:] != steps[k - 1][1:]]
        steps = steps[turns[0] :] + steps[: turns[0]]
        found: list[Side] = []
        for corner, beyond, step in steps:
            a = self._metres(corner)
            b = self._metres((corner[0] + step[0], corner[1] + step[1]))
            last = found[-1] if found else None
            if last and last.b == a and last.beyond == beyond and (last.a[0] == b[0] or last.a[1] == b[1]):
                found[-1] = last._replace(b=b)
            else:
                found.append(Side(room, beyond, a, b))
        return found

    def polygon(self, room: int) -> list[Point]:
        """The corners of a room, collinear ones left out."""
        points = [side.a for side in self.sides(room)]
        kept = []
        for k, (x, y) in enumerate(points):
            (ax, ay), (bx, by) = points[k - 1], points[(k + 1) % len(points)]
            if not (ax == x == bx or ay == y == by):
                kept.append((x, y))
        return kept

    def _metres(self, corner: Cell) -> Point:
        return (round(corner[0] * self.cell, 3), round(corner[1] * self.cell, 3))


def draw_plan(dice: random.Random, rooms: int) -> Plan:
    """A rectangle of cells, divided again and again; then rooms take corner cells from each other."""
    wide, deep = dice.randint(2 + rooms // 2, 3 + rooms // 2), dice.randint(3, 5)
    parts = [(0, 0, wide, deep)]
    while len(parts) < rooms:
        parts.sort(key=lambda part: (part[2] - part[0]) * (part[3] - part[1]))
        x0, y0, x1, y1 = parts.pop()
        if x1 - x0 >= y1 - y0:
            cut = dice.randint(x0 + 1, x1 - 1)
            parts += [(x0, y0, cut, y1), (cut, y0, x1, y1)]
        else:
            cut = dice.randint(y0 + 1, y1 - 1)
            parts += [(x0, y0, x1, cut), (x0, cut, x1, y1)]
    cells = {
        (x, y): FIRST + number
        for number, (x0, y0, x1, y1) in enumerate(parts)
        for x in range(x0, x1)
        for y in range(y0, y1)
    }
    for _ in range(dice.randint(0, 4)):
        _swap(dice, cells)
    return Plan(cells, round(dice.uniform(1.75, 2.1), 3))


def _swap(dice: random.Random, cells: dict[Cell, int]) -> None:
    """Give one cell to a neighbouring room if every room stays in one piece, without a hole or a pinch."""
    x, y = dice.choice(sorted(cells))
    dx, dy = dice.choice(sorted(_STEPS))
    old, new = cells[x, y], cells.get((x + dx, y + dy))
    if new in (None, old) or sum(room == old for room in cells.values()) < 3:
        return
    changed = {**cells, (x, y): new}
    if all(len(list(_around(changed, room))) == _edges(changed, room) for room in (old, new)):
        cells[x, y] = new


def _edges(cells: dict[Cell, int], room: int) -> int:
    return sum(
        cells.get((x + dx, y + dy)) != room for (x, y), owner in cells.items() if owner == room for dx, dy in _STEPS
    )


def _around(cells: dict[Cell, int], room: int) -> Iterator[tuple[Cell, int, Cell]]:
    """(corner, neighbour, step to the next corner) once around a room, or around a part of a room in several."""
    edges: dict[Cell, list[tuple[Cell, int, Cell]]] = {}
    for (x, y), owner in sorted(cells.items()):
        for (dx, dy), ((ax, ay), (bx, by)) in _STEPS.items():
            beyond = cells.get((x + dx, y + dy), OUTSIDE)
            if owner == room and beyond != room:
                edge = ((x + ax, y + ay), beyond, (bx - ax, by - ay))
                edges.setdefault(edge[0], []).append(edge)
    if any(len(group) > 1 for group in edges.values()):
        return  # a pinch: two ways go on from one corner
    here = first = min(edges)
    while True:
        (edge,) = edges[here]
        yield edge
        here = (here[0] + edge[2][0], here[1] + edge[2][1])
        if here == first:
            return


def wall_rows(plan: Plan, height: float) -> list[dict[str, Any]]:
    """The file's walls: one face for each side of each room, and one outdoors."""
    rows = []
    for room in plan.rooms():
        for side in plan.sides(room):
            ends = sorted((side.a, side.b))
            low = [{"x": x, "y": 0, "z": z} for x, z in ends]
            high = [{"x": x, "y": height, "z": z} for x, z in ends]
            row = {"roomId": f"room|{room}", "material": {"name": "Walldrywall4Tiled"}, "layer": "Procedural0"}
            rows.append({"id": side.wall(), "polygon": low + high, **row})
            if side.beyond == OUTSIDE:
                # outdoors the order of the corners is reversed, upper ones first
                rows.append({"id": side.wall(outer=True), "polygon": high[::-1] + low[::-1], **row})
    return rows
