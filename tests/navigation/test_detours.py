"""Laws of detours: they keep out of discs and on free floor, end where they should, and are not longer than allowed."""

from __future__ import annotations

import itertools
import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hthor.navigation.detours import detour

CELL, SIZE = 0.05, 80
ORIGIN = (-1.0, 2.0)
WALL_COLUMN, DOOR = 40, slice(30, 46)


def hall(door: bool = True) -> np.ndarray:
    """A floor of 4 m by 4 m with a wall across the middle, and a doorway of 0.8 m in it."""
    free = np.zeros((SIZE, SIZE), dtype=bool)
    free[1:-1, 1:-1] = True
    free[:, WALL_COLUMN] = False
    if door:
        free[DOOR, WALL_COLUMN] = True
    return free


def place(column: float, row: float) -> tuple[float, float]:
    return (ORIGIN[0] + column * CELL, ORIGIN[1] + row * CELL)


def samples(way: list[tuple[float, float]]) -> list[tuple[float, float]]:
    shares = np.linspace(0.0, 1.0, 60)
    return [(a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])) for a, b in itertools.pairwise(way) for s in shares]


def length(way: list[tuple[float, float]]) -> float:
    return math.fsum(math.dist(a, b) for a, b in itertools.pairwise(way))


cells = st.integers(2, SIZE - 3).map(lambda cell: cell + 0.5)
discs = st.lists(st.tuples(cells, cells, st.floats(0.1, 0.5)), max_size=3)


@given(cells, cells, cells, cells, discs)
def test_a_detour_keeps_out_of_discs_and_on_free_floor(x0, y0, x1, y1, bodies):
    free, here, goal = hall(), place(x0, y0), place(x1, y1)
    if int(x0) == WALL_COLUMN or int(x1) == WALL_COLUMN:
        return
    rings = [(*place(x, y), radius) for x, y, radius in bodies]
    way = detour(free, ORIGIN, CELL, here, goal, rings, 20.0)
    if not way:
        return
    assert way[-1] == goal
    points = samples([here, *way])
    for x, y in points:
        row, column = math.floor((y - ORIGIN[1]) / CELL), math.floor((x - ORIGIN[0]) / CELL)
        assert free[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2].any()
    inside_at_first = max((radius - math.dist((x, y), here) for x, y, radius in rings), default=0.0)
    if inside_at_first < 0.0 and all(math.dist((x, y), goal) > radius for x, y, radius in rings):
        for x, y, radius in rings:
            assert min(math.dist((x, y), point) for point in points) > radius - 2.0 * CELL


def test_somebody_in_the_only_doorway_leaves_no_way():
    here, goal = place(20.5, 38.5), place(60.5, 38.5)
    assert detour(hall(), ORIGIN, CELL, here, goal, (), 9.0)
    assert not detour(hall(door=False), ORIGIN, CELL, here, goal, (), 9.0)
    assert not detour(hall(), ORIGIN, CELL, here, goal, [(*place(40.5, 38.0), 0.5)], 9.0)


def test_a_detour_is_not_longer_than_allowed():
    here, goal = place(20.5, 5.5), place(60.5, 5.5)
    (way,) = (detour(hall(), ORIGIN, CELL, here, goal, (), 9.0),)
    far = length([here, *way])
    assert far > math.dist(here, goal)
    assert detour(hall(), ORIGIN, CELL, here, goal, (), 1.15 * far)
    assert not detour(hall(), ORIGIN, CELL, here, goal, (), 0.9 * far)


def test_who_stands_in_a_disc_may_leave_it():
    here, goal = place(10.5, 40.5), place(30.5, 40.5)
    way = detour(hall(), ORIGIN, CELL, here, goal, [(here[0] - 0.1, here[1], 0.4)], 9.0)
    assert way[-1] == goal
