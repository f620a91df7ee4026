"""Draws the panel of a person's display: the picture and the words of a message, and what the buttons do."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from hthor.report.drawing import lettering, text_fit, trial_trace
from hthor.types.events import Sent

_DPI = 100
_PT = 0.09
"""Size of the letters [pt], as a share of the panel's height or of 0.7 of its width [px]; between these two."""
_LEAST_PT, _MOST_PT = 5.0, 11.0
_EDGE_PX = 5
"""Free space around everything [pixels]."""
_BESIDE = 1.5
"""From this shape on (width over height), the picture is beside the words, else above them."""
_PICTURE = (0.5, 0.6)
"""Greatest share of the panel's width, or of its height, that the picture takes."""
_SPARE = 0.96
"""Words fill this share of a line at most: drawn letters are a little wider than measured ones."""
_BUTTONS = {False: "A confirm   B decline", True: "A yes   B no"}


def draw_panel(message: Sent, wide: int, high: int, image: Any = None, *, answered: bool = False) -> Any:
    """The panel with a message, (high, wide, 3) uint8.

    Args:
        image: the message's picture, (H, W, 3) uint8; None to leave it out.
        answered: whether the message was answered, so that no button has an effect any more.
    """
    panel = np.full((high, wide, 3), 255, dtype=np.uint8)
    top, left, size = _EDGE_PX, _EDGE_PX, _letters(wide, high)
    foot = 0 if answered else round(2.0 * size / 72.0 * _DPI)
    if image is not None:
        beside = wide > _BESIDE * high
        across, down = (_PICTURE[0], 1.0) if beside else (1.0, _PICTURE[1])
        picture = _fitted(image, round(across * (wide - 2 * _EDGE_PX)), round(down * (high - foot - 2 * _EDGE_PX)))
        panel[top : top + len(picture), left : left + picture.shape[1]] = picture
        left, top = (left + picture.shape[1] + _EDGE_PX, top) if beside else (left, top + len(picture) + _EDGE_PX)
    words = _words(message.seat, message.text, size, wide - left - _EDGE_PX, high - top - foot - _EDGE_PX)
    panel[top : top + len(words), left : left + words.shape[1]] = words
    if foot:
        buttons = _line(_BUTTONS[message.question], size, wide - 2 * _EDGE_PX, foot)
        panel[high - foot : high, _EDGE_PX : wide - _EDGE_PX] = buttons
    return panel


def _letters(wide: int, high: int) -> float:
    """Size of the letters on a panel of this size [pt]."""
    return min(_MOST_PT, max(_LEAST_PT, _PT * min(high, wide / 1.4) * 72.0 / _DPI))


def _fitted(image: Any, wide: int, high: int) -> Any:
    """The picture in its own shape, as large as there is room."""
    share = min(wide / image.shape[1], high / image.shape[0])
    size = (max(1, round(share * image.shape[1])), max(1, round(share * image.shape[0])))
    return cv2.resize(image, size, interpolation=cv2.INTER_AREA)


@lru_cache(maxsize=64)
@lettering.plain_lettering()
def _words(sender: str, text: str, size: float, wide: int, high: int) -> Any:
    """Sender and text in black on white, (high, wide, 3) uint8; a text that is too long is cut off."""
    sheet = _sheet(wide, high)
    line = 1.35 * size / 72.0 * _DPI / high
    room, lines = max(1, int((1.0 - line) / line)), text_fit.wrap(text, _SPARE * wide / _DPI, size)
    if len(lines) > room:
        lines = [*lines[: room - 1], f"{lines[room - 1]} …"]
    colour = trial_trace.seat_colour(sender)
    sheet.text(0.0, 1.0, sender, fontsize=size, weight="bold", color=colour, va="top")
    sheet.text(0.0, 1.0 - line, "\n".join(lines), fontsize=size, color=trial_trace.INK, va="top", linespacing=1.1)
    return _pixels(sheet)


@lru_cache(maxsize=64)
@lettering.plain_lettering()
def _line(words: str, size: float, wide: int, high: int) -> Any:
    """One line in the middle of a picture, (high, wide, 3) uint8."""
    sheet = _sheet(wide, high)
    sheet.text(0.5, 0.5, words, fontsize=size, weight="bold", color=trial_trace.MESSAGE, ha="center", va="center")
    return _pixels(sheet)


def _sheet(wide: int, high: int) -> Figure:
    return Figure(figsize=(wide / _DPI, high / _DPI), dpi=_DPI, facecolor="white")


def _pixels(sheet: Figure) -> Any:
    canvas = FigureCanvasAgg(sheet)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:, :, :3].copy()
