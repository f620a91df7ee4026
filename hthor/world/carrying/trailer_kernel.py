"""A rectangle pulled by its handles between obstacles in the plane: position-based dynamics, compiled.

Also the paths, as lists of points, that bearers follow: the point to head for, and the length.

A state is ``(x, y, yaw)`` [m, rad] of a rectangle with half extents ``half`` [m]. Obstacles are rectangles, rows
``(x, y, half width, half depth, yaw)``, and discs, rows ``(x, y, radius)``. Constraints are satisfied one
after another, in several rounds, each by the smallest shift and turn of a thin uniform plate.

For a plate of mass m and half extents a, b, the moment of inertia is m (a² + b²) / 3. A displacement of length l along
the unit vector n, applied at arm r = p × n from the centre, results from the impulse that shifts the centre by
l / (1 + r² k) and turns it by r k l / (1 + r² k), with k = 3 / (a² + b²); see `_displace`.
"""

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numba
import numpy as np

from hthor.geometry.ray_casting import Floats
from hthor.types import Vec2

_END_SLACK_M, _TOLERANCE_M = 0.005, 1e-6
"""[m] How much closer than its margin to a rectangle a line may start or end; the largest error that counts as 0."""
_PULL_ROUNDS, _PUSH_ROUNDS, _WALL_PASSES = 12, 6, 2
"""Rounds of pulling the thing and pushing it out of obstacles; rounds of pushing only; passes over walls per round."""
MARGINS_M = (0.25, 0.15, 0.05)
"""[m] Clearances from corners that a follower tries to keep, the largest first; our choice."""
AHEAD_M = 0.25
"""[m] A point nearer than this gives no useful direction."""
TAUT_MARGIN_M = 0.05
"""[m] Clearance from corners when a path is pulled taut."""


@numba.njit(cache=True)
def _displace(state: Floats, half: Floats, px: float, py: float, dx: float, dy: float) -> None:
    """Shift and turn the rectangle so that its point (px, py) moves by (dx, dy) [m]."""
    length = math.hypot(dx, dy)
    if length < 1e-12:
        return
    nx, ny = dx / length, dy / length
    arm = (px - state[0]) * ny - (py - state[1]) * nx
    ease = 3.0 / (half[0] * half[0] + half[1] * half[1])
    share = length / (1.0 + arm * arm * ease)
    state[0] += nx * share
    state[1] += ny * share
    state[2] += arm * share * ease


@numba.njit(cache=True)
def _corner(cx: float, cy: float, a: float, b: float, cos: float, sin: float, k: int) -> Any:
    u = a if k == 0 or k == 3 else -a
    v = b if k < 2 else -b
    return cx + cos * u - sin * v, cy + sin * u + cos * v


@numba.njit(cache=True)
def _within(x: float, y: float, cos: float, sin: float, a: float, b: float) -> bool:
    return abs(cos * x + sin * y) <= a + _TOLERANCE_M and abs(cos * y - sin * x) <= b + _TOLERANCE_M


@numba.njit(cache=True)
def rectangle_contact(state: Floats, half: Floats, row: Floats) -> Any:
    """Depth [m] of the overlap with another rectangle (0 for none), the direction out of it, and the contact point."""
    dx, dy = row[0] - state[0], row[1] - state[1]
    if math.hypot(dx, dy) > math.hypot(half[0], half[1]) + math.hypot(row[2], row[3]):
        return 0.0, 0.0, 0.0, 0.0, 0.0
    ca, sa, cb, sb = math.cos(state[2]), math.sin(state[2]), math.cos(row[4]), math.sin(row[4])
    c, s = abs(ca * cb + sa * sb), abs(ca * sb - sa * cb)
    deep, nx, ny = np.inf, 0.0, 0.0
    for k in range(4):
        ax, ay = (ca, sa) if k == 0 else (-sa, ca) if k == 1 else (cb, sb) if k == 2 else (-sb, cb)
        if k < 2:
            mine = half[k]
            other = row[2] * c + row[3] * s if k == 0 else row[2] * s + row[3] * c
        else:
            mine = half[0] * c + half[1] * s if k == 2 else half[0] * s + half[1] * c
            other = row[k]
        along = dx * ax + dy * ay
        over = mine + other - abs(along)
        if over <= 0.0:
            return 0.0, 0.0, 0.0, 0.0, 0.0
        if over < deep:
            way = -1.0 if along > 0.0 else 1.0
            deep, nx, ny = over, way * ax, way * ay
    px, py, count = 0.0, 0.0, 0
    for k in range(4):
        x, y = _corner(state[0], state[1], half[0], half[1], ca, sa, k)
        if _within(x - row[0], y - row[1], cb, sb, row[2], row[3]):
            px, py, count = px + x, py + y, count + 1
        x, y = _corner(row[0], row[1], row[2], row[3], cb, sb, k)
        if _within(x - state[0], y - state[1], ca, sa, half[0], half[1]):
            px, py, count = px + x, py + y, count + 1
    if count:
        return deep, nx, ny, px / count, py / count
    u = min(max(ca * dx + sa * dy, -half[0]), half[0])
    v = min(max(ca * dy - sa * dx, -half[1]), half[1])
    return deep, nx, ny, state[0] + ca * u - sa * v, state[1] + sa * u + ca * v


