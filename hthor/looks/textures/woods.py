"""Textures of wood: grain for furniture, and boards for floors, in tones that a color is multiplied with."""

from functools import partial
from typing import Any

import numpy as np

from hthor.looks.textures.noise import Book, dice, field, mix

_DARK, _LIGHT = (0.66, 0.58, 0.50), (1.0, 1.0, 1.0)


def grain(size: tuple[int, int] = (256, 256), seed: int = 1, rings: float = 26.0) -> Any:
    """Lightness of the wood (H, W), 0 to 1; the fibres run along the rows."""
    fibre, streak = field(size, (0.8, 30.0), seed), field(size, (2.5, 60.0), seed + 1)
    flow = field(size, (size[0] / 18, size[1] / 3), seed + 2)
    ring = 0.5 + 0.5 * np.sin(rings * flow + 4.0 * streak)
    return np.clip(0.30 + 0.42 * fibre + 0.30 * streak + 0.24 * ring - 0.25, 0.0, 1.0)


def _wood() -> Any:
    return mix(0.35 + 0.65 * grain(), _DARK, _LIGHT)


def _boards(rows: int, joints: int, seed: int, gap: float, contrast: float, size: int = 512) -> Any:
    """Floor boards: rows of pieces that differ in tone, with dark gaps."""
    chance = dice(seed)
    share = 0.35 + 0.65 * grain((size, size), seed, 60.0)
    tone = np.ones((size, size))
    groove = np.zeros((size, size))
    height = size // rows
    for row in range(rows):
        band = slice(row * height, (row + 1) * height)
        share[band] = np.roll(share[band], int(chance.integers(size)), axis=1)
        start = int(chance.integers(size))
        cuts = (start + np.arange(joints) * size // joints) % size
        for cut, value in zip(cuts, chance.uniform(1.0 - contrast, 1.0, joints), strict=True):
            columns = (cut + np.arange(size // joints + 1)) % size
            tone[band, columns] = value
            groove[band, cut] = groove[band, (cut + 1) % size] = 1.0
        groove[row * height] = groove[(row + 1) * height - 1] = 1.0
    return np.clip(mix(share, _DARK, _LIGHT) * (tone * (1.0 - gap * groove))[..., None], 0.0, 1.0)


def _parquet() -> Any:
    """Square blocks whose strips run along and across in turn."""
    size, blocks, strips = 512, 4, 5
    chance = dice(41)
    share = 0.35 + 0.65 * grain((size, size), 42, 60.0)
    side = size // blocks
    picture = np.zeros((size, size, 3))
    for row in range(blocks):
        for column in range(blocks):
            y, x = row * side, column * side
            cell = mix(share[y : y + side, x : x + side], _DARK, _LIGHT)
            edge = (np.arange(side) * strips // side)[:, None]
            tones = chance.uniform(0.80, 1.0, strips)[edge]
            line = (np.arange(side) * strips % side < strips)[:, None]
            cell = cell * (tones * np.where(line, 0.72, 1.0))[..., None]
            cell[:, :1] *= 0.72
            picture[y : y + side, x : x + side] = cell if (row + column) % 2 else cell.swapaxes(0, 1)
    return picture


def _herringbone() -> Any:
    """Boards of one by four units in a zigzag; the pattern repeats after eight units in both directions."""
    size, unit = 512, 64
    y, x = np.mgrid[0:size, 0:size]
    cx, cy = x // unit, y // unit
    phase = (cx - cy) % 8
    lying = phase < 4
    start_x, start_y = np.where(lying, cx - phase, cx) % 8, np.where(lying, cy, cy - (7 - phase)) % 8
    number = start_x * 8 + start_y
    tone = dice(51).uniform(0.80, 1.0, 64)[number]
    along = 0.35 + 0.65 * grain((size, size), 52, 60.0)
    share = np.where(lying, along, along.T) + 0.2 * dice(53).uniform(-1.0, 1.0, 64)[number]
    side, end = np.where(lying, y % unit, x % unit), np.where(lying, x % unit, y % unit)
    groove = (side < 2) | ((end < 2) & ((phase == 0) | (phase == 7)))
    return mix(share, _DARK, _LIGHT) * (tone * np.where(groove, 0.66, 1.0))[..., None]


TEXTURES: Book = {
    "wood": (_wood, 0.9),
    "planks": (partial(_boards, 8, 2, 21, 0.45, 0.20), 1.6),
    "planks_wide": (partial(_boards, 4, 1, 23, 0.40, 0.14), 1.2),
    "planks_worn": (partial(_boards, 8, 3, 27, 0.60, 0.42), 1.6),
    "parquet": (_parquet, 1.2),
    "herringbone": (_herringbone, 0.8),
}
