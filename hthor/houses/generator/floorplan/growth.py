"""Draws the outline of a house, cells of a grid with some corners cut off, and grows rooms on these cells.

Rooms grow after Lopes et al. 2010: first as rectangles, then to L-shapes.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor.houses.generator.draws import Dice
from hthor.houses.generator.floorplan.room_specs import RoomGroup, RoomLeaf, iter_leaves

Cells = NDArray[np.bool_]

AREA_M2 = (72.0, 178.0)
"""Least and largest floor area of a house."""
_SIDE = {4: 6.1, 5: 6.4, 6: 7.3, 7: 7.3}
"""Mean length of a side [cells] by number of rooms, so that areas come out as in real ProcTHOR houses."""
_SPREAD = 1.4
_SCALES = (1.6, 2.2)
_STEP_M = 0.05
_CUT_CELLS, _CUT_SIDE = 6, 3
Labels = NDArray[np.int32]
_FILL = 0.9
"""A rectangle stops growing at this share of its room's intended floor area."""


class Boundary(Struct, frozen=True):
    """``cells`` (ny, nx) bool are indoors; each is a square of side ``scale`` [m]."""

    cells: Cells
    scale: float


def draw_boundary(rooms: int, dice: Dice) -> Boundary | None:
    """An outline for this number of rooms; None for draws with too little, too much or unconnected floor."""
    mean = _SIDE[rooms]
    nx, ny = (round(dice.between(mean - _SPREAD, mean + _SPREAD, axis)) for axis in ("nx", "ny"))
    cells = np.ones((ny, nx), dtype=bool)
    for number in range(round(10 * dice.beta(rooms / 2, 6.0, "cuts"))):
        _cut(cells, dice.of("cut", number))
    scale = round(dice.between(*_SCALES, "scale") / _STEP_M) * _STEP_M
    area = float(cells.sum()) * scale**2
    if not AREA_M2[0] <= area <= AREA_M2[1] or not is_connected(cells):
        return None
    return Boundary(cells, round(scale, 2))


