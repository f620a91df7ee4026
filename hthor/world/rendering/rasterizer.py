"""Compiled: the solid that each pixel of a picture shows, and its depth.

Each solid, largest first, is transformed to the camera's frame; then only the pixels in a rectangle around it are
visited. For each pixel ``w`` is stored, one over the depth along the optical axis. Along a row of pixels the ``w`` of a
flat face is linear, so a box needs no division within a row, and a round solid one square root per pixel. There is no
precomputed structure, so things may move freely between pictures.
"""

import math
from typing import Any

import numba

CODE_PART = "pictures"

PLANE, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX = 0, 2, 3, 4, 5, 6
"""The engine's numbers for shapes."""
SIDE, ROUND = 6, 7
"""Numbers of the faces that a pixel shows, besides 0 to 5 (-x, +x, -y, +y, -z, +z): a round side, a ball."""
_SKIN_M = 1e-9
"""[m] A face that is no farther than this from the eye is not seen."""
_TIE = 1.0 + 1e-9
"""Of two faces at the same depth, that of the larger solid is shown, independent of rounding."""


@numba.njit(cache=True, error_model="numpy")
def fill(view: Any, order: Any, shape: Any, half: Any, radius: Any, pos: Any, mat: Any, w: Any, hit: Any) -> None:
    """Draw solids into ``w`` (H, W) float64 [1/m] and ``hit`` (H, W) int32, 8 x solid + face, where they are nearest.

    Args:
        view: (16,) eye [m], forward, left and up axes, tangents of half the fields of view, near and far [m].
        order: indices of the solids to draw. shape: (N,) the engine's numbers. half: (N, 3) half extents of the
            bounding box [m]. radius: (N,) of the bounding sphere [m]. pos: (N, 3) [m]. mat: (N, 9) row-major rotations.
    """
    height, width = w.shape
    tx, ty, near, far = view[12], view[13], view[14], view[15]
    ex, ey, ez = view[0], view[1], view[2]
    fx, fy, fz = view[3], view[4], view[5]
    rx, ry, rz = -view[6], -view[7], -view[8]
    ux, uy, uz = view[9], view[10], view[11]
    sx, sy = math.sqrt(1.0 + tx * tx), math.sqrt(1.0 + ty * ty)
    w_near, w_far = 1.0 / near, 1.0 / far
    for g in order:
        px, py, pz = pos[g, 0] - ex, pos[g, 1] - ey, pos[g, 2] - ez
        ahead, reach = px * fx + py * fy + pz * fz, radius[g]
        if not (ahead + reach >= near and ahead - reach <= far):  # also skips NaN positions
            continue
        right, up = px * rx + py * ry + pz * rz, px * ux + py * uy + pz * uz
        if not (abs(right) - ahead * tx <= reach * sx and abs(up) - ahead * ty <= reach * sy):
            continue
        m = mat[g]
        f = (m[0] * fx + m[3] * fy + m[6] * fz, m[1] * fx + m[4] * fy + m[7] * fz, m[2] * fx + m[5] * fy + m[8] * fz)
        r = (m[0] * rx + m[3] * ry + m[6] * rz, m[1] * rx + m[4] * ry + m[7] * rz, m[2] * rx + m[5] * ry + m[8] * rz)
        u = (m[0] * ux + m[3] * uy + m[6] * uz, m[1] * ux + m[4] * uy + m[7] * uz, m[2] * ux + m[5] * uy + m[8] * uz)
        o = (
            -(m[0] * px + m[3] * py + m[6] * pz),
            -(m[1] * px + m[4] * py + m[7] * pz),
            -(m[2] * px + m[5] * py + m[8] * pz),
        )
        h = (half[g, 0], half[g, 1], half[g, 2])
        i0, i1, j0, j1 = _rectangle(ahead, right, up, f, r, u, h, near, tx, ty, width, height)
        if i0 > i1 or j0 > j1:
            continue
        if shape[g] in (BOX, PLANE):
            _box(g, shape[g], o, f, r, u, h, tx, ty, w_near, w_far, i0, i1, j0, j1, w, hit)
        else:
            _round(g, shape[g], o, f, r, u, h, tx, ty, w_near, w_far, i0, i1, j0, j1, w, hit)


