"""Writes words into frames of videos, in the font of all figures."""

from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from hthor.report.drawing import lettering, text_fit

DPI = 100
"""Pixels per inch of a frame."""
WORDS_PT = 10.0
"""Size of the letters, unless another is given [pt]."""
LINE_PX = 26
"""Distance between two lines of words [px]."""
_WIDER = 1.03
"""Letters of pixels take up to this many times the width that they measure as outlines."""
_HIGH_IN, _BELOW = 0.3, 0.3
"""Height of the strip in which a line of `WORDS_PT` is drawn [in], and the share of it below the baseline."""


def write_words(
    frame: Any, text: str, corner: tuple[int, int], shade: str, room: int | None = None, size: float = WORDS_PT
) -> int:
    """Write a line of words; return its width [px].

    Args:
        frame: (H, W, 3) uint8, blue first. corner: column and row where the baseline begins [px].
        room: width that the words may take [px], by default up to the frame's edge; longer words end in an ellipsis.
        size: of the letters [pt].
    """
    x, y = corner
    room = frame.shape[1] - x if room is None else room
    if room < LINE_PX:
        return 0
    inked, shift = _lettered(text, shade, room, size)
    top = y - inked.shape[0] + shift
    part = frame[max(0, top) : top + inked.shape[0], x : x + inked.shape[1]]
    cover = inked[max(0, -top) :][: part.shape[0], : part.shape[1]]
    alpha = cover[:, :, 3:].astype(np.float32) / 255.0
    part[:] = np.round(part * (1.0 - alpha) + cover[:, :, 2::-1] * alpha).astype(np.uint8)
    return int(inked.shape[1])


def bgr(shade: str) -> tuple[int, int, int]:
    """A colour by its name or code, blue first."""
    red, green, blue = (round(255 * part) for part in to_rgb(shade))
    return (blue, green, red)


@lru_cache(maxsize=256)
def lines(text: str, room: int) -> tuple[str, ...]:
    """Words in lines that are no wider than ``room`` [px]."""
    return tuple(text_fit.wrap(text, room / DPI / _WIDER, WORDS_PT, bold=True))


@lru_cache(maxsize=256)
def _lettered(text: str, shade: str, room: int, size: float) -> tuple[Any, int]:
    """Words, shortened to ``room`` [px], as RGBA pixels, and how far they reach below their baseline [px]."""
    text = text_fit.shorten(text, room / DPI / _WIDER, size, bold=True)
    high = _HIGH_IN * size / WORDS_PT
    with lettering.plain_lettering():
        sheet = Figure(figsize=(_width_in(text, size), high), dpi=DPI, facecolor="none")
        canvas = FigureCanvasAgg(sheet)
        sheet.text(0.0, _BELOW, text, fontsize=size, color=shade, weight="bold")
        canvas.draw()
        return np.asarray(canvas.buffer_rgba()).copy(), round(_BELOW * high * DPI)


def _width_in(text: str, size: float) -> float:
    return _WIDER * text_fit.text_width(text, size, bold=True) + 0.02