def _cut(cells: Cells, dice: Dice) -> None:
    """Remove a small rectangle at one of the four corners."""
    ny, nx = cells.shape
    width = dice.whole(1, min(_CUT_SIDE, nx // 2), "width")
    depth = dice.whole(1, max(1, min(_CUT_SIDE, ny // 2, math.floor(_CUT_CELLS / width))), "depth")
    rows = slice(0, depth) if dice.chance(0.5, "low") else slice(ny - depth, ny)
    columns = slice(0, width) if dice.chance(0.5, "left") else slice(nx - width, nx)
    cells[rows, columns] = False


def is_connected(cells: Cells) -> bool:
    """Whether the true cells are connected by their sides."""
    todo = np.argwhere(cells)
    if not len(todo):
        return False
    stack, seen = [(int(todo[0][0]), int(todo[0][1]))], np.zeros_like(cells)
    seen[stack[0]] = True
    while stack:
        j, i = stack.pop()
        for v, u in ((j + 1, i), (j - 1, i), (j, i + 1), (j, i - 1)):
            if 0 <= v < cells.shape[0] and 0 <= u < cells.shape[1] and cells[v, u] and not seen[v, u]:
                seen[v, u] = True
                stack.append((v, u))
    return bool((seen == cells).all())


def grow_rooms(cells: Cells, tree: RoomGroup, dice: Dice, first: int = 2) -> Labels | None:
    """(ny, nx) numbers of rooms, counted from ``first`` in the order of the tree's leaves; 0 outdoors.

    None when a room found no place.
    """
    labels: Labels = np.zeros(cells.shape, dtype=np.int32)
    return labels if _share_out(labels, cells, tree, first, dice) else None


def _share_out(labels: Labels, region: Cells, part: RoomLeaf | RoomGroup, first: int, dice: Dice) -> bool:
    if not region.any():
        return False
    if isinstance(part, RoomLeaf):
        labels[region] = first
        return True
    shares = _divide(region, [child.ratio for child in part.parts], dice)
    if shares is None:
        return False
    for number, child in enumerate(part.parts):
        if not _share_out(labels, shares == number + 1, child, first, dice.of("part", number)):
            return False
        first += sum(1 for _ in iter_leaves(child))
    return True


def _divide(region: Cells, ratios: Sequence[float], dice: Dice) -> Labels | None:
    """Divide a region among parts, numbered from 1; None when the parts' first cells find no place."""
    owner: Labels = np.where(region, 0, -1).astype(np.int32)
    boxes: list[list[int]] = []
    for number in range(len(ratios)):
        seed = _seed(owner, dice.of("seed", number))
        if seed is None:
            return None
        owner[seed] = number + 1
        boxes.append([seed[0], seed[0], seed[1], seed[1]])
    due = [ratio / sum(ratios) * float(region.sum()) for ratio in ratios]
    _run(owner, boxes, due, dice.of("rectangles"), whole=True)
    _run(owner, boxes, [float("inf")] * len(due), dice.of("shapes"), whole=False)
    _adopt(owner)
    return owner


def _seed(owner: Labels, dice: Dice) -> tuple[int, int] | None:
    """A free cell, away from other seeds if there is one."""
    free = owner == 0
    taken = np.pad(owner > 0, 1)
    ny, nx = owner.shape
    near = np.zeros_like(free)
    for dv in range(3):
        for du in range(3):
            near |= taken[dv : dv + ny, du : du + nx]
    options = np.argwhere(free & ~near)
    if not len(options):
        options = np.argwhere(free)
    if not len(options):
        return None
    row, column = options[dice.whole(0, len(options) - 1)]
    return int(row), int(column)


def _run(owner: Labels, boxes: list[list[int]], due: Sequence[float], dice: Dice, *, whole: bool) -> None:
    """Let parts grow in turn, larger parts more often, until none can grow."""
    weights = [1.0 if limit == float("inf") else limit for limit in due]
    alive = [True] * len(boxes)
    for step in range(400):
        if not any(alive):
            return
        number = dice.weighted(range(len(boxes)), [w if a else 0.0 for w, a in zip(weights, alive, strict=True)], step)
        area = int((owner == number + 1).sum())
        grown = area < _FILL * due[number] and _extend(owner, boxes[number], number + 1, dice.of(step), whole)
        alive[number] = grown


def _sides(box: list[int], owner: Labels) -> list[tuple[int, int, Any]]:
    """The lines of cells beyond the four sides of a box: the bound that moves, its new value, and the cells."""
    j0, j1, i0, i1 = box
    ny, nx = owner.shape
    lines: list[tuple[int, int, Any]] = []
    if j0 > 0:
        lines.append((0, j0 - 1, (slice(j0 - 1, j0), slice(i0, i1 + 1))))
    if j1 < ny - 1:
        lines.append((1, j1 + 1, (slice(j1 + 1, j1 + 2), slice(i0, i1 + 1))))
    if i0 > 0:
        lines.append((2, i0 - 1, (slice(j0, j1 + 1), slice(i0 - 1, i0))))
    if i1 < nx - 1:
        lines.append((3, i1 + 1, (slice(j0, j1 + 1), slice(i1 + 1, i1 + 2))))
    return lines


def _extend(owner: Labels, box: list[int], mark: int, dice: Dice, whole: bool) -> bool:
    """Grow one part by the longest possible side; if not ``whole``, a free stretch of a side is enough."""
    best: tuple[float, int, int, Any] | None = None
    for bound, value, where in _sides(box, owner):
        free = owner[where] == 0
        count = int(free.sum())
        if count == 0 or (whole and not free.all()) or (not whole and not _touches(owner, where, free, bound, mark)):
            continue
        score = count + dice.unit(bound)
        if best is None or score > best[0]:
            best = (score, bound, value, where)
    if best is None:
        return False
    _, bound, value, where = best
    view = owner[where]
    view[view == 0] = mark
    box[bound] = value
    return True


def _touches(owner: Labels, where: Any, free: Cells, bound: int, mark: int) -> bool:
    """Whether every free cell of the line borders on the part itself."""
    rows, columns = where
    dj, di = ((1, 0), (-1, 0), (0, 1), (0, -1))[bound]
    inner = owner[rows.start + dj : rows.stop + dj, columns.start + di : columns.stop + di] == mark
    return bool((inner | ~free).all())


def _adopt(owner: Labels) -> None:
    """Give cells that are left over to a neighbour, the smallest first."""
    while True:
        left = np.argwhere(owner == 0)
        taken = False
        for j, i in left:
            around = [
                int(owner[v, u])
                for v, u in ((j + 1, i), (j - 1, i), (j, i + 1), (j, i - 1))
                if 0 <= v < owner.shape[0] and 0 <= u < owner.shape[1] and owner[v, u] > 0
            ]
            if around:
                owner[j, i] = min(around, key=lambda mark: (int((owner == mark).sum()), mark))
                taken = True
        if not len(left) or not taken:
            return