@numba.njit(cache=True, error_model="numpy", inline="always")
def _rectangle(
    ahead: float, right: float, up: float, f: Any, r: Any, u: Any, h: Any, near: float, tx: float, ty: float,
    width: int, height: int,
) -> Any:  # fmt: skip
    """Columns and rows [i0, i1] x [j0, j1] that may show the part of the solid's bounding box beyond ``near``."""
    x0, x1, y0, y1 = 1e9, -1e9, 1e9, -1e9
    for corner in range(8):
        a = h[0] if corner & 1 else -h[0]
        b = h[1] if corner & 2 else -h[1]
        c = h[2] if corner & 4 else -h[2]
        depth = ahead + a * f[0] + b * f[1] + c * f[2]
        x, y = right + a * r[0] + b * r[1] + c * r[2], up + a * u[0] + b * u[1] + c * u[2]
        if depth >= near:
            t = 1.0 / depth
            x0, x1, y0, y1 = min(x0, x * t), max(x1, x * t), min(y0, y * t), max(y1, y * t)
            continue
        for k in range(3):  # edges from this corner to corners beyond ``near`` are cut at ``near``
            length = -2.0 * (a if k == 0 else b if k == 1 else c)
            beyond = depth + length * f[k]
            if beyond > near:
                part = length * (near - depth) / (beyond - depth)
                cross, rise = (x + part * r[k]) / near, (y + part * u[k]) / near
                x0, x1, y0, y1 = min(x0, cross), max(x1, cross), min(y0, rise), max(y1, rise)
    if x0 > x1:
        return 1, 0, 1, 0
    i0 = int(max(0.0, math.ceil((x0 / tx + 1.0) * 0.5 * width - 0.5 - 1e-6)))
    i1 = int(min(width - 1.0, math.floor((x1 / tx + 1.0) * 0.5 * width - 0.5 + 1e-6)))
    j0 = int(max(0.0, math.ceil((1.0 - y1 / ty) * 0.5 * height - 0.5 - 1e-6)))
    j1 = int(min(height - 1.0, math.floor((1.0 - y0 / ty) * 0.5 * height - 0.5 + 1e-6)))
    return i0, i1, j0, j1


@numba.njit(cache=True, error_model="numpy", inline="always")
def _clip(value: float, slope: float, lo: float, hi: float) -> Any:
    """The part of [lo, hi] where ``value + slope * i`` is not negative."""
    if slope > 1e-14:
        return max(lo, -value / slope), hi
    if slope < -1e-14:
        return lo, min(hi, -value / slope)
    return lo, hi if value >= 0.0 else lo - 1.0


@numba.njit(cache=True, error_model="numpy")
def _box(
    g: int, shape: int, o: Any, f: Any, r: Any, u: Any, h: Any, tx: float, ty: float, w_near: float, w_far: float,
    i0: int, i1: int, j0: int, j1: int, w: Any, hit: Any,
) -> None:  # fmt: skip
    """Draw the faces that point to the eye, at most three, row by row; an eye inside the box sees none."""
    height, width = w.shape
    step, first = 2.0 * tx / width, tx / width - tx
    for k in range(3):
        if shape == PLANE:
            if k < 2 or o[2] <= _SKIN_M:
                continue
            c, face = -o[2], 5
        elif o[k] > h[k] + _SKIN_M:
            c, face = h[k] - o[k], 2 * k + 1
        elif o[k] < -h[k] - _SKIN_M:
            c, face = -h[k] - o[k], 2 * k
        else:
            continue
        a, b = (k + 1) % 3, (k + 2) % 3
        code = 8 * g + face
        w1 = r[k] / c * step
        a1, b1 = o[a] * w1 + r[a] * step, o[b] * w1 + r[b] * step
        for j in range(j0, j1 + 1):
            y = ty - (2.0 * j + 1.0) * ty / height
            w0 = (f[k] + first * r[k] + y * u[k]) / c
            a0, b0 = o[a] * w0 + f[a] + first * r[a] + y * u[a], o[b] * w0 + f[b] + first * r[b] + y * u[b]
            lo, hi = float(i0), float(i1)
            lo, hi = _clip(h[a] * w0 + a0, h[a] * w1 + a1, lo, hi)
            lo, hi = _clip(h[a] * w0 - a0, h[a] * w1 - a1, lo, hi)
            lo, hi = _clip(h[b] * w0 + b0, h[b] * w1 + b1, lo, hi)
            lo, hi = _clip(h[b] * w0 - b0, h[b] * w1 - b1, lo, hi)
            lo, hi = _clip(w0 - w_far, w1, lo, hi)
            lo, hi = _clip(w_near - w0, -w1, lo, hi)
            if not lo <= hi:
                continue
            depths, hits = w[j], hit[j]
            for i in range(math.ceil(lo - 1e-9), math.floor(hi + 1e-9) + 1):
                here = w0 + i * w1
                if here > depths[i] * _TIE:
                    depths[i] = here
                    hits[i] = code


