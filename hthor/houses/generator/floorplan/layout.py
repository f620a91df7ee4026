"""From numbered cells to rooms with outlines and the seams between them.

Plans are in the house frame [m], the grid's corner at the origin.
"""

import math

import numpy as np
from msgspec import Struct

from hthor.houses.generator.floorplan.growth import Boundary, Cells, Labels
from hthor.houses.generator.floorplan.room_specs import BATHROOM, BEDROOM, KITCHEN, LIVING, RoomGroup, iter_leaves
from hthor.types import Vec2

OUTSIDE = 1
"""Used in place of a room's number for the outside; rooms count from 2."""
AREA_MIN_M2 = 4.0
_CORE_M = {KITCHEN: (3.2, 4.0), LIVING: (3.2, 4.6), BEDROOM: (3.2, 3.2), BATHROOM: (1.6, 3.2)}
"""The rectangle [m] that must fit into a room of each type, in either orientation."""
_BATH_MAX_M2 = 17.0


class RoomPlan(Struct, frozen=True):
    """A room: its number, ProcTHOR's room type, and its outline, counter-clockwise [m]."""

    number: int
    kind: str
    polygon: tuple[Vec2, ...]
    area: float


class Seam(Struct, frozen=True):
    """A straight stretch from ``a`` to ``b`` [m], with room ``left`` on its left and room ``right`` on its right."""

    a: Vec2
    b: Vec2
    left: int
    right: int

    @property
    def length(self) -> float:
        """Length of the seam [m]."""
        return math.dist(self.a, self.b)


class FloorPlan(Struct, frozen=True):
    """A floor plan. ``labels`` are the rooms' numbers by cell of side ``scale`` [m], 0 outdoors."""

    rooms: tuple[RoomPlan, ...]
    seams: tuple[Seam, ...]
    labels: Labels
    scale: float

    def room(self, number: int) -> RoomPlan:
        """The room of that number."""
        return self.rooms[number - OUTSIDE - 1]

    def between(self, one: int, two: int) -> list[Seam]:
        """The seams that two rooms share."""
        return [seam for seam in self.seams if {seam.left, seam.right} == {one, two}]


def plan_rooms(boundary: Boundary, labels: Labels, tree: RoomGroup) -> FloorPlan | None:
    """The plan of a division into rooms; None when a room is too small, too thin, or touches itself at a corner."""
    rooms = []
    for number, leaf in enumerate(iter_leaves(tree), OUTSIDE + 1):
        cells = labels == number
        area = float(cells.sum()) * boundary.scale**2
        polygon = _outline(cells, boundary.scale)
        if polygon is None or area < AREA_MIN_M2 or not _holds(cells, _CORE_M[leaf.room], boundary.scale):
            return None
        if leaf.room == BATHROOM and area > _BATH_MAX_M2:
            return None
        rooms.append(RoomPlan(number, leaf.room, polygon, area))
    return FloorPlan(tuple(rooms), _seams(labels, boundary.scale), labels, boundary.scale)


def plan_quality(division: Labels, tree: RoomGroup) -> float:
    """How well rooms fit their shares, and how nearly they are rectangles: higher is better, 2 at most."""
    total, ideal = float((division > 0).sum()), _shares(tree, 1.0)
    fit, shape = 0.0, 0.0
    for number, share in enumerate(ideal, OUTSIDE + 1):
        cells = division == number
        actual = float(cells.sum()) / total
        fit += min(actual, share)
        shape += actual * largest_rectangle(cells) / max(float(cells.sum()), 1.0)
    return fit + shape


def _shares(tree: RoomGroup, share: float) -> list[float]:
    whole = sum(part.ratio for part in tree.parts)
    shares: list[float] = []
    for part in tree.parts:
        mine = share * part.ratio / whole
        shares += _shares(part, mine) if isinstance(part, RoomGroup) else [mine]
    return shares


