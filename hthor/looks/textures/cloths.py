"""Textures of soft surfaces: weaves, terry, carpet, leather, stripes, rugs, wicker."""

from functools import partial
from typing import Any

import numpy as np

from hthor.looks.textures.noise import Book, dice, field, fractal, grey, mix, places

_SIZE = (256, 256)


def _weave(threads: int, depth: float, seed: int) -> Any:
    """Threads that go over and under each other in turn."""
    y, x = places(_SIZE)
    warp, weft = np.abs(np.sin(np.pi * threads * x)), np.abs(np.sin(np.pi * threads * y))
    over = ((np.floor(threads * x) + np.floor(threads * y)) % 2) == 0
    value = np.where(over, warp * (0.75 + 0.25 * weft), weft * (0.75 + 0.25 * warp))
    slub = 0.5 * field(_SIZE, (1, 14), seed) + 0.5 * field(_SIZE, (14, 1), seed + 1)
    return grey(1.0 - depth * (1.0 - value) - 0.16 * slub - 0.06 * fractal(_SIZE, 40, seed + 2, 3))


def _carpet() -> Any:
    pile = field(_SIZE, 1.0, 111)
    return grey(0.70 + 0.30 * pile + 0.10 * (fractal(_SIZE, 30, 112, 4) - 0.5))


def _terry() -> Any:
    y, _ = places(_SIZE)
    loops = field(_SIZE, 1.2, 113)
    return grey(0.80 + 0.22 * (loops - 0.3) - 0.05 * (np.sin(2 * np.pi * 24 * y) > 0.6))


def _leather() -> Any:
    """Cells between fine creases, as in leather."""
    creases = np.minimum(np.abs(field(_SIZE, 1.7, 114) - 0.5), np.abs(field(_SIZE, 1.7, 115) - 0.5))
    return grey(0.84 + 0.10 * np.clip(creases / 0.05, 0.0, 1.0) + 0.08 * (fractal(_SIZE, 50, 116, 3) - 0.5))


def _stripes(bands: int, low: float) -> Any:
    """Stripes along the rows, on fine cloth."""
    y, _ = places(_SIZE)
    stripe = 0.5 + 0.5 * np.tanh(14.0 * np.sin(2 * np.pi * bands * y))
    return np.clip(grey(low + (1.0 - low) * stripe) * (0.90 + 0.10 * _weave(64, 0.4, 117)), 0.0, 1.0)


def _plaid() -> Any:
    y, x = places(_SIZE)
    bar = sum(0.16 * ((z * 4 % 1.0) < 0.42) + 0.10 * (np.abs(z * 4 % 1.0 - 0.72) < 0.05) for z in (x, y))
    return np.clip(grey(1.0 - bar) * (0.90 + 0.10 * _weave(64, 0.4, 118)), 0.0, 1.0)


def _dots() -> Any:
    y, x = places(_SIZE)
    row = np.floor(y * 8)
    far = np.hypot((x * 8 + 0.5 * (row % 2)) % 1.0 - 0.5, y * 8 % 1.0 - 0.5)
    return np.clip(grey(np.where(far < 0.2, 1.0, 0.80)) * (0.90 + 0.10 * _weave(64, 0.4, 119)), 0.0, 1.0)


def _quilt() -> Any:
    """Stitched diamonds, shaded as if padded."""
    y, x = places(_SIZE)
    u, v = (x + y) * 4 % 1.0, (x - y) * 4 % 1.0
    puff = (np.sin(np.pi * u) * np.sin(np.pi * v)) ** 0.35
    return grey(0.74 + 0.25 * puff) * (0.94 + 0.06 * _weave(96, 0.4, 120))


def _wicker() -> Any:
    y, x = places(_SIZE)
    strand = 16
    over = ((np.floor(strand * x / 2) + np.floor(strand * y)) % 2) == 0
    value = np.where(over, np.sin(np.pi * (strand * y % 1.0)), np.sin(np.pi * (strand * x / 2 % 1.0)) * 0.75)
    return mix(0.25 + 0.75 * np.abs(value), (0.45, 0.38, 0.30), (1.0, 0.98, 0.94))


