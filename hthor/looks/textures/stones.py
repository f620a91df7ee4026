"""Textures of mineral surfaces: tiles, marble, granite, brick, plaster, concrete."""

from functools import partial
from typing import Any

import numpy as np

from hthor.looks.textures.noise import Book, dice, field, fractal, grey, mix, places


def _tiles(across: int, down: int, grout: float, spread: float, seed: int, shift: bool = False, size: int = 256) -> Any:
    """Tiles with grout: ``grout`` is the grout's brightness, ``shift`` moves every second row by half a tile."""
    y, x = np.mgrid[0:size, 0:size]
    row = y * down // size
    x = (x + np.where(shift & (row % 2 == 1), size // across // 2, 0)) % size
    column = x * across // size
    tone = dice(seed).uniform(1.0 - spread, 1.0, (down, across))[row, column]
    near = np.minimum.reduce([x * across % size / across, y * down % size / down])
    far = np.minimum((size - x * across % size) / across, (size - y * down % size) / down)
    edge = np.minimum(near, far)
    gloss = 0.97 + 0.03 * field((size, size), 12, seed + 1)
    value = np.where(edge < 1.6, grout, tone * gloss * np.where(edge < 3.2, 0.95, 1.0))
    return grey(value)


def _checker(cells: int = 4, size: int = 256) -> Any:
    y, x = np.mgrid[0:size, 0:size] * cells // size
    dark = (x + y) % 2 == 0
    veins = _veins((size, size), 81)
    value = np.where(dark, 0.13 + 0.10 * veins, 0.97 - 0.12 * veins)
    y, x = np.mgrid[0:size, 0:size] * cells % size
    return grey(np.where(np.minimum(x, y) < cells * 1.5, 0.55, value))


def _veins(size: tuple[int, int], seed: int) -> Any:
    """Thin dark lines (H, W), 0 to 1, where two noise fields have equal values."""
    flow = fractal(size, size[0] / 6, seed, 4)
    return np.exp(-((np.abs(flow - 0.5) / 0.028) ** 1.2)) * field(size, size[0] / 9, seed + 9)


def _marble() -> Any:
    size = (256, 256)
    cloud = fractal(size, 40, 61, 3)
    return np.clip(mix(cloud, (0.90, 0.90, 0.91), (1.0, 1.0, 1.0)) - (0.38 * _veins(size, 65))[..., None], 0.0, 1.0)


def _granite() -> Any:
    size = (256, 256)
    speck, fleck = field(size, 0.8, 71), field(size, 1.6, 72)
    value = 0.84 + 0.10 * (fractal(size, 20, 73, 3) - 0.5) + 0.35 * (speck - 0.5)
    value = np.where(fleck > 0.70, value * 0.62, value)
    return grey(np.where(fleck < 0.27, value * 1.15, value))


def _terrazzo() -> Any:
    size = (256, 256)
    base = grey(0.93 + 0.04 * field(size, 4, 91))
    for seed, color in ((92, (0.62, 0.55, 0.50)), (93, (0.85, 0.66, 0.52)), (94, (0.50, 0.56, 0.60))):
        base[field(size, 3.2, seed) > 0.74] = color
    return base


def _brick(mortar: float = 1.0, size: int = 256) -> Any:
    """Eight courses of four bricks."""
    y, x = np.mgrid[0:size, 0:size]
    row = y * 8 // size
    x = (x + (row % 2) * size // 8) % size
    tone = dice(31).uniform(0.35, 1.0, (8, 4))[row, x * 4 // size]
    rough = 0.86 + 0.14 * fractal((size, size), 6, 32, 3)
    gap = (x * 4 % size < 4 * 3) | (y * 8 % size < 8 * 3)
    red = mix(tone, (0.62, 0.54, 0.50), (0.92, 0.86, 0.82)) * rough[..., None]
    return np.where(gap[..., None], mortar * rough[..., None] * np.array((1.0, 0.99, 0.96)), red)


def _plaster() -> Any:
    """A wall painted with a roller: faint, shallow bumps in light from the side."""
    bumps = fractal((256, 256), 9, 33, 4)
    relief = np.roll(bumps, 1, axis=0) - bumps
    return grey(0.955 + 0.03 * (bumps - 0.5) + 0.28 * relief)


def _concrete() -> Any:
    size = (256, 256)
    value = 0.88 + 0.14 * (fractal(size, 40, 34, 5) - 0.5) + 0.06 * (field(size, 0.8, 35) - 0.5)
    pores = field(size, 1.3, 36) > 0.83
    return mix(np.where(pores, value - 0.14, value), (0.0, 0.0, 0.0), (1.0, 1.0, 0.98))


def _wallpaper() -> Any:
    """Broad soft stripes."""
    _, x = places((256, 256))
    stripe = 0.5 + 0.5 * np.tanh(8.0 * np.sin(2 * np.pi * 4 * x))
    return grey(0.90 + 0.07 * stripe + 0.02 * (field((256, 256), 1, 37) - 0.5))


def _panels() -> Any:
    """Painted, upright tongue-and-groove boards."""
    _, x = places((256, 256))
    near = np.abs(x * 8 % 1.0 - 0.5)
    return grey(np.where(near > 0.47, 0.74, 0.97 - 0.25 * np.maximum(near - 0.42, 0.0)))


TEXTURES: Book = {
    "tile": (partial(_tiles, 4, 4, 0.80, 0.06, 11), 1.2),
    "tile_small": (partial(_tiles, 8, 8, 0.80, 0.10, 12), 0.8),
    "tile_large": (partial(_tiles, 2, 2, 0.78, 0.03, 13), 1.2),
    "subway": (partial(_tiles, 4, 8, 0.78, 0.05, 14, True), 0.8),
    "checker": (_checker, 1.2),
    "marble": (_marble, 1.6),
    "granite": (_granite, 0.35),
    "terrazzo": (_terrazzo, 0.8),
    "brick": (_brick, 0.96),
    "plaster": (_plaster, 1.5),
    "concrete": (_concrete, 2.0),
    "wallpaper": (_wallpaper, 0.8),
    "panels": (_panels, 0.8),
}
