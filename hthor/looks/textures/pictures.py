"""Pictures that are stretched over a surface: paintings, screens, book covers, print, dials, keys."""

import math
from functools import partial
from typing import Any

import numpy as np

from hthor.looks.textures.noise import Book, dice, field, fractal, grey, mix, places
from hthor.types import Vec3

_SIZE = (192, 256)


def _ridge(x: Any, seed: int, level: float, height: float) -> Any:
    """The skyline of hills: the row at each column."""
    chance = dice(seed)
    waves = [math.pow(0.55, k) * np.sin(2 * np.pi * (x * (1.3 + 1.7 * k) + float(chance.uniform()))) for k in range(5)]
    return level - height * 0.5 * (1.0 + np.sum(waves, axis=0) / 2.0)


def _landscape(seed: int, sky: tuple[Vec3, Vec3], hills: tuple[Vec3, ...], sun: Vec3, water: bool = False) -> Any:
    """Sky, a sun, ranges of hills that pale with distance, perhaps a lake; painted with visible strokes."""
    y, x = places(_SIZE)
    picture = mix(y * 1.7, sky[0], sky[1])
    cloud = np.clip((fractal(_SIZE, 22, seed, 4) - 0.55) * 4.0, 0.0, 1.0) * (y < 0.6)
    picture += 0.4 * cloud[..., None] * (1.0 - picture)
    at = 0.2 + 0.6 * float(dice(seed + 1).uniform())
    glow = np.exp(-((np.hypot((x - at) * 1.33, y - 0.3) / 0.10) ** 2))
    picture += glow[..., None] * (np.array(sun) - picture)
    for index, color in enumerate(hills):
        line = _ridge(x[0], seed + 10 + index, 0.52 + 0.14 * index, 0.20)
        shade = 0.86 + 0.28 * fractal(_SIZE, 14, seed + 20 + index, 3)
        land = y > line[None, :]
        picture = np.where(land[..., None], np.array(color) * shade[..., None], picture)
    if water:
        lake = y > 0.72
        mirror = picture[::-1][np.clip((np.arange(_SIZE[0]) * 0.9 - 30).astype(int), 0, _SIZE[0] - 1)]
        ripple = 0.88 + 0.14 * field(_SIZE, (0.8, 12), seed + 30)
        picture = np.where(lake[..., None], (0.55 * mirror + 0.45 * np.array(sky[0])) * ripple[..., None], picture)
    return np.clip(picture * (0.92 + 0.14 * field(_SIZE, (1, 4), seed + 31))[..., None], 0.0, 1.0)


def _abstract(seed: int, colors: tuple[Vec3, ...]) -> Any:
    """Overlapping discs and bands on a pale ground."""
    y, x = places(_SIZE)
    chance = dice(seed)
    picture = np.broadcast_to(np.array((0.93, 0.90, 0.84)), (*_SIZE, 3)).copy()
    for color in colors * 2:
        cx, cy, r = chance.uniform(0.1, 0.9), chance.uniform(0.1, 0.9), chance.uniform(0.10, 0.30)
        inside = np.hypot((x - cx) * 1.33, y - cy) < r if chance.uniform() < 0.6 else np.abs(y - cy) < r * 0.3
        picture = np.where(inside[..., None], 0.82 * np.array(color) + 0.18 * picture, picture)
    return np.clip(picture * (0.92 + 0.10 * field(_SIZE, 1.5, seed + 1))[..., None], 0.0, 1.0)


def _still_life() -> Any:
    """Flowers in a vase before a dark wall."""
    y, x = places(_SIZE)
    picture = mix(fractal(_SIZE, 30, 301, 3), (0.16, 0.18, 0.20), (0.30, 0.30, 0.28))
    picture[y > 0.80] = (0.42, 0.28, 0.18)
    vase = (np.abs(x - 0.5) < 0.07 + 0.05 * np.sin(np.pi * np.clip((y - 0.55) / 0.3, 0, 1))) & (y > 0.55) & (y < 0.86)
    picture[vase] = (0.62, 0.70, 0.76)
    chance = dice(302)
    petals = ((0.85, 0.36, 0.30), (0.92, 0.76, 0.36), (0.90, 0.86, 0.80), (0.66, 0.40, 0.58), (0.30, 0.46, 0.26))
    for index in range(46):
        cx, cy = 0.5 + 0.17 * chance.standard_normal(), 0.36 + 0.12 * chance.standard_normal()
        spot = np.hypot((x - cx) * 1.33, y - cy) < chance.uniform(0.03, 0.065)
        picture[spot] = np.array(petals[index % 5]) * chance.uniform(0.8, 1.0)
    return np.clip(picture * (0.86 + 0.24 * field(_SIZE, (1, 3), 303))[..., None], 0.0, 1.0)


