"""Fits words into pictures: measures, wraps and shortens them in the font of all figures; draws legends.

Users choose names, which may be long. Widths are measured because an "i" and a "W" differ by a factor of four.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextToPath

from hthor.report.drawing import lettering

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure
    from matplotlib.legend import Legend

_PIECES = re.compile(r"[^\s_+/.:-]+[\s_+/.:-]*|[\s_+/.:-]+")
"""The pieces of a text: a line may end after a space and after a mark that joins words."""
_FONT, _POINTS_AN_INCH = "DejaVu Sans", 72.0
_ENTRY_IN, _EDGE_IN = 3.6, 0.1
"""Width of the words of a legend entry at most [in], and free space at the sides of a legend [in]."""
_MORE = " …"


def text_width(words: str, size: float, *, bold: bool = False) -> float:
    """The width of a line of words [in].

    Args:
        size: of the letters [pt].
    """
    font = FontProperties(family=_FONT, size=size, weight="bold" if bold else "normal")
    with lettering.plain_lettering():
        points, _, _ = TextToPath().get_text_width_height_descent(words, font, ismath=False)
    return float(points) / _POINTS_AN_INCH


def wrap(words: str, inches: float, size: float, *, bold: bool = False) -> list[str]:
    """The words in lines no wider than ``inches``, broken between words if possible."""
    found = [""]
    for piece in _PIECES.findall(words):
        if found[-1] and text_width((found[-1] + piece).rstrip(), size, bold=bold) > inches:
            found.append("")
        found[-1] += piece
        while len(found[-1]) > 1 and text_width(found[-1].rstrip(), size, bold=bold) > inches:
            fits = _fitting(found[-1], inches, size, bold=bold)
            found[-1:] = [found[-1][:fits], found[-1][fits:]]
    return [line.rstrip() for line in found]


def wrapped(words: str, inches: float, size: float, *, bold: bool = False) -> str:
    """The lines of `wrap` as one text."""
    return "\n".join(wrap(words, inches, size, bold=bold))


def shorten(words: str, inches: float, size: float, *, bold: bool = False) -> str:
    """One line no wider than ``inches``; an ellipsis stands for the words that do not fit."""
    line = " ".join(words.split())
    if text_width(line, size, bold=bold) <= inches:
        return line
    room = inches - text_width(_MORE, size, bold=bold)
    return line[: _fitting(line, room, size, bold=bold)].rstrip() + _MORE


def _fitting(words: str, inches: float, size: float, *, bold: bool) -> int:
    """How many letters fit, at least one."""
    low, high = 1, len(words)
    while low < high:
        middle = (low + high + 1) // 2
        low, high = (middle, high) if text_width(words[:middle], size, bold=bold) <= inches else (low, middle - 1)
    return low


def legend(made: Figure, handles: Sequence[Artist], columns: int, *, size: float = 7.5, **look: Any) -> Legend:
    """Draw a figure's legend, with as many columns as fit.

    Args:
        columns: how many at most. size: of the letters [pt]. look: other options of matplotlib's legend.
    """
    for handle in handles:
        handle.set_label(wrapped(str(handle.get_label()), _ENTRY_IN, size))
    room = (made.get_figwidth() - 2 * _EDGE_IN) * made.dpi
    count = max(1, min(columns, len(handles)))
    while True:
        drawn = made.legend(handles=list(handles), ncols=count, fontsize=size, frameon=False, **look)
        if count == 1 or drawn.get_window_extent(made._get_renderer()).width <= room:  # type: ignore[attr-defined]
            return drawn
        drawn.remove()
        count -= 1
