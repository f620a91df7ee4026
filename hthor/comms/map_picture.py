"""Draws the map of a person's display: distance rings, the person in the middle, senders and places around them.

The way the person looks is up. There are no walls and no paths, and nothing is seen from above: the map knows only the
directions and distances in a `DisplayMap`.
"""

import math
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hthor.types import DisplayMap, Vec2, is_person

CODE_PART = "tools"

Rgb = tuple[int, int, int]

SIZE_PX = 240
"""Side of the picture if none is given [pixels]."""
_RANGES_M = (4.0, 8.0, 16.0, 32.0, 64.0)
"""Radii of the outer ring; the smallest that has everything inside is used, and farther marks stand on its edge."""
_FINER = 3
"""The picture is drawn this many times larger and averaged, which makes edges smooth."""
_RING = 0.40
"""Radius of the outer ring, as a share of the side."""
_PAPER, _RING_SHADE, _INK = (250, 250, 247), (196, 200, 206), (70, 74, 82)
_PERSON, _OTHER_PERSON, _ROBOT, _PLACE = (0, 114, 178), (0, 31, 84), (213, 94, 0), (122, 59, 143)
_LETTER, _LEAST_LETTER = 0.0019, 0.4
"""Size of letters in units of OpenCV's: a share of the side, and at least."""


def draw_map(
    shown: DisplayMap, size: int = SIZE_PX, colours: Mapping[str, Rgb] | None = None, person: Rgb = _PERSON
) -> NDArray[np.uint8]:
    """The picture of a map, (size, size, 3) uint8.

    Args:
        size: its side [pixels].
        colours: of the senders, by seat; by default one for robots and one for other people.
        person: the colour of the person in the middle.
    """
    marks = [(body.forward, body.left) for body in shown.bodies] + [(one.forward, one.left) for one in shown.places]
    sheet = _Sheet(size, _range(marks))
    for place in shown.places:
        sheet.star(sheet.at(place.forward, place.left), 0.036, _PLACE)
    for body in shown.bodies:
        sheet.disk(sheet.at(body.forward, body.left), 0.028, (colours or {}).get(body.seat) or _shade(body.seat))
    sheet.arrowhead((0.5, 0.5), 0.045, person)
    picture = sheet.picture()
    sheet.ring_labels(picture)
    for place in shown.places:
        metres = math.hypot(place.forward, place.left)
        _write(picture, f"{metres:.1f} m", sheet.at(place.forward, place.left), -0.058, _PLACE)
    for body in shown.bodies:
        shade = (colours or {}).get(body.seat) or _shade(body.seat)
        _write(picture, body.seat, sheet.at(body.forward, body.left), 0.058, shade)
    return picture


def _range(marks: list[Vec2]) -> float:
    """Radius [m] of the outer ring."""
    farthest = max((math.hypot(*mark) for mark in marks), default=0.0)
    return next((metres for metres in _RANGES_M if farthest <= metres), _RANGES_M[-1])


def _shade(seat: str) -> Rgb:
    return _OTHER_PERSON if is_person(seat) else _ROBOT


@lru_cache(maxsize=4)
def _rings(side: int) -> NDArray[np.float32]:
    """A bare map with the outer ring and one at half its distance, (side, side, 3)."""
    pixels = np.empty((side, side, 3), dtype=np.float32)
    pixels[:] = _PAPER
    for share in (1.0, 0.5):
        _disk(pixels, (0.5, 0.5), _RING * share + 0.003, _RING_SHADE)
        _disk(pixels, (0.5, 0.5), _RING * share - 0.003, _PAPER)
    return pixels


def _disk(pixels: NDArray[np.float32], place: Vec2, radius: float, shade: Rgb) -> None:
    from skimage import draw  # late: a slow import

    side = len(pixels)
    pixels[draw.disk((place[0] * side, place[1] * side), radius * side, shape=pixels.shape[:2])] = shade


class _Sheet:
    """A picture while it is drawn; places are (row, column) as shares of its side."""

    def __init__(self, size: int, metres: float) -> None:
        self._side, self._metres = size * _FINER, metres
        self._pixels: Any = _rings(self._side).copy()

    def at(self, forward: float, left: float) -> Vec2:
        """Where a point of the person's frame [m] is; beyond the outer ring it is moved onto the ring."""
        far = math.hypot(forward, left)
        scale = _RING / self._metres * min(1.0, self._metres / far if far > 0.0 else 1.0)
        return 0.5 - scale * forward, 0.5 - scale * left

    def disk(self, place: Vec2, radius: float, shade: Rgb) -> None:
        """A disk; ``radius`` as a share of the side."""
        _disk(self._pixels, place, radius, shade)

    def arrowhead(self, place: Vec2, radius: float, shade: Rgb) -> None:
        """An arrowhead that points up, as the person looks."""
        corners = [(-1.0, 0.0), (0.8, 0.75), (0.4, 0.0), (0.8, -0.75)]
        self._polygon([(place[0] + radius * row, place[1] + radius * column) for row, column in corners], shade)

    def star(self, place: Vec2, radius: float, shade: Rgb) -> None:
        """A star with five points."""
        turns = [(math.pi * k / 5.0, radius * (1.0 if k % 2 == 0 else 0.42)) for k in range(10)]
        self._polygon([(place[0] - far * math.cos(a), place[1] + far * math.sin(a)) for a, far in turns], shade)

    def picture(self) -> NDArray[np.uint8]:
        """What was drawn, in its final size."""
        import cv2  # late: a slow import

        size = self._side // _FINER
        averaged: Any = cv2.resize(self._pixels, (size, size), interpolation=cv2.INTER_AREA)
        return np.ascontiguousarray(averaged.round().astype(np.uint8))

    def ring_labels(self, picture: NDArray[np.uint8]) -> None:
        """Write the radii of the rings below the middle."""
        for share in (0.5, 1.0):
            _write(picture, f"{self._metres * share:g} m", (0.5 + _RING * share, 0.5), 0.045, _INK)

    def _polygon(self, corners: list[Vec2], shade: Rgb) -> None:
        from skimage import draw  # late: a slow import

        rows, columns = zip(*((row * self._side, column * self._side) for row, column in corners), strict=True)
        self._pixels[draw.polygon(rows, columns, shape=self._pixels.shape[:2])] = shade


def _write(picture: NDArray[np.uint8], words: str, place: Vec2, below: float, shade: Rgb) -> None:
    """Write words centred ``below`` a place (a share of the side, negative for above), inside the picture."""
    import cv2  # late: a slow import

    side, font = len(picture), cv2.FONT_HERSHEY_SIMPLEX
    letter = max(_LETTER * side, _LEAST_LETTER)
    (wide, high), _ = cv2.getTextSize(words, font, letter, 1)
    x = min(max(place[1] * side - wide / 2.0, 2.0), side - wide - 2.0)
    y = min(max((place[0] + below) * side + high / 2.0, high + 2.0), side - 3.0)
    cv2.putText(picture, words, (round(x), round(y)), font, letter, shade, 1, cv2.LINE_AA)
