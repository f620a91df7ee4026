"""Textures of natural surfaces (fruit, bread, leaves, soil) and of simple materials (cardboard, metal, balls).

Textures of food go once around a thing: rows run from its top (first row) to its bottom, columns around it.
"""

from functools import partial
from typing import Any

import numpy as np

from hthor.looks.textures.noise import Book, field, fractal, grey, mix, places

_SIZE = (128, 256)


def _apple() -> Any:
    """Red with yellow around both poles, and streaks from pole to pole."""
    y, _ = places(_SIZE)
    streak, cloud = field(_SIZE, (22, 1.2), 201), fractal(_SIZE, 26, 202, 3)
    red = np.clip(1.6 * cloud + 0.7 * streak - 0.35, 0.0, 1.0)
    red = np.clip(red + 0.25 - 1.5 * np.exp(-y / 0.07) - 1.0 * np.exp(-(1.0 - y) / 0.05), 0.0, 1.0)
    picture = mix(red, (0.86, 0.66, 0.22), (0.72, 0.07, 0.09))
    picture[field(_SIZE, 0.8, 203) > 0.80] += 0.10
    return np.clip(picture, 0.0, 1.0)


def _tomato() -> Any:
    y, _ = places(_SIZE)
    picture = mix(fractal(_SIZE, 20, 205, 3), (0.80, 0.13, 0.06), (0.90, 0.22, 0.10))
    return np.clip(picture + np.exp(-y / 0.07)[..., None] * np.array((0.02, 0.22, 0.06)), 0.0, 1.0)


def _lettuce() -> Any:
    """Pale in the middle and at the ribs, deep green at the rim of the leaves."""
    size = (256, 256)
    y, _ = places(size)
    ribs = np.exp(-((np.abs(fractal(size, 20, 207, 4) - 0.5) / 0.03) ** 1.2))
    green = np.clip(1.15 * fractal(size, 14, 208, 4) - 0.1, 0.0, 1.0)
    picture = mix(green, (0.66, 0.82, 0.36), (0.25, 0.52, 0.14)) + 0.16 * ribs[..., None]
    return np.clip(picture + 0.18 * np.exp(-y / 0.2)[..., None], 0.0, 1.0)


def _bread() -> Any:
    size = (256, 256)
    bake = fractal(size, 30, 209, 5)
    flour = np.clip(fractal(size, 8, 210, 4) - 0.66, 0.0, 1.0) * 2.0
    return np.clip(mix(bake, (0.86, 0.58, 0.28), (0.52, 0.27, 0.10)) + 0.5 * flour[..., None], 0.0, 1.0)


def _potato() -> Any:
    size = (128, 128)
    picture = mix(fractal(size, 12, 211, 5), (0.60, 0.43, 0.23), (0.80, 0.65, 0.42))
    picture[field(size, 1.4, 212) > 0.86] *= 0.62
    return picture


def _egg() -> Any:
    size = (64, 64)
    return mix(0.5 * fractal(size, 14, 213, 2) + 0.5 * field(size, 0.7, 214), (0.88, 0.74, 0.60), (0.96, 0.86, 0.74))


def _leaf(rows: int) -> Any:
    """The blade of a leaf: its rib runs along the middle of the columns, and side veins slant from it."""
    size = (128, 128)
    y, x = places(size)
    rib = np.abs(x - 0.5)
    vein = np.abs(np.sin(np.pi * rows * (y - 0.9 * rib)))
    picture = mix(0.6 * fractal(size, 16, 217, 3) + 0.4 * y, (0.16, 0.38, 0.14), (0.36, 0.60, 0.24))
    light = np.maximum(np.exp(-((rib / 0.022) ** 2)), 0.55 * np.exp(-((vein / 0.14) ** 2)))
    return np.clip(picture + 0.20 * light[..., None] * np.array((0.9, 1.0, 0.6)), 0.0, 1.0)


def _soil() -> Any:
    size = (128, 128)
    return mix(fractal(size, 6, 219, 4), (0.16, 0.11, 0.07), (0.38, 0.28, 0.20))


def _cork() -> Any:
    size = (128, 128)
    speck = field(size, 1.2, 229)
    return mix(0.5 * fractal(size, 9, 230, 3) + 0.5 * speck, (0.52, 0.36, 0.22), (0.84, 0.66, 0.45))


def _brushed() -> Any:
    """Metal brushed along the rows."""
    return grey(0.93 + 0.055 * (field((256, 256), (0.6, 60), 231) - 0.5))


def _cardboard() -> Any:
    ridge = field((128, 128), (0.6, 24), 233)
    return grey(0.92 + 0.08 * ridge + 0.08 * (fractal((128, 128), 20, 234, 3) - 0.5))


def _basketball() -> Any:
    """Pebbled, with black seams: two great circles and two side curves."""
    size = (256, 256)
    y, x = places(size)
    lon, lat = 2 * np.pi * x, np.pi * (0.5 - y)
    px, py, pz = np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)
    curve = np.abs(np.abs(px) - 0.42 - 0.42 * pz**2)
    seam = np.minimum(np.minimum(np.abs(py), np.abs(pz)), curve) < 0.024
    picture = mix(field(size, 1.0, 235), (0.70, 0.30, 0.10), (0.90, 0.46, 0.18))
    return np.where(seam[..., None], 0.06, picture)


TEXTURES: Book = {
    "apple": (_apple, 0.0),
    "tomato": (_tomato, 0.0),
    "lettuce": (_lettuce, 0.0),
    "bread": (_bread, 0.30),
    "potato": (_potato, 0.0),
    "egg": (_egg, 0.0),
    "leaf": (partial(_leaf, 7), 0.0),
    "soil": (_soil, 0.15),
    "cork": (_cork, 0.15),
    "brushed": (_brushed, 0.30),
    "cardboard": (_cardboard, 0.30),
    "basketball": (_basketball, 0.0),
}