def _runs(cells: Cells) -> list[tuple[int, int]]:
    """(width, depth) of every rectangle of true cells that cannot be extended to the right."""
    ny, nx = cells.shape
    sums = np.zeros((ny + 1, nx + 1), dtype=int)
    sums[1:, 1:] = cells.cumsum(0).cumsum(1)
    found = []
    for j in range(ny):
        for i in range(nx):
            wide = nx - i
            for v in range(j + 1, ny + 1):
                while wide and sums[v, i + wide] - sums[j, i + wide] - sums[v, i] + sums[j, i] < wide * (v - j):
                    wide -= 1
                if not wide:
                    break
                found.append((wide, v - j))
    return found


def largest_rectangle(cells: Cells) -> int:
    """Number of cells of the largest rectangle."""
    return max((w * d for w, d in _runs(cells)), default=0)


def _holds(cells: Cells, core: Vec2, scale: float) -> bool:
    low, high = (math.ceil(side / scale - 1e-6) for side in core)
    return any(min(run) >= low and max(run) >= high for run in _runs(cells))


def _corner(i: int, j: int, scale: float) -> Vec2:
    return (round(i * scale, 4), round(j * scale, 4))


def _outline(cells: Cells, scale: float) -> tuple[Vec2, ...] | None:
    """The outline counter-clockwise; None when the cells have a hole, are not connected or touch at a corner."""
    ny, nx = cells.shape
    full = np.pad(cells, 1)
    after: dict[tuple[int, int], tuple[int, int]] = {}
    for j in range(ny):
        for i in range(nx):
            if cells[j, i]:
                sides = (
                    (full[j, i + 1], (i, j), (i + 1, j)),
                    (full[j + 1, i + 2], (i + 1, j), (i + 1, j + 1)),
                    (full[j + 2, i + 1], (i + 1, j + 1), (i, j + 1)),
                    (full[j + 1, i], (i, j + 1), (i, j)),
                )
                for covered, start, end in sides:
                    if not covered:
                        if start in after:
                            return None
                        after[start] = end
    if not after:
        return None
    first = min(after)
    ring, at = [first], after.pop(first)
    while at != first:
        ring.append(at)
        at = after.pop(at)
    if after:
        return None
    turns = []
    for k, (x, y) in enumerate(ring):
        (px, py), (qx, qy) = ring[k - 1], ring[(k + 1) % len(ring)]
        if (x - px) * (qy - y) != (y - py) * (qx - x):
            turns.append(_corner(x, y, scale))
    return tuple(turns)


def _seams(labels: Labels, scale: float) -> tuple[Seam, ...]:
    """Every straight stretch between two rooms, or a room and outdoors, cut where either side changes."""
    full = np.where(np.pad(labels, 1) == 0, OUTSIDE, np.pad(labels, 1))
    ny, nx = labels.shape
    seams: list[Seam] = []
    for i in range(nx + 1):  # upright lines, upwards: left of them is column i - 1
        pairs = [(int(full[j + 1, i]), int(full[j + 1, i + 1])) for j in range(ny)]
        seams += [Seam(_corner(i, s, scale), _corner(i, e, scale), *pair) for s, e, pair in _stretches(pairs)]
    for j in range(ny + 1):  # level lines, to the right: left of them is row j
        pairs = [(int(full[j + 1, i + 1]), int(full[j, i + 1])) for i in range(nx)]
        seams += [Seam(_corner(s, j, scale), _corner(e, j, scale), *pair) for s, e, pair in _stretches(pairs)]
    return tuple(seams)


def _stretches(pairs: list[tuple[int, int]]) -> list[tuple[int, int, tuple[int, int]]]:
    found, start = [], 0
    for k in range(1, len(pairs) + 1):
        if k == len(pairs) or pairs[k] != pairs[start]:
            if pairs[start][0] != pairs[start][1]:
                found.append((start, k, pairs[start]))
            start = k
    return found