def _bars(picture: Any, boxes: list[tuple[float, float, float, float, Vec3]]) -> Any:
    """Rectangles (left, top, right, bottom, color), as shares of the picture."""
    height, width = picture.shape[:2]
    for left, top, right, bottom, color in boxes:
        rows, columns = (
            slice(round(top * height), round(bottom * height)),
            slice(round(left * width), round(right * width)),
        )
        picture[rows, columns] = color
    return picture


def _text(picture: Any, seed: int, area: tuple[float, float, float, float], lines: int, ink: Vec3) -> Any:
    """Lines that look like words in an area (left, top, right, bottom)."""
    chance = dice(seed)
    left, top, right, bottom = area
    step = (bottom - top) / lines
    for line in range(lines):
        x, end = left, right if line % 5 != 4 else left + 0.6 * (right - left)
        while x < end:
            word = min(float(chance.uniform(0.02, 0.07)), end - x)
            picture = _bars(picture, [(x, top + step * (line + 0.25), x + word, top + step * (line + 0.75), ink)])
            x += word + 0.014
    return picture


def _show() -> Any:
    """A scene of a nature film, for a television."""
    picture = _landscape(
        311,
        ((0.20, 0.50, 0.85), (0.75, 0.88, 0.96)),
        ((0.38, 0.52, 0.66), (0.18, 0.42, 0.28), (0.10, 0.28, 0.14)),
        (1.0, 0.95, 0.75),
        water=True,
    )
    return _bars(picture, [(0.04, 0.86, 0.34, 0.93, (0.05, 0.07, 0.12)), (0.05, 0.885, 0.26, 0.905, (0.9, 0.9, 0.9))])


def _desktop(seed: int, top: Vec3, low: Vec3) -> Any:
    """A computer's screen: a wallpaper, two windows, a bar of icons."""
    y, _ = places((160, 256))
    picture = mix(0.6 * y + 0.4 * fractal((160, 256), 50, seed, 2), top, low)
    picture = _bars(
        picture, [(0.08, 0.10, 0.60, 0.78, (0.96, 0.96, 0.97)), (0.08, 0.10, 0.60, 0.16, (0.24, 0.28, 0.36))]
    )
    picture = _text(picture, seed + 1, (0.11, 0.20, 0.56, 0.74), 14, (0.42, 0.44, 0.48))
    picture = _bars(
        picture, [(0.52, 0.30, 0.92, 0.84, (0.13, 0.15, 0.19)), (0.52, 0.30, 0.92, 0.36, (0.30, 0.33, 0.40))]
    )
    picture = _text(picture, seed + 2, (0.54, 0.40, 0.82, 0.80), 10, (0.46, 0.76, 0.56))
    icons = [(0.30 + 0.06 * k, 0.925, 0.335 + 0.06 * k, 0.975, c) for k, c in enumerate(_ICONS)]
    return _bars(picture, [(0.0, 0.90, 1.0, 1.0, (0.10, 0.12, 0.16)), *icons])


_ICONS: tuple[Vec3, ...] = ((0.26, 0.56, 0.90), (0.94, 0.70, 0.24), (0.36, 0.72, 0.44), (0.88, 0.34, 0.30),
    (0.70, 0.46, 0.80), (0.9, 0.9, 0.9))  # fmt: skip


def _cover(seed: int, ground: Vec3, accent: Vec3, style: int) -> Any:
    """A book's front cover: a title, a drawing, an author's name."""
    size = (192, 128)
    y, x = places(size)
    picture = np.broadcast_to(np.array(ground), (*size, 3)) * (0.90 + 0.10 * field(size, 1, seed))[..., None]
    r, g, b = ground
    pale = (0.15 * r + 0.85, 0.15 * g + 0.85, 0.15 * b + 0.85)
    if style == 0:
        picture[np.hypot((x - 0.5) * 0.67, y - 0.58) < 0.19] = accent
    elif style == 1:
        picture[(y > 0.70 - 0.16 * np.abs(np.sin(5 * x))) & (y < 0.84)] = accent
    else:
        picture[(np.minimum(np.minimum(x * 0.67, (1 - x) * 0.67), np.minimum(y, 1 - y)) - 0.05) ** 2 < 0.00016] = accent
    title = [(0.16, 0.13, 0.84, 0.19, pale), (0.26, 0.22, 0.74, 0.27, pale), (0.32, 0.89, 0.68, 0.92, pale)]
    return np.clip(_bars(picture, title), 0.0, 1.0)


