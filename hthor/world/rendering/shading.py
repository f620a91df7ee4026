"""Compiled: the colours of the pixels of a rasterized picture, with light, patterns, glass and sky.

The light comes from a lamp at the eye, two suns without shadows and a soft sky, so that no corner is black. Patterns
fade where a pixel covers more than one repeat of them, so that distant surfaces do not flicker.
"""

import math
from typing import Any

import numba
import numpy as np

from hthor.world.rendering.rasterizer import CAPSULE, ELLIPSOID, SIDE

CODE_PART = "pictures"

PLAIN, PLANKS, TILES, CARPET, PLASTER, BRICK, LAWN, GRAIN, CLOTH, GLOWING = range(10)
"""Patterns of surfaces."""
_AMBIENT, _LAMP, _SKY, _SUN, _SUN_2 = 0.42, 0.34, 0.10, 0.16, 0.10
_SKIRTING_M = 0.08
_LAST = 127
"""Last index of a row of the noise; a power of 2 less one."""
_HAZE = (0.90, 0.93, 0.94)
_ZENITH = (0.56, 0.74, 0.90)


def mottle() -> Any:
    """(128, 128) float64 in about [-1, 1]: a soft, repeating noise, the same every time."""
    size = _LAST + 1
    index = np.arange(size * size, dtype=np.uint64)
    bits = (index * np.uint64(0x9E3779B97F4A7C15)) ^ (index >> np.uint64(7))
    bits = (bits ^ (bits >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
    rough = ((bits >> np.uint64(40)).astype(np.float64) / (1 << 23) - 1.0).reshape(size, size)
    soft = sum(np.roll(rough, (dy, dx), (0, 1)) for dy in (-1, 0, 1) for dx in (-1, 0, 1)) / 3.0
    return 0.5 * rough + 0.5 * soft


@numba.njit(cache=True, error_model="numpy", inline="always")
def _chance(a: float, b: float) -> float:
    """A pseudo-random number in [-1, 1) that depends on two whole numbers."""
    n = int(a) * 374761393 + int(b) * 668265263
    n = (n ^ (n >> 13)) * 1274126177
    return float((n >> 8) & 0xFFFF) / 32768.0 - 1.0


@numba.njit(cache=True, error_model="numpy", inline="always")
def _at(noise: Any, a: float, b: float) -> Any:
    return noise[math.floor(a) & _LAST, math.floor(b) & _LAST]


@numba.njit(cache=True, error_model="numpy", inline="always")
def _pattern(skin: int, x: float, y: float, z: float, a: float, b: float, blur: float, noise: Any) -> Any:
    """The factor of the surface's colour at (x, y, z) [m], house frame.

    ``a`` and ``b`` [m] are coordinates along and across the surface; ``blur`` [m] is the width that one pixel covers.
    """
    fine = max(0.0, 1.0 - 33.0 * blur)
    wide = max(0.0, 1.0 - 8.0 * blur)
    if skin == PLASTER:
        low = 0.05 * max(0.0, 1.0 - 2.0 * z)
        return 1.0 - low + 0.018 * _at(noise, 60.0 * a, 60.0 * z) * fine + 0.012 * _at(noise, 5.0 * a, 5.0 * z)
    if skin == PLANKS:
        v = y * (1.0 / 0.14)
        row = math.floor(v)
        u = x * (1.0 / 1.3) + 0.5 * _chance(row, 17.0)
        piece = math.floor(u)
        seam = 1.0 if v - row < 0.043 or u - piece < 0.0046 else 0.0
        grain = 0.06 * _at(noise, 12.0 * x, 170.0 * y) - 0.28 * seam
        return 1.0 + 0.07 * _chance(piece, row) * wide + grain * fine
    if skin == TILES:
        u, v = x * (1.0 / 0.35), y * (1.0 / 0.35)
        column, row = math.floor(u), math.floor(v)
        seam = 1.0 if u - column < 0.026 or v - row < 0.026 else 0.0
        return 1.0 + 0.025 * _chance(column, row) - 0.16 * seam * max(fine, 0.4 * wide)
    if skin == GRAIN:
        return 1.0 + 0.07 * _at(noise, 9.0 * a, 140.0 * b) * fine + 0.05 * _at(noise, 2.0 * a, 30.0 * b) * wide
    if skin == CLOTH:
        return 1.0 + 0.05 * _at(noise, 150.0 * a, 150.0 * b) * fine + 0.03 * _at(noise, 20.0 * a, 20.0 * b) * wide
    if skin == CARPET:
        return 1.0 + 0.07 * _at(noise, 120.0 * x, 120.0 * y) * fine + 0.03 * _at(noise, 14.0 * x, 14.0 * y) * wide
    if skin == BRICK:
        v = z * (1.0 / 0.075)
        row = math.floor(v)
        u = 4.0 * a + (0.5 if int(row) & 1 else 0.0)
        column = math.floor(u)
        seam = 1.0 if v - row < 0.16 or u - column < 0.048 else 0.0
        return 1.0 + 0.10 * _chance(column, row) * wide + 0.22 * seam * fine
    return 1.0 + 0.10 * _at(noise, 40.0 * x, 40.0 * y) * wide + 0.05 * _at(noise, 6.0 * x, 6.0 * y)


@numba.njit(cache=True, error_model="numpy", inline="always")
def _normal(shape: int, face: int, h: Any, m: Any, x: float, y: float, z: float) -> Any:
    """Outward unit normal of the solid at (x, y, z) [m] from its centre, all in the house frame."""
    if face < SIDE:
        k, sign = face >> 1, 1.0 if face & 1 else -1.0
        return sign * m[k], sign * m[3 + k], sign * m[6 + k]
    a = m[0] * x + m[3] * y + m[6] * z
    b = m[1] * x + m[4] * y + m[7] * z
    c = m[2] * x + m[5] * y + m[8] * z
    if face == SIDE:
        c = 0.0
    elif shape == CAPSULE:
        c -= max(h[0] - h[2], min(h[2] - h[0], c))
    elif shape == ELLIPSOID:
        a, b, c = a / (h[0] * h[0]), b / (h[1] * h[1]), c / (h[2] * h[2])
    length = math.sqrt(a * a + b * b + c * c) + 1e-12
    a, b, c = a / length, b / length, c / length
    return m[0] * a + m[1] * b + m[2] * c, m[3] * a + m[4] * b + m[5] * c, m[6] * a + m[7] * b + m[8] * c


@numba.njit(cache=True, error_model="numpy", inline="always")
def _byte(value: float) -> int:
    return int(min(255.0, 255.0 * value + 0.5))


@numba.njit(cache=True, error_model="numpy")
def shade(
    view: Any, w: Any, hit: Any, glass: Any,
    shape: Any, half: Any, pos: Any, mat: Any, rgba: Any, skin: Any, grain: Any, noise: Any, out: Any,
) -> None:  # fmt: skip
    """Write the colours (H, W, 3) uint8 of the solids that `hthor.world.rendering.rasterizer.fill` drew.

    Args:
        view, w, hit: as in `fill`. glass: the hits of glass in front of the solids.
        rgba: (N, 4) colours. skin: (N,) patterns. grain: (N,) the axis along which each solid is longest.
    """
    height, width = w.shape
    tx, ty = view[12], view[13]
    pixel = 2.0 * tx / width
    ex, ey, ez = view[0], view[1], view[2]
    for j in range(height):
        y = ty - (2.0 * j + 1.0) * ty / height
        bx, by, bz = view[3] + y * view[9], view[4] + y * view[10], view[5] + y * view[11]
        last = -2
        g, kind, smooth = 0, PLAIN, False
        nx = ny = nz = ax = ay = az = ox = oy = oz = lit = red0 = green0 = blue0 = 0.0
        for i in range(width):
            x = (2.0 * i + 1.0) * tx / width - tx
            dx, dy, dz = bx - x * view[6], by - x * view[7], bz - x * view[8]
            thin = 1.0 / math.sqrt(1.0 + x * x + y * y)
            code = hit[j, i]
            if code < 0:
                rise = min(1.0, max(0.0, 1.6 * dz * thin))
                red = _HAZE[0] + rise * (_ZENITH[0] - _HAZE[0])
                green = _HAZE[1] + rise * (_ZENITH[1] - _HAZE[1])
                blue = _HAZE[2] + rise * (_ZENITH[2] - _HAZE[2])
            else:
                t = 1.0 / w[j, i]
                px, py, pz = ex + t * dx, ey + t * dy, ez + t * dz
                if code != last or smooth:  # most pixels show the same face as the pixel to their left
                    last, g = code, code >> 3
                    smooth = code & 7 >= SIDE
                    m = mat[g]
                    ox, oy, oz = pos[g, 0], pos[g, 1], pos[g, 2]
                    nx, ny, nz = _normal(shape[g], code & 7, half[g], m, px - ox, py - oy, pz - oz)
                    lit = _AMBIENT + _SKY * (0.5 + 0.5 * nz)
                    lit += _SUN * max(0.0, -0.259 * nx - 0.432 * ny + 0.864 * nz)
                    lit += _SUN_2 * max(0.0, 0.717 * nx + 0.359 * ny + 0.598 * nz)
                    red0, green0, blue0 = rgba[g, 0], rgba[g, 1], rgba[g, 2]
                    kind = skin[g]
                    k = grain[g] if kind in (GRAIN, CLOTH) else 0
                    ax, ay, az = m[k], m[3 + k], m[6 + k]
                facing = abs(nx * dx + ny * dy + nz * dz) * thin
                light = lit + _LAMP * facing
                red, green, blue = red0, green0, blue0
                if kind == GLOWING:
                    light += 0.3
                elif kind == PLASTER and pz < _SKIRTING_M:
                    red, green, blue = 0.90, 0.89, 0.87
                    light *= 0.86 if pz > 0.88 * _SKIRTING_M else 1.0
                elif kind != PLAIN:
                    if kind not in (GRAIN, CLOTH):
                        ox = oy = oz = 0.0
                    qx, qy, qz = px - ox, py - oy, pz - oz
                    a = ax * qx + ay * qy + az * qz
                    blur = pixel * t / max(0.15, facing)
                    light *= _pattern(kind, px, py, pz, a, qx + qy + qz - a, blur, noise)
                red, green, blue = red * light, green * light, blue * light
                if kind == LAWN:
                    away = math.sqrt((px - ex) * (px - ex) + (py - ey) * (py - ey))
                    haze = min(1.0, max(0.0, (away - 8.0) / 45.0))
                    red += haze * (_HAZE[0] - red)
                    green += haze * (_HAZE[1] - green)
                    blue += haze * (_HAZE[2] - blue)
            code = glass[j, i]
            if code >= 0:
                pane = code >> 3
                cover = rgba[pane, 3]
                red += cover * (rgba[pane, 0] - red)
                green += cover * (rgba[pane, 1] - green)
                blue += cover * (rgba[pane, 2] - blue)
            out[j, i, 0], out[j, i, 1], out[j, i, 2] = _byte(red), _byte(green), _byte(blue)
