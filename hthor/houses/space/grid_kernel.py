"""Compiled walks over a grid of free and blocked cells.

Coordinates are in cells unless a parameter says otherwise: cell (i, j) is the square from (i, j) to (i + 1, j + 1), and
``free[j, i]`` says whether it is free; off the grid nothing is free. A cell's edge belongs to both its sides.
"""

import math
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

EPS = 2e-5
"""Slack [cells] at blocked cells' edges, so that rounding does not stop a body that slides along an edge."""


@numba.njit(cache=True)
def cells_in_polygon(polygon: Floats, ox: float, oy: float, cell: float, ny: int, nx: int, slack: float) -> Any:
    """Cells whose middle lies in the polygon, or within ``slack`` of it (tested at the corners of a small square)."""
    out = np.zeros((ny, nx), dtype=np.bool_)
    for j in range(ny):
        for i in range(nx):
            for k in range(1 if slack == 0.0 else 4):
                x = ox + (i + 0.5) * cell + (slack if k & 1 else -slack)
                y = oy + (j + 0.5) * cell + (slack if k & 2 else -slack)
                odd = False
                n = len(polygon)
                for e in range(n):
                    ax, ay = polygon[e, 0], polygon[e, 1]
                    bx, by = polygon[(e + 1) % n, 0], polygon[(e + 1) % n, 1]
                    if (ay > y) != (by > y) and x < (bx - ax) * (y - ay) / (by - ay) + ax:
                        odd = not odd
                if odd:
                    out[j, i] = True
                    break
    return out


@numba.njit(cache=True)
def clear_cells(indoors: Any, rectangles: Floats, ox: float, oy: float, cell: float, radius: float) -> Any:
    """The indoor cells whose middle is at least ``radius`` [m] from every rectangle (and in none)."""
    out = indoors.copy()
    ny, nx = out.shape
    for k in range(len(rectangles)):
        cx, cy, hw, hd, yaw = rectangles[k]
        cos, sin = math.cos(yaw), math.sin(yaw)
        ex = abs(cos) * hw + abs(sin) * hd + radius
        ey = abs(sin) * hw + abs(cos) * hd + radius
        for j in range(max(0, int((cy - ey - oy) / cell) - 1), min(ny, int((cy + ey - oy) / cell) + 2)):
            for i in range(max(0, int((cx - ex - ox) / cell) - 1), min(nx, int((cx + ex - ox) / cell) + 2)):
                dx, dy = ox + (i + 0.5) * cell - cx, oy + (j + 0.5) * cell - cy
                u = max(abs(cos * dx + sin * dy) - hw, 0.0)
                v = max(abs(cos * dy - sin * dx) - hd, 0.0)
                if u * u + v * v < radius * radius or (u == 0.0 and v == 0.0):
                    out[j, i] = False
    return out


@numba.njit(cache=True)
def is_open(free: Any, i: int, j: int) -> bool:
    """Whether the cell is on the grid and free."""
    return 0 <= j < free.shape[0] and 0 <= i < free.shape[1] and bool(free[j, i])


@numba.njit(cache=True)
def is_free_point(free: Any, x: float, y: float) -> bool:
    """Whether the point lies in a free cell or on its edge, and not where two blocked cells meet corner to corner."""
    i0, i1 = math.floor(x - EPS), math.floor(x + EPS)
    j0, j1 = math.floor(y - EPS), math.floor(y + EPS)
    a, d = is_open(free, i0, j0), is_open(free, i1, j1)
    if i0 == i1 or j0 == j1:
        return bool(a or d)
    b, c = is_open(free, i1, j0), is_open(free, i0, j1)
    if a == d and b == c and a != b:
        return False
    return bool(a or b or c or d)


@numba.njit(cache=True)
def are_free_points(free: Any, places: Floats) -> Any:
    """(N,) bool: `is_free_point` for each of the places (N, 2)."""
    out = np.empty(len(places), dtype=np.bool_)
    for k in range(len(places)):
        out[k] = is_free_point(free, places[k, 0], places[k, 1])
    return out


@numba.njit(cache=True)
def nearest_free_cell(free: Any, ox: float, oy: float, cell: float, x: float, y: float) -> Any:
    """Row and column of the free cell with its middle nearest to a point [m], the first of equals; -1 for none."""
    row, column, least = -1, -1, math.inf
    for j in range(free.shape[0]):
        dy = oy + (j + 0.5) * cell - y
        if dy * dy > least:
            continue
        for i in range(free.shape[1]):
            if free[j, i]:
                dx = ox + (i + 0.5) * cell - x
                apart = dx * dx + dy * dy
                if apart < least:
                    row, column, least = j, i, apart
    return row, column


@numba.njit(cache=True)
def cells_within(xs: Floats, ys: Floats, points: Floats, reach: float) -> Any:
    """(ny, nx) bool: which places of a lattice are within ``reach`` of any of the points (N, 2)."""
    out = np.zeros((len(ys), len(xs)), dtype=np.bool_)
    surely, hardly = reach * reach * (1.0 - 1e-12), reach * reach * (1.0 + 1e-12)
    for j in range(len(ys)):
        for i in range(len(xs)):
            for k in range(len(points)):
                dx, dy = xs[i] - points[k, 0], ys[j] - points[k, 1]
                apart = dx * dx + dy * dy
                if apart <= surely or (apart <= hardly and math.hypot(dx, dy) <= reach):
                    out[j, i] = True
                    break
    return out


@numba.njit(cache=True)
def label_at(free: Any, labels: Any, x: float, y: float) -> int:
    """The label of the free cell that contains the point, edges included; 0 when there is no such cell."""
    if is_free_point(free, x, y):
        for j in (math.floor(y - EPS), math.floor(y + EPS)):
            for i in (math.floor(x - EPS), math.floor(x + EPS)):
                if is_open(free, i, j):
                    return int(labels[j, i])
    return 0


@numba.njit(cache=True)
def free_share(free: Any, ax: float, ay: float, bx: float, by: float) -> float:
    """The share of the segment that is free, counted from its beginning: 1.0 when all of it is free."""
    if not is_free_point(free, ax, ay):
        return 0.0
    dx, dy = bx - ax, by - ay
    length = math.sqrt(dx * dx + dy * dy)
    if length == 0.0:
        return 1.0
    far = 1e30
    sx, sy = (1 if dx > 0.0 else -1), (1 if dy > 0.0 else -1)
    nextx = (math.floor(ax) + 1.0) if sx > 0 else (math.ceil(ax) - 1.0)
    nexty = (math.floor(ay) + 1.0) if sy > 0 else (math.ceil(ay) - 1.0)
    tx = (nextx - ax) / dx if dx != 0.0 else far
    ty = (nexty - ay) / dy if dy != 0.0 else far
    stepx = 1.0 / abs(dx) if dx != 0.0 else far
    stepy = 1.0 / abs(dy) if dy != 0.0 else far
    t = 0.0
    while t < 1.0:
        u = min(tx, ty, 1.0)
        if (u - t) * length > EPS:
            m = 0.5 * (t + u)
            x, y = ax + m * dx, ay + m * dy
            i, j = math.floor(x), math.floor(y)
            if not (is_open(free, i, j) or is_free_point(free, x, y)):
                return t
        if u >= 1.0:
            break
        x, y = ax + u * dx, ay + u * dy
        if abs(x - round(x)) <= EPS and abs(y - round(y)) <= EPS and not is_free_point(free, x, y):
            return t
        if tx == u:
            tx += stepx
        if ty == u:
            ty += stepy
        t = u
    return 1.0 if is_free_point(free, bx, by) else t