def _pages() -> Any:
    """The edges of many pages, one above the other."""
    return mix(field((64, 64), (0.5, 30), 331), (0.80, 0.76, 0.66), (0.98, 0.96, 0.90))


def _newspaper() -> Any:
    picture = grey(0.86 + 0.06 * field((256, 192), 2, 333)) * np.array((1.0, 0.99, 0.94))
    ink = (0.22, 0.22, 0.22)
    picture = _bars(
        picture, [(0.06, 0.03, 0.94, 0.10, (0.14, 0.14, 0.14)), (0.10, 0.045, 0.90, 0.085, (0.86, 0.85, 0.80))]
    )
    picture = _text(picture, 334, (0.08, 0.12, 0.92, 0.20), 2, (0.15, 0.15, 0.15))
    photo = _landscape(335, ((0.6,) * 3, (0.8,) * 3), ((0.5,) * 3, (0.35,) * 3), (0.95,) * 3)[::3, ::3][:60, :78]
    picture[56 : 56 + len(photo), 100 : 100 + photo.shape[1]] = photo
    picture = _text(picture, 336, (0.06, 0.23, 0.48, 0.96), 40, ink)
    return _text(picture, 337, (0.53, 0.48, 0.93, 0.96), 27, ink)


def _dial(face: Vec3, ink: Vec3) -> Any:
    """A clock's face at ten past ten, on a square."""
    size = (192, 192)
    y, x = places(size)
    px, py = (x - 0.5) * 2, (0.5 - y) * 2
    far, angle = np.hypot(px, py), np.arctan2(px, py)
    picture = np.broadcast_to(np.array(face), (*size, 3)).copy()
    hour = np.abs((angle / (2 * np.pi) * 12 + 0.5) % 1.0 - 0.5) * (2 * np.pi / 12) * far
    picture[(hour < 0.022) & (far > 0.74) & (far < 0.90)] = ink
    for turn, length, width in ((2 * np.pi * 10.17 / 12, 0.48, 0.035), (2 * np.pi * 10 / 60, 0.70, 0.024)):
        along, across = px * np.sin(turn) + py * np.cos(turn), px * np.cos(turn) - py * np.sin(turn)
        picture[(np.abs(across) < width) & (along > -0.1) & (along < length)] = ink
    picture[far < 0.05] = ink
    return picture


def _keys(rows: int, columns: int, body: Vec3, key: Vec3, ink: Vec3) -> Any:
    """A block of keys with a mark on each key."""
    y, x = places((128, 256))
    u, v = x * columns % 1.0, y * rows % 1.0
    inside = (np.abs(u - 0.5) < 0.42) & (np.abs(v - 0.5) < 0.40)
    mark = (np.abs(u - 0.40) < 0.07) & (np.abs(v - 0.40) < 0.12)
    picture = np.where(inside[..., None], np.array(key), np.array(body))
    return np.where((inside & mark)[..., None], np.array(ink), picture)


def _digits() -> Any:
    """The display of an alarm clock, 07:30."""
    picture = np.zeros((64, 128, 3)) + 0.03
    lit = (0.95, 0.22, 0.14)
    segments = {"0": "abcdef", "7": "abc", "3": "abgcd"}
    boxes = {"a": (0.1, 0.0, 0.9, 0.1), "b": (0.8, 0.05, 1.0, 0.5), "c": (0.8, 0.5, 1.0, 0.95),
        "d": (0.1, 0.9, 0.9, 1.0), "e": (0.0, 0.5, 0.2, 0.95), "f": (0.0, 0.05, 0.2, 0.5),
        "g": (0.1, 0.45, 0.9, 0.55)}  # fmt: skip
    for index, digit in enumerate("0730"):
        left = 0.08 + 0.21 * index + (0.06 if index > 1 else 0.0)
        for name in segments[digit]:
            a, b, c, d = boxes[name]
            picture = _bars(picture, [(left + 0.15 * a, 0.2 + 0.6 * b, left + 0.15 * c, 0.2 + 0.6 * d, lit)])
    return _bars(picture, [(0.495, 0.35, 0.52, 0.42, lit), (0.495, 0.58, 0.52, 0.65, lit)])


