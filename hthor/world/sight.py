"""What an eye sees: range first, then the field of view, then rays; knows nothing of detections or minds.

All candidates of one look go through one compiled call, which takes a few microseconds.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

from hthor.rays import blocked
from hthor.types import BodySpec, Pose, Vec3


def camera(pose: Pose, spec: BodySpec) -> Any:
    """(14,) float64: eye [m], forward, left and up axes (house frame), tangents of half the fields of view."""
    cy, sy, cp, sp = math.cos(pose.yaw), math.sin(pose.yaw), math.cos(pose.pitch), math.sin(pose.pitch)
    tangents = math.tan(spec.fov[0] / 2), math.tan(spec.fov[1] / 2)
    return np.array((pose.x, pose.y, spec.eye, cp * cy, cp * sy, sp, -sy, cy, 0.0, -sp * cy, -sp * sy, cp, *tangents))


def eye(pose: Pose, spec: BodySpec) -> Vec3:
    """Where the eye is [m], house frame."""
    return (pose.x, pose.y, spec.eye)


def points(position: Vec3, size: Vec3) -> tuple[Vec3, Vec3]:
    """Where an object is looked for [m]: its centre and a point near its top."""
    x, y, z = position
    return position, (x, y, z + 0.4 * size[2])


@numba.njit(cache=True)
def see(
    view: Any,
    reach: Any,
    small: int,
    points: Any,
    first: Any,
    own: Any,
    half: Any,
    pos: Any,
    mat: Any,
    radius: Any,
    ids: Any,
) -> Any:
    """Which targets are in view: within reach by any of their points, and any point in the field of view and unhidden.

    Args:
        view: (14,) from `camera`. reach: (T,) [m] from the eye, 0 or less for targets that are not there.
        small: how many targets, counted from the front, are in reach only by their first point, their centre.
        points: (P, 3) [m] sample points. first: (T + 1,) target k has the points [first[k], first[k + 1]).
        own: (T, 2) ranges of geoms that do not hide the target: its own.
        half, pos, mat, radius, ids: solids as for `hthor.rays.blocked`.

    Returns:
        (T,) bool.
    """
    count = len(reach)
    out = np.zeros(count, dtype=np.bool_)
    ex, ey, ez = view[0], view[1], view[2]
    farthest = 0.0
    for k in range(count):
        if reach[k] <= 0.0:
            continue
        most = 0.0
        for p in range(first[k], first[k + 1]):
            dx, dy, dz = points[p, 0] - ex, points[p, 1] - ey, points[p, 2] - ez
            d2 = dx * dx + dy * dy + dz * dz
            most = max(most, d2)
            if d2 <= reach[k] * reach[k] and (k >= small or p == first[k]):
                out[k] = True
        if out[k]:
            farthest = max(farthest, most)
    if farthest == 0.0:
        return out
    farthest = math.sqrt(farthest)
    close = np.empty(len(ids), dtype=np.int64)
    n = 0
    for g in ids:
        dx, dy, dz = pos[g, 0] - ex, pos[g, 1] - ey, pos[g, 2] - ez
        limit = farthest + radius[g]
        if dx * dx + dy * dy + dz * dz <= limit * limit:
            close[n] = g
            n += 1
    for k in range(count):
        if out[k]:
            out[k] = False
            for p in range(first[k], first[k + 1]):
                dx, dy, dz = points[p, 0] - ex, points[p, 1] - ey, points[p, 2] - ez
                ahead = dx * view[3] + dy * view[4] + dz * view[5]
                left = dx * view[6] + dy * view[7] + dz * view[8]
                up = dx * view[9] + dy * view[10] + dz * view[11]
                if ahead <= 0.0 or abs(left) > ahead * view[12] or abs(up) > ahead * view[13]:
                    continue
                if not blocked(view[:3], points[p], half, pos, mat, radius, close[:n], own[k, 0], own[k, 1]):
                    out[k] = True
                    break
    return out
