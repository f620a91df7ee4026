"""What an eye sees: range first, then the field of view, then rays; knows nothing of detections or minds.

All candidates of one look go through one compiled call, which takes a few microseconds.
"""

from __future__ import annotations

import functools
import math
from typing import Any

import numba
import numpy as np

from hthor.types import BodySpec, Pose, Vec2, Vec3


def camera(pose: Pose, spec: BodySpec) -> Any:
    """(14,) float64: eye [m], forward, left and up axes (house frame), tangents of half the fields of view."""
    cy, sy, cp, sp = (
        math.cos(pose.yaw),
        math.sin(pose.yaw),
        math.cos(pose.pitch),
        math.sin(pose.pitch),
    )
    wide, high = _tangents(spec.fov)
    return np.array(
        (
            pose.x,
            pose.y,
            spec.eye,
            cp * cy,
            cp * sy,
            sp,
            -sy,
            cy,
            0.0,
            -sp * cy,
            -sp * sy,
            cp,
            wide,
            high,
        )
    )


@functools.cache
def _tangents(fov: Vec2) -> Vec2:
    return math.tan(fov[0] / 2), math.tan(fov[1] / 2)


def eye(pose: Pose, spec: BodySpec) -> Vec3:
    """Where the eye is [m], house frame."""
    return (pose.x, pose.y, spec.eye)


def points(position: Vec3, size: Vec3) -> tuple[Vec3, Vec3]:
    """Where an object is looked for [m]: its centre and a point near its top."""
    x, y, z = position
    return position, (x, y, z + 0.4 * size[2])


@numba.njit(cache=True)
def nearest(x: float, y: float, z: float, positions: Any) -> float:
    """Distance [m] from an eye to the nearest of ``positions`` (N, 3), infinite when there is none."""
    best = math.inf
    for k in range(len(positions)):
        dx, dy, dz = positions[k, 0] - x, positions[k, 1] - y, positions[k, 2] - z
        best = min(best, dx * dx + dy * dy + dz * dz)
    return math.sqrt(best)


@numba.njit(cache=True)
def _aim(view: Any, reach: Any, small: int, points: Any, first: Any, out: Any, framed: Any) -> float:
    """Mark the targets in reach that have points in the field of view, and these points; the square of the farthest."""
    ex, ey, ez = view[0], view[1], view[2]
    farthest = 0.0
    for k in range(len(reach)):
        if reach[k] <= 0.0:
            continue
        limit, near, most = reach[k] * reach[k], False, 0.0
        for p in range(first[k], first[k + 1]):
            dx, dy, dz = points[p, 0] - ex, points[p, 1] - ey, points[p, 2] - ez
            d2 = dx * dx + dy * dy + dz * dz
            if d2 <= limit and (k >= small or p == first[k]):
                near = True
            elif k < small and not near:
                break
            ahead = dx * view[3] + dy * view[4] + dz * view[5]
            if ahead > 0.0:
                left = dx * view[6] + dy * view[7] + dz * view[8]
                up = dx * view[9] + dy * view[10] + dz * view[11]
                if abs(left) <= ahead * view[12] and abs(up) <= ahead * view[13]:
                    framed[p] = True
                    most = max(most, d2)
        if near and most > 0.0:
            out[k] = True
            farthest = max(farthest, most)
    return farthest


@numba.njit(cache=True)
def _gather(view: Any, farthest: float, pos: Any, radius: Any, ids: Any, close: Any, rel: Any) -> int:
    """List the solids that reach into the field of view, no farther away than ``farthest``; returns how many.

    ``rel`` (N, 5) holds for each the way from the eye to its middle, the square of that and of its radius.
    """
    wide, high = (
        math.sqrt(1.0 + view[12] * view[12]),
        math.sqrt(1.0 + view[13] * view[13]),
    )
    n = 0
    for g in ids:
        dx, dy, dz = pos[g, 0] - view[0], pos[g, 1] - view[1], pos[g, 2] - view[2]
        size, d2 = radius[g], dx * dx + dy * dy + dz * dz
        limit = farthest + size
        ahead = dx * view[3] + dy * view[4] + dz * view[5]
        if ahead < -size or d2 > limit * limit:
            continue
        left = dx * view[6] + dy * view[7] + dz * view[8]
        up = dx * view[9] + dy * view[10] + dz * view[11]
        if abs(left) - ahead * view[12] <= size * wide and abs(up) - ahead * view[13] <= size * high:
            close[n] = g
            rel[n, 0], rel[n, 1], rel[n, 2], rel[n, 3], rel[n, 4] = (
                dx,
                dy,
                dz,
                d2,
                size * size,
            )
            n += 1
    return n


@numba.njit(cache=True)
def _reveal(
    view: Any,
    points: Any,
    first: Any,
    own: Any,
    half: Any,
    mat: Any,
    close: Any,
    rel: Any,
    n: int,
    out: Any,
    framed: Any,
) -> None:
    """Unmark the targets all of whose points are hidden by a solid that is close; the test is that of `hthor.rays`."""
    last = -1  # what hid one point probably hides the next
    for k in range(len(out)):
        if not out[k]:
            continue
        out[k] = False
        for p in range(first[k], first[k + 1]):
            if not framed[p]:
                continue
            ux, uy, uz = (
                points[p, 0] - view[0],
                points[p, 1] - view[1],
                points[p, 2] - view[2],
            )
            length2 = ux * ux + uy * uy + uz * uz
            hidden = False
            for step in range(-1, n):
                c = last if step < 0 else step
                if c < 0:
                    continue
                px, py, pz = rel[c, 0], rel[c, 1], rel[c, 2]
                along = px * ux + py * uy + pz * uz
                if rel[c, 3] * length2 - along * along > 1.000001 * rel[c, 4] * length2:
                    continue  # far off the whole line
                g = close[c]
                if own[k, 0] <= g < own[k, 1]:
                    continue
                t = min(1.0, max(0.0, along / length2))
                ex, ey, ez = px - t * ux, py - t * uy, pz - t * uz
                if ex * ex + ey * ey + ez * ez > rel[c, 4]:
                    continue
                near, far = 0.0, 1.0
                for axis in range(3):
                    o = -(mat[g, axis] * px + mat[g, 3 + axis] * py + mat[g, 6 + axis] * pz)
                    v = mat[g, axis] * ux + mat[g, 3 + axis] * uy + mat[g, 6 + axis] * uz
                    if abs(v) < 1e-12:
                        v = 1e-12
                    t1, t2 = (-half[g, axis] - o) / v, (half[g, axis] - o) / v
                    if t1 > t2:
                        t1, t2 = t2, t1
                    near, far = max(near, t1), min(far, t2)
                if near <= far:
                    last, hidden = c, True
                    break
            if not hidden:
                out[k] = True
                break


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
    out = np.zeros(len(reach), dtype=np.bool_)
    framed = np.zeros(len(points), dtype=np.bool_)
    farthest = _aim(view, reach, small, points, first, out, framed)
    if farthest > 0.0:
        close, rel = np.empty(len(ids), dtype=np.int64), np.empty((len(ids), 5))
        n = _gather(view, math.sqrt(farthest), pos, radius, ids, close, rel)
        _reveal(view, points, first, own, half, mat, close, rel, n, out, framed)
    return out