def _hob() -> Any:
    """A glass hob with four rings."""
    y, x = places((192, 192))
    picture = grey(np.full((192, 192), 0.05))
    for cx, cy, r in ((0.28, 0.28, 0.15), (0.72, 0.28, 0.18), (0.28, 0.72, 0.19), (0.72, 0.72, 0.15)):
        far = np.hypot(x - cx, y - cy)
        for share in (1.0, 0.62):
            picture[np.abs(far - r * share) < 0.008] = (0.42, 0.42, 0.44)
    return _bars(picture, [(0.40, 0.95, 0.60, 0.965, (0.5, 0.5, 0.5))])


def _glaze() -> Any:
    """The reflection in every mirror: light from above that fades downwards, with slanting gleams."""
    y, x = places((128, 128))
    gleam = 0.06 * np.exp(-(((x + y - 0.7) / 0.10) ** 2)) + 0.04 * np.exp(-(((x + y - 1.15) / 0.05) ** 2))
    return mix(y, (0.84, 0.88, 0.90), (0.62, 0.66, 0.68)) + gleam[..., None]


_TEAL, _RUST, _GOLD = (0.20, 0.44, 0.46), (0.74, 0.36, 0.22), (0.88, 0.68, 0.30)
_NAVY, _ROSE = (0.17, 0.22, 0.36), (0.84, 0.60, 0.56)
_DAY = ((0.42, 0.64, 0.86), (0.88, 0.92, 0.92))
_DUSK = ((0.36, 0.30, 0.52), (0.97, 0.66, 0.42))
_MIST = ((0.70, 0.78, 0.80), (0.92, 0.92, 0.88))
_GREENS = ((0.52, 0.64, 0.62), (0.40, 0.56, 0.36), (0.28, 0.44, 0.22), (0.20, 0.34, 0.16))
_BLUES = ((0.56, 0.62, 0.74), (0.38, 0.46, 0.60), (0.22, 0.30, 0.44))
_SANDS = ((0.80, 0.62, 0.50), (0.72, 0.48, 0.34), (0.50, 0.32, 0.26))

TEXTURES: Book = {
    "landscape_1": (partial(_landscape, 341, _DAY, _GREENS, (1.0, 0.97, 0.86)), 0.0),
    "landscape_2": (partial(_landscape, 345, _DUSK, _BLUES, (1.0, 0.86, 0.58), True), 0.0),
    "landscape_3": (partial(_landscape, 352, _DUSK, _SANDS, (1.0, 0.90, 0.66)), 0.0),
    "landscape_4": (partial(_landscape, 357, _MIST, _BLUES, (1.0, 1.0, 0.96), True), 0.0),
    "abstract_1": (partial(_abstract, 361, (_TEAL, _RUST, _GOLD)), 0.0),
    "abstract_2": (partial(_abstract, 363, (_NAVY, _ROSE, _GOLD, _TEAL)), 0.0),
    "still_life": (_still_life, 0.0),
    "show": (_show, 0.0),
    "desktop": (partial(_desktop, 371, (0.16, 0.30, 0.52), (0.46, 0.36, 0.60)), 0.0),
    "desktop_2": (partial(_desktop, 374, (0.10, 0.36, 0.40), (0.66, 0.70, 0.50)), 0.0),
    "cover_1": (partial(_cover, 381, (0.66, 0.26, 0.18), _GOLD, 0), 0.0),
    "cover_2": (partial(_cover, 382, _NAVY, (0.80, 0.84, 0.86), 1), 0.0),
    "cover_3": (partial(_cover, 383, (0.24, 0.42, 0.32), _GOLD, 2), 0.0),
    "cover_4": (partial(_cover, 384, (0.86, 0.80, 0.66), _RUST, 1), 0.0),
    "pages": (_pages, 0.05),
    "newspaper": (_newspaper, 0.0),
    "dial": (partial(_dial, (0.96, 0.95, 0.91), (0.12, 0.12, 0.13)), 0.0),
    "dial_dark": (partial(_dial, (0.14, 0.15, 0.17), (0.92, 0.90, 0.84)), 0.0),
    "keyboard": (partial(_keys, 5, 14, (0.30, 0.31, 0.33), (0.10, 0.10, 0.11), (0.66, 0.66, 0.68)), 0.0),
    "keypad": (partial(_keys, 6, 3, (0.08, 0.08, 0.09), (0.26, 0.27, 0.29), (0.86, 0.86, 0.84)), 0.0),
    "digits": (_digits, 0.0),
    "hob": (_hob, 0.0),
    "glaze": (_glaze, 0.0),
}
