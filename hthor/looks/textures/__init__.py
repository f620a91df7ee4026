"""Computed pictures for all sorts of surfaces.

Each is (H, W, 3) uint8 with at most 512 pixels per side; row 0 is at v = 0, column 0 at u = 0. Textures with a `scale`
repeat without a seam and are nearly white, to be multiplied by a color; the others are stretched over a surface.
"""

from functools import lru_cache
from typing import Any

import numpy as np

from hthor.errors import UnknownName
from hthor.looks.textures import cloths, nature, pictures, stones, woods

_BOOK = {**woods.TEXTURES, **stones.TEXTURES, **cloths.TEXTURES, **nature.TEXTURES, **pictures.TEXTURES}


def names() -> tuple[str, ...]:
    """The names of all textures."""
    return tuple(_BOOK)


@lru_cache(maxsize=128)
def image(name: str) -> Any:
    """The picture, (H, W, 3) uint8; it has the same bytes every time, and must not be written to.

    Raises:
        UnknownName: if there is no such texture.
    """
    picture = np.clip(_entry(name)[0](), 0.0, 1.0)
    pixels = np.ascontiguousarray(np.round(picture * 255.0), np.uint8)
    pixels.setflags(write=False)
    return pixels


def scale(name: str) -> float:
    """How many metres one repeat covers; 0 if the picture is stretched over its surface, or for an empty name."""
    return _entry(name)[1] if name else 0.0


@lru_cache(maxsize=128)
def mean(name: str) -> tuple[float, float, float]:
    """The mean color, each channel 0 to 1."""
    r, g, b = (float(channel) / 255.0 for channel in image(name).reshape(-1, 3).mean(axis=0))
    return (r, g, b)


def _entry(name: str) -> Any:
    try:
        return _BOOK[name]
    except KeyError:
        raise UnknownName("texture", name, _BOOK) from None
