"""The outline of a house: whole cells of a grid, some corners cut off."""

import math

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor.houses.generator.draws import Dice

Cells = NDArray[np.bool_]

AREA_M2 = (72.0, 178.0)
"""Least and largest floor area of a house."""
_SIDE = {4: 6.1, 5: 6.4, 6: 7.3, 7: 7.3}
"""Mean length of a side [cells] by number of rooms, so that areas come out as in real ProcTHOR houses."""
_SPREAD = 1.4
_SCALES = (1.6, 2.2)
_STEP_M = 0.05
_CUT_CELLS, _CUT_SIDE = 6, 3


class Boundary(Struct, frozen=True):
    """``cells`` (ny, nx) bool are indoors; each is a square of side ``scale`` [m]."""

    cells: Cells
    scale: float


def draw_boundary(rooms: int, dice: Dice) -> Boundary | None:
    """An outline for so many rooms; None for draws that leave too little or too much floor, or fall apart."""
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
    """Take a small rectangle off one of the four corners."""
    ny, nx = cells.shape
    width = dice.whole(1, min(_CUT_SIDE, nx // 2), "width")
    depth = dice.whole(1, max(1, min(_CUT_SIDE, ny // 2, math.floor(_CUT_CELLS / width))), "depth")
    rows = slice(0, depth) if dice.chance(0.5, "low") else slice(ny - depth, ny)
    columns = slice(0, width) if dice.chance(0.5, "left") else slice(nx - width, nx)
    cells[rows, columns] = False


def is_connected(cells: Cells) -> bool:
    """Whether the true cells hang together by their sides."""
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
