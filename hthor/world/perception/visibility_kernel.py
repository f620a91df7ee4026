"""What an eye sees: range first, then the field of view, then rays.

All candidates of one look go through one compiled call, which takes a few microseconds. Whatever can be is done for
many balls, points or solids at once, row by row and without branches, so that it becomes vector instructions.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np


@numba.njit(cache=True, error_model="numpy")
def view_axes(x: float, y: float, z: float, yaw: float, pitch: float, wide: float, high: float) -> Any:
    """An eye [m], its forward, left and up axes, and the tangents of half its fields of view: 14 numbers."""
    cy, sy, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    return x, y, z, cp * cy, cp * sy, sp, -sy, cy, 0.0, -sp * cy, -sp * sy, cp, wide, high


@numba.njit(cache=True, error_model="numpy")
def in_frame(view: Any, dx: float, dy: float, dz: float) -> bool:
    """Whether a point at (dx, dy, dz) [m] from the eye is in the field of view."""
    ahead = dx * view[3] + dy * view[4] + dz * view[5]
    left = dx * view[6] + dy * view[7] + dz * view[8]
    up = dx * view[9] + dy * view[10] + dz * view[11]
    return bool((ahead > 0.0) & (abs(left) <= ahead * view[12]) & (abs(up) <= ahead * view[13]))


@numba.njit(cache=True, error_model="numpy")
def _sphere_in_view(view: Any, reach: float, balls: Any, i: int) -> bool:
    """Whether ball ``i`` of (4, N), middles and radii [m], is, in part, within reach and in the field of view."""
    ex, ey, ez, fx, fy, fz = view[0], view[1], view[2], view[3], view[4], view[5]
    lx, ly, lz, ux, uy, uz, w, h = view[6], view[7], view[8], view[9], view[10], view[11], view[12], view[13]
    dx, dy, dz, size = balls[0, i] - ex, balls[1, i] - ey, balls[2, i] - ez, balls[3, i]
    limit = reach + size
    ahead = dx * fx + dy * fy + dz * fz
    left = dx * lx + dy * ly + dz * lz
    up = dx * ux + dy * uy + dz * uz
    near = (dx * dx + dy * dy + dz * dz <= limit * limit) & (ahead >= -size)
    aside = abs(left) - ahead * w <= size * math.sqrt(1.0 + w * w)
    return bool(near & aside & (abs(up) - ahead * h <= size * math.sqrt(1.0 + h * h)))


@numba.njit(cache=True, error_model="numpy")
def _mark_spheres_in_view(view: Any, reach: float, balls: Any, out: Any) -> None:
    """Mark the balls of which this is so."""
    for i in range(len(out)):
        out[i] = _sphere_in_view(view, reach, balls, i)


@numba.njit(cache=True, error_model="numpy")
def _mark_fixed_targets(view: Any, reach: float, balls: Any, points: Any, out: Any, marked: Any) -> float:
    """Of targets that never move, mark those in reach that have points to look at, and these; the farthest, squared.

    A point is looked at when it is in the field of view and not sure to be hidden still.
    """
    ex, ey, ez, fx, fy, fz = view[0], view[1], view[2], view[3], view[4], view[5]
    lx, ly, lz, ux, uy, uz, w, h = view[6], view[7], view[8], view[9], view[10], view[11], view[12], view[13]
    likely = np.empty(len(out), dtype=np.bool_)
    _mark_spheres_in_view(view, reach, balls, likely)
    farthest = 0.0
    for k in range(len(out)):
        if not likely[k]:
            continue
        least, most = math.inf, 0.0
        for p in range(int(balls[6, k]), int(balls[6, k + 1])):
            dx, dy, dz = points[0, p] - ex, points[1, p] - ey, points[2, p] - ez
            d2 = dx * dx + dy * dy + dz * dz
            ahead = dx * fx + dy * fy + dz * fz
            left = dx * lx + dy * ly + dz * lz
            up = dx * ux + dy * uy + dz * uz
            wx, wy = points[3, p] - ex, points[4, p] - ey
            inside = (ahead > 0.0) & (abs(left) <= ahead * w) & (abs(up) <= ahead * h)
            marked[p] = inside & (wx * wx + wy * wy >= points[5, p] * points[5, p])
            least, most = min(least, d2), max(most, d2 * marked[p])
        if most > 0.0 and least <= reach * reach:
            out[k] = True
            farthest = max(farthest, most)
    return farthest


@numba.njit(cache=True, error_model="numpy")
def _mark_moving_target(view: Any, reach: float, small: bool, points: Any, k: int, marked: Any) -> float:
    """Mark the points of a target in reach that are in the field of view; the squared distance of the farther, or 0.

    A target is in reach by either of its points, a small one only by its first.
    """
    near, most = False, 0.0
    for p in range(2):
        dx, dy, dz = points[k, p, 0] - view[0], points[k, p, 1] - view[1], points[k, p, 2] - view[2]
        d2 = dx * dx + dy * dy + dz * dz
        if p == 0 or not small:
            near |= d2 <= reach * reach
        if small and not near:
            return 0.0
        if in_frame(view, dx, dy, dz):
            marked[k, p] = True
            most = max(most, d2)
    return most if near else 0.0


@numba.njit(cache=True, error_model="numpy")
def _box_blocks(box: Any, px: float, py: float, pz: float, ux: float, uy: float, uz: float) -> bool:
    """Whether a solid whose middle is at (px, py, pz) from the eye meets the line of sight; as
    `hthor.geometry.ray_casting` has it.
    """
    near, far = 0.0, 1.0
    for axis in range(3):
        o = -(box[3 + axis] * px + box[6 + axis] * py + box[9 + axis] * pz)
        v = box[3 + axis] * ux + box[6 + axis] * uy + box[9 + axis] * uz
        end, size = o + v, box[axis]
        if min(o, end) > size or max(o, end) < -size:
            return False
        if abs(v) < 1e-12:
            v = 1e-12
        t1, t2 = (-size - o) / v, (size - o) / v
        if t1 > t2:
            t1, t2 = t2, t1
        near, far = max(near, t1), min(far, t2)
    return near <= far


@numba.njit(cache=True, error_model="numpy")
def _leeway(box: Any, px: float, py: float, pz: float, ux: float, uy: float, uz: float) -> float:
    """How far [m] the eye may go, at the same height, before the line of sight (ux, uy, uz) can miss a solid it meets.

    The line crosses the solid's middle plane, across its thinnest side with the normal n, at a point c. On an axis a of
    that plane c is p - K u / v, p and K being the target's place along a and n, u and v the line's extents along them.
    When the eye goes by d, u changes by d times the horizontal part of a and v by d times that of n, at most; so c
    stays inside as long as d <= s / (K/v (a + u n / v) + s n / v), where s is how far inside it is.
    """
    thin = 0
    for axis in range(1, 3):
        if box[axis] < box[thin]:
            thin = axis
    o = -(box[3 + thin] * px + box[6 + thin] * py + box[9 + thin] * pz)
    v = box[3 + thin] * ux + box[6 + thin] * uy + box[9 + thin] * uz
    if abs(v) < 1e-3 or o * v >= 0.0 or abs(o) >= abs(v):
        return 0.0
    share, flat = -o / v, math.sqrt(box[3 + thin] * box[3 + thin] + box[6 + thin] * box[6 + thin])
    most = abs(o) / flat if flat > 1e-6 else math.inf
    for axis in range(3):
        if axis != thin:
            u = box[3 + axis] * ux + box[6 + axis] * uy + box[9 + axis] * uz
            at = -(box[3 + axis] * px + box[6 + axis] * py + box[9 + axis] * pz) + share * u
            slack = box[axis] - abs(at)
            aside = math.sqrt(box[3 + axis] * box[3 + axis] + box[6 + axis] * box[6 + axis])
            if slack <= 0.0:
                return 0.0
            pull = (1.0 - share) * (aside + abs(u) * flat / abs(v)) + slack * flat / abs(v)
            most = min(most, slack / max(pull, 1e-9))
    return max(0.0, most - 1e-6)


@numba.njit(cache=True, error_model="numpy")
def nearby_occluders(view: Any, farthest: float, groups: Any, spheres: Any, firm: int, count: int) -> tuple[Any, Any]:
    """The solids that reach into the field of view, no farther away than ``farthest``.

    Returns:
        (N,) their indices, in order, and (N, 5) where their middles are from the eye, and the squares of the distances
        and of the radii.
    """
    some, loose = np.empty(groups.shape[1] - 1, dtype=np.bool_), np.empty(count - firm, dtype=np.bool_)
    _mark_spheres_in_view(view, farthest, groups, some)
    _mark_spheres_in_view(view, farthest, spheres[:, firm:count], loose)
    ids, n = np.empty(count + 1, dtype=np.int64), 0
    for c in range(len(some)):
        if some[c]:
            for g in range(int(groups[4, c]), int(groups[4, c + 1])):
                ids[n] = g
                n += _sphere_in_view(view, farthest, spheres, g)
    for c in range(len(loose)):
        ids[n] = firm + c
        n += loose[c]
    rel = np.empty((n, 5))
    for c in range(n):
        g = ids[c]
        dx, dy, dz = spheres[0, g] - view[0], spheres[1, g] - view[1], spheres[2, g] - view[2]
        rel[c, 0], rel[c, 1], rel[c, 2] = dx, dy, dz
        rel[c, 3], rel[c, 4] = dx * dx + dy * dy + dz * dz, 1.000001 * spheres[3, g] * spheres[3, g]
    return ids[:n], rel


@numba.njit(cache=True, error_model="numpy")
def first_occluder(
    ux: float, uy: float, uz: float, first: float, end: float, last: int, ids: Any, rel: Any, boxes: Any
) -> int:
    """What hides the point at (ux, uy, uz) from the eye, -1 for nothing; the test is that of
    `hthor.geometry.ray_casting`.

    Args:
        first, end: the geoms of the target itself, which do not hide it. last: what to try first, -1 for nothing.
    """
    if last >= 0:
        box = boxes[ids[last]]
        if not first <= box[12] < end and _box_blocks(box, rel[last, 0], rel[last, 1], rel[last, 2], ux, uy, uz):
            return last
    length2 = ux * ux + uy * uy + uz * uz
    for c in range(len(ids)):
        px, py, pz = rel[c, 0], rel[c, 1], rel[c, 2]
        along = px * ux + py * uy + pz * uz
        if rel[c, 3] * length2 - along * along > rel[c, 4] * length2:
            continue  # far off the whole line
        if along > length2 and rel[c, 3] - 2.0 * along + length2 > rel[c, 4]:
            continue  # beyond the point
        box = boxes[ids[c]]
        if not first <= box[12] < end and _box_blocks(box, px, py, pz, ux, uy, uz):
            return c
    return -1


@numba.njit(cache=True, error_model="numpy")
def visible_targets(
    x: float,
    y: float,
    z: float,
    yaw: float,
    pitch: float,
    wide: float,
    high: float,
    small: int,
    points: Any,
    wanted: Any,
    reach: float,
    balls: Any,
    spots: Any,
    groups: Any,
    spheres: Any,
    boxes: Any,
    firm: int,
    count: int,
    order: Any,
) -> Any:
    """Which targets are in view: within reach by any of their points, and any point in the field of view and unhidden.

    There are targets that may move, with two points each, and others that never do.

    Args:
        x, y, z: the eye [m]. yaw, pitch: where it looks [rad]. wide, high: tangents of half the fields of view.
        small: how many of those that may move, counted from the front, are in reach only by their first point.
        points: (M, 2, 3) [m]. wanted: (M, 3) reach [m] from the eye, 0 or less for targets that are not there, and the
            range of the target's own geoms, which do not hide it.
        reach: [m] of those that never move. balls: (7, S + 1) middles and radii [m] of balls around the points of each,
            the range of its own geoms, and where its ``spots`` begin; the last column only says where they end.
        spots: (6, Q) their points [m]; and, in and out, zeros at first, where this eye was, x and y [m], when a point
            turned out to be hidden, and how far [m] from there it is sure to be hidden still: the eye always has the
            same height.
        groups, spheres, boxes, firm, count: see `hthor.world.perception.occluders.Occluders`.
        order: (M + S,) in which order to name the targets, those that may move counted first.

    Returns:
        (N,) the targets in view.
    """
    view = view_axes(x, y, z, yaw, pitch, wide, high)
    moving, still = len(points), balls.shape[1] - 1
    out = np.zeros(moving + still, dtype=np.bool_)
    aimed, marked = np.zeros((moving, 2), dtype=np.bool_), np.empty(spots.shape[1], dtype=np.bool_)
    seen, named, farthest = np.empty(len(out) + 1, dtype=np.int64), 0, 0.0
    if still and reach > 0.0:
        farthest = _mark_fixed_targets(view, reach, balls, spots, out[moving:], marked)
    for k in range(moving):
        if wanted[k, 0] > 0.0:
            most = _mark_moving_target(view, wanted[k, 0], k < small, points, k, aimed)
            out[k] = most > 0.0
            farthest = max(farthest, most)
    if farthest == 0.0:
        return seen[:0]
    ids, rel = nearby_occluders(view, math.sqrt(farthest), groups, spheres, firm, count)
    last = -1  # what hid one point probably hides the next
    for k in range(moving):
        if not out[k]:
            continue
        out[k] = False
        for p in range(2):
            if aimed[k, p]:
                ux, uy, uz = points[k, p, 0] - x, points[k, p, 1] - y, points[k, p, 2] - z
                by = first_occluder(ux, uy, uz, wanted[k, 1], wanted[k, 2], last, ids, rel, boxes)
                if by < 0:
                    out[k] = True
                    break
                last = by
    for k in range(still):
        if not out[moving + k]:
            continue
        out[moving + k] = False
        for p in range(int(balls[6, k]), int(balls[6, k + 1])):
            if marked[p]:
                ux, uy, uz = spots[0, p] - x, spots[1, p] - y, spots[2, p] - z
                by = first_occluder(ux, uy, uz, balls[4, k], balls[5, k], last, ids, rel, boxes)
                if by < 0:
                    out[moving + k] = True
                    break
                last = by
                if ids[by] < firm:
                    leeway = _leeway(boxes[ids[by]], rel[by, 0], rel[by, 1], rel[by, 2], ux, uy, uz)
                    spots[3, p], spots[4, p], spots[5, p] = x, y, leeway
    for k in order:
        seen[named] = k
        named += out[k]
    return seen[:named]
