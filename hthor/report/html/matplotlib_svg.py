"""The look of the report's figures, and their conversion to parts of a page.

Colours in a figure are the page's CSS variables, so that it is readable on a light and on a dark background. People
who are colour-blind to red or green can tell the colours apart.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from typing import TYPE_CHECKING, Literal

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from hthor.report.drawing import lettering

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK, SOFT, LINE, PAPER, SHADE = "#1c2024", "#5c646d", "#d5d9de", "#fefefe", "#eceff2"
PUBLISHED, PRIOR = "#b8401c", "#9aa2ab"
NONE, FRONTIER, ORACLE = "#6c757f", "#b8790a", "#0b6aa8"
CONDITION = {"none": NONE, "frontier": FRONTIER, "oracle": ORACLE}
VARIABLES = {
    INK: "ink",
    SOFT: "soft",
    LINE: "line",
    PAPER: "paper",
    SHADE: "shade",
    PUBLISHED: "published",
    PRIOR: "prior",
    NONE: "none",
    FRONTIER: "frontier",
    ORACLE: "oracle",
}
"""Names of the page's colours by their values on a light background."""
DARK = {
    INK: "#e8eaed",
    SOFT: "#a3abb4",
    LINE: "#3a4047",
    PAPER: "#15181b",
    SHADE: "#22272c",
    PUBLISHED: "#ff8f66",
    PRIOR: "#737b84",
    NONE: "#aab3bc",
    FRONTIER: "#e9b44c",
    ORACLE: "#5fb3ea",
}
"""The same for a dark background."""
WIDE = 7.2
"""Width of a figure [in]."""

_PX = 1.45
"""Pixels per point of a figure, on a screen that is wide enough."""

_STYLE = {
    **lettering.SETTINGS,
    "svg.hashsalt": "hthor",
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 8.0,
    "axes.edgecolor": SOFT,
    "axes.labelcolor": INK,
    "axes.titlesize": 8.5,
    "axes.titlecolor": INK,
    "axes.titlelocation": "left",
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "text.color": INK,
    "xtick.color": SOFT,
    "ytick.color": SOFT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "grid.color": LINE,
    "grid.linewidth": 0.5,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "lines.solid_capstyle": "round",
}
_ELEMENT_HEAD = re.compile(r'<svg role="img" viewBox="0 0 ([\d.]+) ([\d.]+)" style="[^"]*">')
_FONT = "Helvetica, Arial, &quot;DejaVu Sans&quot;, sans-serif"


@contextmanager
def style() -> Iterator[None]:
    """Draw in the report's style."""
    with lettering.plain_lettering(), mpl.rc_context(_STYLE):
        yield


def new_figure(height: float, width: float = WIDE) -> Figure:
    """An empty figure of this size [in], to be drawn on within `style`."""
    engine = ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.06, wspace=0.07, hspace=0.04)
    return Figure(figsize=(width, height), layout=engine, facecolor="none")


def quiet_axes(ax: Axes, *, grid: Literal["both", "x", "y"] = "x") -> None:
    """Quiet axes: no box, a thin grid along one axis."""
    ax.set_facecolor("none")
    ax.grid(True, axis=grid)
    ax.tick_params(length=0)
    for side in ax.spines.values():
        side.set_visible(False)


def to_svg(made: Figure, name: str, words: str) -> str:
    """The figure as an SVG element of a page; the same drawing gives the same bytes.

    Args:
        name: of the figure, unique on the page.
        words: a description for people who cannot see the figure.
    """
    out = io.StringIO()
    with style():
        made.savefig(out, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    text = out.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r'( id="|href="#|url\(#)', rf"\g<1>{name}-", text)
    text = text.replace("xlink:href", "href")
    text = _short(text)
    for colour, variable in VARIABLES.items():
        text = re.sub(colour, f"var(--{variable})", text, flags=re.IGNORECASE)
    text = re.sub(r"font-family: [^;\"]*;? ?", "", text)
    head = re.match(r"<svg [^>]*>", text)
    assert head is not None
    width, height = (float(value) for value in re.findall(r'(?:width|height)="([\d.]+)pt"', head.group(0)))
    opening = (
        f'<svg role="img" viewBox="0 0 {width:g} {height:g}" style="max-width:{width * _PX:.0f}px">'
        f"<title>{escape(words)}</title>"
    )
    lines = (line.strip() for line in (opening + text[head.end() :]).splitlines())
    return "\n".join(line for line in lines if line)


def _short(text: str) -> str:
    """The same drawing in fewer bytes: numbers are cut to two decimals, and unused names are removed."""
    text = re.sub(r"(\d+\.\d{2})\d+", r"\1", text)
    used = set(re.findall(r'(?:href="#|url\(#)([^")]+)', text))
    return re.sub(r' id="([^"]+)"', lambda found: found.group(0) if found.group(1) in used else "", text)


def svg_document(element: str) -> str:
    """The text of an SVG file.

    Args:
        element: as `to_svg` returns it.
    """
    found = _ELEMENT_HEAD.match(element)
    assert found is not None
    wide, high = found.groups()
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" width="{wide}pt" height="{high}pt" '
        f'viewBox="0 0 {wide} {high}" font-family="{_FONT}">'
    )
    body = element[found.end() :]
    for colour, variable in VARIABLES.items():
        body = body.replace(f"var(--{variable})", colour)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{head}{body}\n'
