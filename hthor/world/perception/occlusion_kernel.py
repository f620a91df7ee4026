"""Which solid hides a point from an eye, and how far the eye may move while it stays hidden: compiled."""

import math
from typing import Any

import numba
import numpy as np

from hthor.geometry.ray_casting import Floats, Ints
from hthor.world.perception.view_frustum import ViewAxes, mark_spheres_in_view, sphere_in_view


@numba.njit(cache=True, error_model="numpy")
def _box_blocks(box: Floats, px: float, py: float, pz: float, ux: float, uy: float, uz: float) -> bool:
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
def occlusion_leeway(box: Floats, px: float, py: float, pz: float, ux: float, uy: float, uz: float) -> float:
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
def nearby_occluders(
    view: ViewAxes, farthest: float, groups: Floats, spheres: Floats, fixed: int, count: int
) -> tuple[Any, Any]:
    """The solids that reach into the field of view, no farther away than ``farthest``.

    Returns:
        (N,) their indices, in order, and (N, 5) where their middles are from the eye, and the squares of the distances
        and of the radii.
    """
    some, loose = np.empty(groups.shape[1] - 1, dtype=np.bool_), np.empty(count - fixed, dtype=np.bool_)
    mark_spheres_in_view(view, farthest, groups, some)
    mark_spheres_in_view(view, farthest, spheres[:, fixed:count], loose)
    ids, n = np.empty(count + 1, dtype=np.int64), 0
    for c in range(len(some)):
        if some[c]:
            for g in range(int(groups[4, c]), int(groups[4, c + 1])):
                ids[n] = g
                n += sphere_in_view(view, farthest, spheres, g)
    for c in range(len(loose)):
        ids[n] = fixed + c
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
    ux: float, uy: float, uz: float, first: float, end: float, last: int, ids: Ints, rel: Floats, boxes: Floats
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
