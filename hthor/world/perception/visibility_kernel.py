"""Compiled: finds the targets that an eye sees by testing range, then field of view, then lines of sight.

One call handles all targets and takes a few microseconds. Loops over balls, points and solids avoid branches where they
can, so that they compile to vector instructions.
"""

import math

import numba
import numpy as np

from hthor.geometry.ray_casting import Bools, Floats, Ints
from hthor.world.perception.occlusion_kernel import first_occluder, nearby_occluders, occlusion_leeway
from hthor.world.perception.view_frustum import ViewAxes, in_frame, mark_spheres_in_view, view_axes


@numba.njit(cache=True, error_model="numpy")
def _mark_fixed_targets(
    view: ViewAxes, reach: float, balls: Floats, points: Floats, out: Bools, marked: Bools
) -> float:
    """Mark targets in reach that never move, and their points to be tested; returns the largest squared distance.

    A point must be tested if it is in the field of view and not known to be still hidden.
    """
    ex, ey, ez, fx, fy, fz = view[0], view[1], view[2], view[3], view[4], view[5]
    lx, ly, lz, ux, uy, uz, w, h = view[6], view[7], view[8], view[9], view[10], view[11], view[12], view[13]
    likely = np.empty(len(out), dtype=np.bool_)
    mark_spheres_in_view(view, reach, balls, likely)
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
def _mark_moving_target(view: ViewAxes, reach: float, small: bool, points: Floats, k: int, marked: Bools) -> float:
    """Mark the points in the field of view of a target in reach; returns the largest squared distance, or 0.

    A target is in reach if either of its points is; a small target, only if its first point is.
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
def visible_targets(
    x: float, y: float, z: float, yaw: float, pitch: float, wide: float, high: float,
    small: int, points: Floats, wanted: Floats, reach: float, balls: Floats, spots: Floats,
    groups: Floats, spheres: Floats, boxes: Floats, fixed: int, count: int, order: Ints, seen: Ints,
) -> int:  # fmt: skip
    """Find the targets in view: any of their points is within reach, and any is in the field of view and not hidden.

    There are targets that may move, with two points each, and targets that never move.

    Args:
        x, y, z: the eye [m]. yaw, pitch: its direction [rad]. wide, high: tangents of half the fields of view.
        small: how many of the targets that may move, counted from the first, are in reach only by their first point.
        points: (M, 2, 3) [m] of the targets that may move. wanted: (M, 3) for each, its reach [m] from the eye, 0 or
            less if it is absent, and the range of its own geoms, which do not hide it.
        reach: [m] of the targets that never move. balls: (7, S + 1) for each, middle and radius [m] of a ball around
            its points, range of its own geoms, and index of its first spot; the last column only marks the end.
        spots: (6, Q) points [m] of the targets that never move; and, updated by each call and initially zero, the place
            x and y [m] of the eye when the point was found hidden, and the distance [m] from there within which it
            stays hidden. The eye always has the same height.
        groups, spheres, boxes, fixed, count: `hthor.world.perception.occluders.Occluders.arrays`.
        order: (M + S,) the order in which targets are returned; targets that may move have the lower numbers.
        seen: filled with the targets in view; it has room for one more than there are targets.

    Returns:
        how many targets are in view.
    """
    view = view_axes(x, y, z, yaw, pitch, wide, high)
    moving, still = len(points), balls.shape[1] - 1
    out = np.zeros(moving + still, dtype=np.bool_)
    aimed, marked = np.zeros((moving, 2), dtype=np.bool_), np.empty(spots.shape[1], dtype=np.bool_)
    named, farthest = 0, 0.0
    if still and reach > 0.0:
        farthest = _mark_fixed_targets(view, reach, balls, spots, out[moving:], marked)
    for k in range(moving):
        if wanted[k, 0] > 0.0:
            most = _mark_moving_target(view, wanted[k, 0], k < small, points, k, aimed)
            out[k] = most > 0.0
            farthest = max(farthest, most)
    if farthest == 0.0:
        return 0
    ids, rel = nearby_occluders(view, math.sqrt(farthest), groups, spheres, fixed, count)
    last = -1  # the solid that hid one point probably hides the next
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
                if ids[by] < fixed:
                    leeway = occlusion_leeway(boxes[ids[by]], rel[by, 0], rel[by, 1], rel[by, 2], ux, uy, uz)
                    spots[3, p], spots[4, p], spots[5, p] = x, y, leeway
    for k in order:
        seen[named] = k
        named += out[k]
    return named