@numba.njit(cache=True)
def disc_contact(state: Floats, half: Floats, disc: Floats) -> Any:
    """The same as `rectangle_contact`, for the overlap with a disc."""
    cos, sin = math.cos(state[2]), math.sin(state[2])
    dx, dy = disc[0] - state[0], disc[1] - state[1]
    u, v = cos * dx + sin * dy, cos * dy - sin * dx
    cu, cv = min(max(u, -half[0]), half[0]), min(max(v, -half[1]), half[1])
    px, py = state[0] + cos * cu - sin * cv, state[1] + sin * cu + cos * cv
    gap = math.hypot(disc[0] - px, disc[1] - py)
    if gap >= disc[2]:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    if gap > 1e-9:
        return disc[2] - gap, (px - disc[0]) / gap, (py - disc[1]) / gap, px, py
    if half[0] - abs(u) < half[1] - abs(v):  # its middle is inside: push it out at the nearer side
        way = -1.0 if u > 0.0 else 1.0
        return disc[2] + half[0] - abs(u), way * cos, way * sin, px, py
    way = -1.0 if v > 0.0 else 1.0
    return disc[2] + half[1] - abs(v), -way * sin, way * cos, px, py


@numba.njit(cache=True)
def deepest_contacts(state: Floats, half: Floats, rows: Floats, discs: Floats) -> Any:
    """The greatest depth [m] to which the rectangle overlaps the rectangles, and the discs."""
    wall, body = 0.0, 0.0
    for k in range(len(rows)):
        wall = max(wall, rectangle_contact(state, half, rows[k])[0])
    for k in range(len(discs)):
        body = max(body, disc_contact(state, half, discs[k])[0])
    return wall, body


@numba.njit(cache=True)
def relax(
    state: Floats, half: Floats, ends: Floats, hands: Floats, ropes: Floats, pulls: Floats, rows: Floats, discs: Floats
) -> Any:
    """The rectangle's state after it was pulled to the hands and pushed out of all obstacles.

    Args:
        ends: (N,) positions of the handles along its length [m]. hands: (N, 2) [m] the points that they are pulled to.
        ropes: (N,) [m] how far each hand may be from its handle. pulls: (N,) [m] the most by which one pull moves each
            handle, so that the rectangle slides along obstacles.
        rows: (M, 5) rectangles, discs: (K, 3) discs in the way.
    """
    out = state.copy()
    for turn in range(_PULL_ROUNDS + _PUSH_ROUNDS):
        moved = False
        for k in range(len(ends) if turn < _PULL_ROUNDS else 0):
            gx, gy = out[0] + math.cos(out[2]) * ends[k], out[1] + math.sin(out[2]) * ends[k]
            dx, dy = hands[k, 0] - gx, hands[k, 1] - gy
            far = math.hypot(dx, dy)
            if far > ropes[k] + _TOLERANCE_M:
                share = min(far - ropes[k], pulls[k]) / far
                _displace(out, half, gx, gy, dx * share, dy * share)
                moved = True
        for k in range(len(discs)):
            deep, nx, ny, px, py = disc_contact(out, half, discs[k])
            if deep > _TOLERANCE_M:
                _displace(out, half, px, py, nx * deep, ny * deep)
                moved = True
        for _ in range(_WALL_PASSES):
            stuck = False
            for k in range(len(rows)):
                deep, nx, ny, px, py = rectangle_contact(out, half, rows[k])
                if deep > _TOLERANCE_M:
                    _displace(out, half, px, py, nx * deep, ny * deep)
                    moved = stuck = True
            if not stuck:
                break
        if not moved:
            break
    return out


