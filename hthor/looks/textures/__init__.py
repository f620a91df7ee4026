"""Pictures made by numbers alone, for surfaces of every sort.

Each is (H, W, 3) uint8 and at most 512 pixels a side; row 0 lies at v = 0, column 0 at u = 0. Those with a `scale`
repeat without a seam and are near white, to be multiplied by a color; the others fill what they are on.
"""

from functools import lru_cache
from typing import Any

import numpy as np

from hthor.errors import UnknownName
from hthor.looks.textures import cloths, nature, pictures, stones, woods

_BOOK = {**woods.TEXTURES, **stones.TEXTURES, **cloths.TEXTURES, **nature.TEXTURES, **pictures.TEXTURES}


def names() -> tuple[str, ...]:
    """Every texture's name."""
    return tuple(_BOOK)


@lru_cache(maxsize=128)
def image(name: str) -> Any:
    """The picture, (H, W, 3) uint8, the same bytes every time; do not write to it.

    Raises:
        UnknownName: when there is no such texture.
    """
    picture = np.clip(_entry(name)[0](), 0.0, 1.0)
    pixels = np.ascontiguousarray(np.round(picture * 255.0), np.uint8)
    pixels.setflags(write=False)
    return pixels


def scale(name: str) -> float:
    """How many metres one repeat covers; 0 for a picture that is stretched over what it is on, or for no name."""
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
