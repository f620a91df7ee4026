"""What an eye sees: range first, then the field of view, then rays; knows nothing of detections or minds.

All candidates of one look go through one compiled call, which takes a few microseconds. Whatever can be is done for
many balls, points or solids at once, row by row and without branches, so that it becomes vector instructions.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np


@numba.njit(cache=True, error_model="numpy")
def _touched(view: Any, reach: float, balls: Any, out: Any) -> None:
    """Mark the balls (4, N), middles and radii [m], that are, in part, within reach and in the field of view."""
    ex, ey, ez, fx, fy, fz = view[0], view[1], view[2], view[3], view[4], view[5]
    lx, ly, lz, ux, uy, uz, w, h = view[6], view[7], view[8], view[9], view[10], view[11], view[12], view[13]
    wide, high = math.sqrt(1.0 + w * w), math.sqrt(1.0 + h * h)
    x, y, z, r = balls[0], balls[1], balls[2], balls[3]
    for i in range(len(out)):
        dx, dy, dz, size = x[i] - ex, y[i] - ey, z[i] - ez, r[i]
        limit = reach + size
        ahead = dx * fx + dy * fy + dz * fz
        left = dx * lx + dy * ly + dz * lz
        up = dx * ux + dy * uy + dz * uz
        near = (dx * dx + dy * dy + dz * dz <= limit * limit) & (ahead >= -size)
        out[i] = near & (abs(left) - ahead * w <= size * wide) & (abs(up) - ahead * h <= size * high)


@numba.njit(cache=True, error_model="numpy")
def _frame(view: Any, spots: Any, sure: Any, out: Any, d2: Any) -> None:
    """Mark the points (3, N) that are in the field of view and not sure to be hidden still; their squared distances."""
    ex, ey, ez, fx, fy, fz = view[0], view[1], view[2], view[3], view[4], view[5]
    lx, ly, lz, ux, uy, uz, w, h = view[6], view[7], view[8], view[9], view[10], view[11], view[12], view[13]
    x, y, z, sx, sy, leeway = spots[0], spots[1], spots[2], sure[0], sure[1], sure[2]
    for i in range(len(out)):
        dx, dy, dz = x[i] - ex, y[i] - ey, z[i] - ez
        d2[i] = dx * dx + dy * dy + dz * dz
        ahead = dx * fx + dy * fy + dz * fz
        left = dx * lx + dy * ly + dz * lz
        up = dx * ux + dy * uy + dz * uz
        wx, wy = sx[i] - ex, sy[i] - ey
        inside = (ahead > 0.0) & (abs(left) <= ahead * w) & (abs(up) <= ahead * h)
        out[i] = inside & (wx * wx + wy * wy >= leeway[i] * leeway[i])


@numba.njit(cache=True, error_model="numpy")
def _aim_still(view: Any, reach: Any, first: Any, spots: Any, balls: Any, sure: Any, out: Any, framed: Any) -> float:
    """Of targets that never move, mark those in reach that have points to look at, and these; the farthest, squared."""
    likely = np.empty(balls.shape[1], dtype=np.bool_)
    _touched(view, reach.max(), balls, likely)
    d2 = np.empty(len(framed))
    _frame(view, spots, sure, framed, d2)
    farthest = 0.0
    for k in range(len(likely)):
        if likely[k] and reach[k] > 0.0:
            least, most = math.inf, 0.0
            for p in range(first[k] - first[0], first[k + 1] - first[0]):
                least, most = min(least, d2[p]), max(most, d2[p] * framed[p])
            if most > 0.0 and least <= reach[k] * reach[k]:
                out[k] = True
                farthest = max(farthest, most)
    return farthest


@numba.njit(cache=True, error_model="numpy")
def _aim(view: Any, reach: Any, small: int, points: Any, first: Any, k: int, framed: Any) -> float:
    """Mark the points of a target in reach that are in the field of view; the squared distance of the farthest, or 0.

    A target is in reach by any of its points, one of the first ``small`` only by its first.
    """
    near, most = False, 0.0
    for p in range(first[k], first[k + 1]):
        dx, dy, dz = points[p, 0] - view[0], points[p, 1] - view[1], points[p, 2] - view[2]
        d2 = dx * dx + dy * dy + dz * dz
        if k >= small or p == first[k]:
            near |= d2 <= reach[k] * reach[k]
        if k < small and not near:
            return 0.0
        ahead = dx * view[3] + dy * view[4] + dz * view[5]
        left = dx * view[6] + dy * view[7] + dz * view[8]
        up = dx * view[9] + dy * view[10] + dz * view[11]
        if (ahead > 0.0) & (abs(left) <= ahead * view[12]) & (abs(up) <= ahead * view[13]):
            framed[p] = True
            most = max(most, d2)
    return most if near else 0.0


@numba.njit(cache=True, error_model="numpy")
def _blocks(g: int, px: float, py: float, pz: float, ux: float, uy: float, uz: float, half: Any, mat: Any) -> bool:
    """Whether a solid whose middle is at (px, py, pz) from the eye meets the line of sight; as `hthor.rays` has it."""
    near, far = 0.0, 1.0
    for axis in range(3):
        o = -(mat[g, axis] * px + mat[g, 3 + axis] * py + mat[g, 6 + axis] * pz)
        v = mat[g, axis] * ux + mat[g, 3 + axis] * uy + mat[g, 6 + axis] * uz
        end, size = o + v, half[g, axis]
        if min(o, end) > size or max(o, end) < -size:
            return False
        if abs(v) < 1e-12:
            v = 1e-12
        t1, t2 = (-half[g, axis] - o) / v, (half[g, axis] - o) / v
        if t1 > t2:
            t1, t2 = t2, t1
        near, far = max(near, t1), min(far, t2)
    return near <= far


@numba.njit(cache=True, error_model="numpy")
def _leeway(g: int, px: float, py: float, pz: float, ux: float, uy: float, uz: float, half: Any, mat: Any) -> float:
    """How far [m] the eye may go before the line of sight (ux, uy, uz) can miss a solid that it meets, 0 when unknown.

    The line crosses the solid's middle plane, across its thinnest side. While the eye goes by d, at most half its way
    D from that plane to the target's, the crossing moves by no more than d times twice the target's share of D, times
    1 + L / D, L being the line's length.
    """
    thin = 0
    for axis in range(1, 3):
        if half[g, axis] < half[g, thin]:
            thin = axis
    o = -(mat[g, thin] * px + mat[g, 3 + thin] * py + mat[g, 6 + thin] * pz)
    v = mat[g, thin] * ux + mat[g, 3 + thin] * uy + mat[g, 6 + thin] * uz
    if abs(v) < 1e-3 or o * v >= 0.0 or abs(o) >= abs(v):
        return 0.0
    share, slack = -o / v, math.inf
    for axis in range(3):
        if axis != thin:
            at = -(mat[g, axis] * px + mat[g, 3 + axis] * py + mat[g, 6 + axis] * pz)
            at += share * (mat[g, axis] * ux + mat[g, 3 + axis] * uy + mat[g, 6 + axis] * uz)
            slack = min(slack, half[g, axis] - abs(at))
    line = math.sqrt(ux * ux + uy * uy + uz * uz)
    most = slack / (2.0 * (1.0 - share) * (1.0 + line / abs(v)))
    return float(max(0.0, min(most, abs(o), 0.5 * abs(v)) - 1e-6))


@numba.njit(cache=True, error_model="numpy")
def _gather(
    view: Any, farthest: float, pos: Any, radius: Any, walls: Any, spheres: Any, ids: Any, close: Any
) -> tuple[int, int]:
    """List the solids that reach into the field of view, no farther away than ``farthest``, first those of ``walls``.

    Returns:
        how many of the walls there are, and how many in all.
    """
    likely, loose = np.empty(len(walls), dtype=np.bool_), np.empty(len(ids), dtype=np.bool_)
    _touched(view, farthest, spheres, likely)
    around = np.empty((4, len(ids)))
    for c in range(len(ids)):
        g = ids[c]
        around[0, c], around[1, c], around[2, c], around[3, c] = pos[g, 0], pos[g, 1], pos[g, 2], radius[g]
    _touched(view, farthest, around, loose)
    firm = 0
    for c in range(len(walls)):
        close[firm] = walls[c]
        firm += likely[c]
    n = firm
    for c in range(len(ids)):
        close[n] = ids[c]
        n += loose[c]
    return firm, n


@numba.njit(cache=True, error_model="numpy")
def _reveal(
    view: Any,
    points: Any,
    first: Any,
    own: Any,
    half: Any,
    mat: Any,
    close: Any,
    rel: Any,
    firm: int,
    n: int,
    begin: int,
    end: int,
    sure: Any,
    out: Any,
    framed: Any,
) -> None:
    """Unmark the targets all of whose points are hidden by a solid that is close; the test is that of `hthor.rays`.

    The targets from ``begin`` to ``end`` never move, nor do the first ``firm`` solids: of points of these that are
    hidden by one of those it is noted how long they are sure to be.
    """
    last = -1  # what hid one point probably hides the next
    for k in range(len(out)):
        if not out[k]:
            continue
        out[k] = False
        for p in range(first[k], first[k + 1]):
            if not framed[p]:
                continue
            ux, uy, uz = points[p, 0] - view[0], points[p, 1] - view[1], points[p, 2] - view[2]
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
                if ex * ex + ey * ey + ez * ez <= rel[c, 4] and _blocks(g, px, py, pz, ux, uy, uz, half, mat):
                    last, hidden = c, True
                    if begin <= k < end and c < firm:
                        leeway = _leeway(g, px, py, pz, ux, uy, uz, half, mat)
                        spot = p - first[begin]
                        sure[0, spot], sure[1, spot], sure[2, spot] = view[0], view[1], leeway
                    break
            if not hidden:
                out[k] = True
                break


@numba.njit(cache=True, error_model="numpy")
def see(
    view: Any,
    reach: Any,
    small: int,
    points: Any,
    first: Any,
    own: Any,
    spots: Any,
    balls: Any,
    half: Any,
    pos: Any,
    mat: Any,
    radius: Any,
    walls: Any,
    spheres: Any,
    ids: Any,
    sure: Any,
    order: Any,
) -> Any:
    """Which targets are in view: within reach by any of their points, and any point in the field of view and unhidden.

    Args:
        view: (14,) from `camera`. reach: (T,) [m] from the eye, 0 or less for targets that are not there.
        small: how many targets, counted from the front, are in reach only by their first point, their centre.
        points: (P, 3) [m] sample points. first: (T + 1,) target k has the points [first[k], first[k + 1]).
        own: (T, 2) ranges of geoms that do not hide the target: its own.
        spots: (3, Q) the points of the targets after the small ones, B of which never move. balls: (4, B) middles and
            radii [m] of balls around the points of each of these.
        half, pos, mat, radius: solids as for `hthor.rays.blocked`.
        walls: indices of those that never move. spheres: (4, W) their middles and radii. ids: indices of the others.
        sure: (3, Q) in and out, zeros at first: where this eye was, x and y [m], when a point turned out to be hidden,
            and how far [m] from there it is sure to be hidden still. The eye always has the same height.
        order: (T,) in which order to name the targets.

    Returns:
        (N,) the targets in view.
    """
    out = np.zeros(len(reach), dtype=np.bool_)
    framed = np.zeros(len(points), dtype=np.bool_)
    seen, count = np.empty(len(order), dtype=np.int64), 0
    end, farthest = min(len(reach), small + balls.shape[1]), 0.0
    if small < end:
        low, high = first[small], first[end]
        farthest = _aim_still(
            view, reach[small:end], first[small:], spots, balls, sure, out[small:end], framed[low:high]
        )
    for k in range(len(reach)):
        if reach[k] > 0.0 and not small <= k < end:
            most = _aim(view, reach, small, points, first, k, framed)
            out[k] = most > 0.0
            farthest = max(farthest, most)
    if farthest == 0.0:
        return seen[:0]
    close = np.empty(len(walls) + len(ids) + 1, dtype=np.int64)
    firm, n = _gather(view, math.sqrt(farthest), pos, radius, walls, spheres, ids, close)
    rel = np.empty((n, 5))
    for c in range(n):
        g = close[c]
        dx, dy, dz = pos[g, 0] - view[0], pos[g, 1] - view[1], pos[g, 2] - view[2]
        rel[c, 0], rel[c, 1], rel[c, 2] = dx, dy, dz
        rel[c, 3], rel[c, 4] = dx * dx + dy * dy + dz * dz, radius[g] * radius[g]
    _reveal(view, points, first, own, half, mat, close, rel, firm, n, small, end, sure, out, framed)
    for k in order:
        if out[k]:
            seen[count] = k
            count += 1
    return seen[:count]