@numba.njit(cache=True)
def nearby_rectangles(state: Floats, reach: float, rows: Floats) -> Any:
    """The rectangles that come nearer than ``reach`` [m] to its centre."""
    keep = np.zeros(len(rows), np.bool_)
    for k in range(len(rows)):
        cx, cy, hw, hd, yaw = rows[k]
        cos, sin = math.cos(yaw), math.sin(yaw)
        dx, dy = state[0] - cx, state[1] - cy
        u, v = max(abs(cos * dx + sin * dy) - hw, 0.0), max(abs(cos * dy - sin * dx) - hd, 0.0)
        keep[k] = u * u + v * v < reach * reach
    return rows[keep]


@numba.njit(cache=True)
def is_line_blocked(ax: float, ay: float, bx: float, by: float, rows: Floats, margin: float) -> bool:
    """Whether a line between two points [m] comes nearer than ``margin`` [m] to any rectangle.

    If an end of the line is nearer than that to a rectangle, its distance is the margin for this rectangle.
    """
    for k in range(len(rows)):
        cx, cy, hw, hd, yaw = rows[k]
        far = math.hypot(hw, hd) + margin
        if min(ax, bx) > cx + far or max(ax, bx) < cx - far or min(ay, by) > cy + far or max(ay, by) < cy - far:
            continue
        cos, sin = math.cos(yaw), math.sin(yaw)
        ux, uy = cos * (ax - cx) + sin * (ay - cy), cos * (ay - cy) - sin * (ax - cx)
        vx, vy = cos * (bx - cx) + sin * (by - cy), cos * (by - cy) - sin * (bx - cx)
        near = min(
            margin, max(abs(ux) - hw, abs(uy) - hd) - _END_SLACK_M, max(abs(vx) - hw, abs(vy) - hd) - _END_SLACK_M
        )
        low, high = 0.0, 1.0
        for axis in range(2):
            start, way, half = (ux, vx - ux, hw + near) if axis == 0 else (uy, vy - uy, hd + near)
            if abs(way) < 1e-12:
                if abs(start) > half:
                    low = 2.0
                continue
            a, b = (-half - start) / way, (half - start) / way
            low, high = max(low, min(a, b)), min(high, max(a, b))
        if low <= high and min(hw + near, hd + near) > 0.0:
            return True
    return False


def aim_index(path: Sequence[Vec2], obstacles: Floats) -> int:
    """Index of the last point of a path that can be reached in a straight line from its first, clear of corners.

    The clearance is the largest of `MARGINS_M` with which there is such a point at least `AHEAD_M` away.
    """
    for margin in MARGINS_M:
        for there in range(len(path) - 1, 0, -1):
            if there < len(path) - 1 and math.dist(path[0], path[there]) < AHEAD_M:
                break
            if not is_line_blocked(*path[0], *path[there], obstacles, margin):
                return there
    return next((k for k in range(1, len(path)) if math.dist(path[0], path[k]) >= AHEAD_M), len(path) - 1)


def taut_length(path: Sequence[Vec2], obstacles: Floats) -> float:
    """Length [m] of the path when it is pulled taut around walls and furniture."""
    total, here = 0.0, 0
    while here < len(path) - 1:
        there = len(path) - 1
        while there > here + 1 and is_line_blocked(*path[here], *path[there], obstacles, TAUT_MARGIN_M):
            there -= 1
        total, here = total + math.dist(path[here], path[there]), there
    return total


def path_length(path: Sequence[Vec2]) -> float:
    """Length [m] of the path."""
    return math.fsum(math.dist(a, b) for a, b in itertools.pairwise(path))
