"""Compiled: the solid that hides a point from an eye, and how far the eye can move while the point stays hidden."""

import math
from typing import Any

import numba
import numpy as np

from hthor.geometry.ray_casting import Floats, Ints
from hthor.types import Vec3
from hthor.world.perception.view_frustum import ViewAxes, in_frame, mark_spheres_in_view, sphere_in_view, view_axes

BESIDE_RAD = 0.15
"""[rad] Objects whose directions from the eye differ by no more than this appear close together; our choice."""
_CORNERS = tuple((x, y, z) for x in (-0.8, 0.8) for y in (-0.8, 0.8) for z in (-0.8, 0.8))
"""Corners of a box in half extents, moved inwards so that the support of the box does not hide them."""
_MARGIN = 1.05
"""Factor by which the cone in which occluders are searched is widened, against rounding."""


@numba.njit(cache=True, error_model="numpy")
def _box_blocks(box: Floats, px: float, py: float, pz: float, ux: float, uy: float, uz: float) -> bool:
    """Whether a solid whose middle is at (px, py, pz) from the eye meets the line of sight; the test is that of
    `hthor.geometry.ray_casting`.
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
    """How far [m] the eye can move, at the same height, before its line of sight (ux, uy, uz) can miss a solid.

    The line crosses the solid's middle plane, whose normal n is along the thinnest side, at a point c. On an axis a of
    that plane, c is p - K u / v: p and K are the target's coordinates along a and n, u and v the line's extents along
    them. When the eye moves by d, u changes at most by d times the horizontal part of a, and v by d times that of n. So
    c stays inside if d <= s / (K/v (a + u n / v) + s n / v), where s is the distance of c from the edge.
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
    """The solids that are partly in the field of view, no farther away than ``farthest``.

    Returns:
        (N,) their indices, in order; and (N, 5) their middles relative to the eye, the squared distances and the
        squared radii.
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
    """The solid that hides the point at (ux, uy, uz) from the eye, -1 for none; the test is that of
    `hthor.geometry.ray_casting`.

    Args:
        first, end: the target's own geoms, which do not hide it. last: the solid to try first, -1 for none.
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
            continue  # far from the whole line
        if along > length2 and rel[c, 3] - 2.0 * along + length2 > rel[c, 4]:
            continue  # behind the point
        box = boxes[ids[c]]
        if not first <= box[12] < end and _box_blocks(box, px, py, pz, ux, uy, uz):
            return c
    return -1


def sample_points(position: Vec3, size: Vec3, yaw: float, looked_for: tuple[Vec3, ...]) -> Any:
    """(N, 3) points [m] all over an upright box, the points ``looked_for`` first."""
    (x, y, z), (w, d, h), cos, sin = position, (extent / 2.0 for extent in size), math.cos(yaw), math.sin(yaw)
    corners = [(x + w * a * cos - d * b * sin, y + w * a * sin + d * b * cos, z + h * c) for a, b, c in _CORNERS]
    return np.array([*looked_for, *corners])


@numba.njit(cache=True, error_model="numpy")
def measure(
    x: float, y: float, z: float, yaw: float, pitch: float, wide: float, high: float,
    points: Floats, index: int, others: Floats, wanted: Floats,
    groups: Floats, spheres: Floats, boxes: Floats, fixed: int, count: int,
) -> Any:  # fmt: skip
    """The share of one target's points that are in view, and how many other objects in view appear close to it.

    Args:
        x, y, z, yaw, pitch, wide, high: the eye, see `visibility_kernel.visible_targets`.
        points: (N, 3) [m], all over the target; the first is its middle. index: its row in ``wanted``.
        others: (M, 3) middles [m] of other objects. wanted: (M, 3) of each, 0 or less if it does not count, and the
            range of its own geoms, which do not hide it.
        groups, spheres, boxes, fixed, count: `hthor.world.perception.occluders.Occluders.arrays`.

    Returns:
        (2,) the share, 0 to 1, and the number of other objects.
    """
    view = view_axes(x, y, z, yaw, pitch, wide, high)
    tx, ty, tz = points[0, 0] - x, points[0, 1] - y, points[0, 2] - z
    apart = math.sqrt(tx * tx + ty * ty + tz * tz)
    size, farthest = 0.0, apart
    for p in range(len(points)):
        dx, dy, dz = points[p, 0] - points[0, 0], points[p, 1] - points[0, 1], points[p, 2] - points[0, 2]
        size = max(size, math.sqrt(dx * dx + dy * dy + dz * dz))
    chosen, chosen_count = np.empty(len(others), dtype=np.int64), 0
    for k in range(len(others)):
        ox, oy, oz = others[k, 0] - x, others[k, 1] - y, others[k, 2] - z
        along = ox * tx + oy * ty + oz * tz
        if k == index or wanted[k, 0] <= 0.0 or along <= 0.0:
            continue
        far = math.sqrt(ox * ox + oy * oy + oz * oz)
        if along >= math.cos(BESIDE_RAD) * far * apart and in_frame(view, ox, oy, oz):
            chosen[chosen_count] = k
            chosen_count += 1
            farthest = max(farthest, far)
    # only solids in a narrow cone around the target can hide any of these points
    half = math.tan(min(1.5, max(BESIDE_RAD, math.asin(min(1.0, size / max(apart, 1e-9)))) * _MARGIN))
    cone = view_axes(x, y, z, math.atan2(ty, tx), math.asin(max(-1.0, min(1.0, tz / max(apart, 1e-9)))), half, half)
    ids, rel = nearby_occluders(cone, farthest + size, groups, spheres, fixed, count)
    seen, beside, last = 0, 0, -1
    for p in range(len(points)):
        ux, uy, uz = points[p, 0] - x, points[p, 1] - y, points[p, 2] - z
        if in_frame(view, ux, uy, uz):
            by = first_occluder(ux, uy, uz, wanted[index, 1], wanted[index, 2], last, ids, rel, boxes)
            seen += by < 0
            last = by if by >= 0 else last
    for c in range(chosen_count):
        k = chosen[c]
        ux, uy, uz = others[k, 0] - x, others[k, 1] - y, others[k, 2] - z
        beside += first_occluder(ux, uy, uz, wanted[k, 1], wanted[k, 2], -1, ids, rel, boxes) < 0
    return seen / len(points), beside