def _rug(seed: int, ground: tuple[float, float, float], accent: tuple[float, float, float]) -> Any:
    """A whole rug: borders, a field of diamonds, a medallion."""
    y, x = places((256, 384))
    edge = np.minimum(np.minimum(x, 1.0 - x) * 1.5, np.minimum(y, 1.0 - y))
    cream, night = (0.90, 0.85, 0.74), (0.17, 0.18, 0.26)
    far = np.abs(x - 0.5) * 1.5 + np.abs(y - 0.5)
    lozenge = (np.abs((x * 18) % 1.0 - 0.5) + np.abs((y * 12) % 1.0 - 0.5)) < 0.28
    picture = mix(lozenge.astype(float) * 0.6, ground, accent)
    for low, high, color in (
        (0.0, 0.38, cream),
        (0.0, 0.34, accent),
        (0.0, 0.24, ground),
        (0.0, 0.14, cream),
        (0.0, 0.08, night),
    ):
        picture[(far >= low) & (far < high)] = color
    for limit, color in ((0.13, cream), (0.115, night), (0.055, accent), (0.04, cream), (0.025, ground)):
        picture[edge < limit] = color
    beads = (edge > 0.06) & (edge < 0.11) & (np.sin(x * 2 * np.pi * 24) * np.sin(y * 2 * np.pi * 16) > 0.35)
    picture[beads] = ground
    wear = 0.80 + 0.16 * field((256, 384), 1, seed) + 0.08 * fractal((256, 384), 40, seed + 1, 3)
    return np.clip(picture * wear[..., None], 0.0, 1.0)


def _rug_bands(seed: int) -> Any:
    """A flat-woven rug in bands of color."""
    y, x = places((256, 384))
    colors = np.array(
        [(0.86, 0.82, 0.74), (0.36, 0.45, 0.52), (0.86, 0.82, 0.74), (0.76, 0.52, 0.36), (0.30, 0.33, 0.36)]
    )
    band = (np.floor(x * 22) * 7 // 3 % 5).astype(int)
    zig = (np.abs((x * 22) % 1.0 - 0.5) + 0.35 * np.abs((y * 20) % 1.0 - 0.5)) < 0.22
    picture = colors[np.where(zig, (band + 2) % 5, band)]
    return np.clip(picture * (0.82 + 0.18 * field((256, 384), (1, 3), seed))[..., None], 0.0, 1.0)


def _felt() -> Any:
    return grey(0.90 + 0.14 * (dice(121).random(_SIZE) - 0.5) + 0.10 * (fractal(_SIZE, 24, 122, 3) - 0.5))


TEXTURES: Book = {
    "weave": (partial(_weave, 40, 0.34, 101), 0.24),
    "linen": (partial(_weave, 64, 0.22, 104), 0.30),
    "canvas": (partial(_weave, 24, 0.42, 107), 0.24),
    "carpet": (_carpet, 0.60),
    "terry": (_terry, 0.25),
    "leather": (_leather, 0.35),
    "stripes_fine": (partial(_stripes, 12, 0.78), 0.36),
    "plaid": (_plaid, 0.60),
    "dots": (_dots, 0.40),
    "quilt": (_quilt, 0.60),
    "felt": (_felt, 0.20),
    "wicker": (_wicker, 0.16),
    "rug_red": (partial(_rug, 131, (0.55, 0.16, 0.14), (0.80, 0.60, 0.36)), 0.0),
    "rug_blue": (partial(_rug, 133, (0.20, 0.29, 0.44), (0.72, 0.50, 0.36)), 0.0),
    "rug_green": (partial(_rug, 135, (0.30, 0.40, 0.33), (0.82, 0.68, 0.46)), 0.0),
    "rug_bands": (partial(_rug_bands, 137), 0.0),
}