@numba.njit(cache=True, error_model="numpy")
def _round(
    g: int, shape: int, o: Any, f: Any, r: Any, u: Any, h: Any, tx: float, ty: float, w_near: float, w_far: float,
    i0: int, i1: int, j0: int, j1: int, w: Any, hit: Any,
) -> None:  # fmt: skip
    """Draw a cylinder, capsule, sphere or ellipsoid pixel by pixel; an eye inside it sees nothing of it."""
    height, width = w.shape
    step, first = 2.0 * tx / width, tx / width - tx
    if shape in (SPHERE, ELLIPSOID):  # an ellipsoid is a unit ball in a scaled frame
        o = (o[0] / h[0], o[1] / h[1], o[2] / h[2])
        f = (f[0] / h[0], f[1] / h[1], f[2] / h[2])
        r = (r[0] / h[0], r[1] / h[1], r[2] / h[2])
        u = (u[0] / h[0], u[1] / h[1], u[2] / h[2])
        h = (1.0, 1.0, 1.0)
    rod = h[2] - h[0] if shape == CAPSULE else h[2]
    side = o[0] * o[0] + o[1] * o[1] - h[0] * h[0]
    for j in range(j0, j1 + 1):
        y = ty - (2.0 * j + 1.0) * ty / height
        bx, by, bz = f[0] + y * u[0], f[1] + y * u[1], f[2] + y * u[2]
        for i in range(i0, i1 + 1):
            x = first + i * step
            dx, dy, dz = bx + x * r[0], by + x * r[1], bz + x * r[2]
            if shape in (SPHERE, ELLIPSOID):
                best, face = _ball(o[0], o[1], o[2], dx, dy, dz, 1.0), ROUND
            else:
                best, face = 0.0, SIDE
                flat = dx * dx + dy * dy
                along = o[0] * dx + o[1] * dy
                inner = along * along - flat * side
                if side > 0.0 and inner >= 0.0 and along < 0.0:
                    here = (math.sqrt(inner) - along) / side
                    if abs(o[2] * here + dz) <= rod * here:
                        best = here
                if shape == CAPSULE:
                    for end in (-rod, rod):
                        here = _ball(o[0], o[1], o[2] - end, dx, dy, dz, h[0])
                        if here > best:
                            best, face = here, ROUND
                elif abs(o[2]) > rod:
                    here = dz / ((rod if o[2] > 0.0 else -rod) - o[2])
                    qx, qy = o[0] * here + dx, o[1] * here + dy
                    if here > best and qx * qx + qy * qy <= h[0] * h[0] * here * here:
                        best, face = here, 5 if o[2] > 0.0 else 4
            if w_far <= best <= w_near and best > w[j, i] * _TIE:
                w[j, i] = best
                hit[j, i] = 8 * g + face


@numba.njit(cache=True, error_model="numpy", inline="always")
def _ball(ox: float, oy: float, oz: float, dx: float, dy: float, dz: float, radius: float) -> float:
    """One over the depth at which a ray enters a ball around the origin, 0 if it misses the ball."""
    c = ox * ox + oy * oy + oz * oz - radius * radius
    b = ox * dx + oy * dy + oz * dz
    inner = b * b - (dx * dx + dy * dy + dz * dz) * c
    if c <= 0.0 or b >= 0.0 or inner < 0.0:
        return 0.0
    return (math.sqrt(inner) - b) / c
