"""Small drawings in a table's cells: a mean and its interval on a scale that a column shares."""

import math
from collections.abc import Iterable

from msgspec import Struct

from hthor.eval.statistics.intervals import Estimate
from hthor.report.html.markup import NOTHING, Markup, Piece, tag

_WIDE, _HIGH, _EDGE = 150.0, 16.0, 6.0


class Scale(Struct, frozen=True, kw_only=True):
    """From where to where a column's marks go, in percent."""

    low: int
    high: int

    def at(self, share: float) -> float:
        """Where a share lies [px]."""
        part = (100.0 * share - self.low) / (self.high - self.low)
        return round(_EDGE + (_WIDE - 2 * _EDGE) * min(max(part, 0.0), 1.0), 1)


def common_scale(some: Iterable[Estimate]) -> Scale:
    """The tens around all intervals."""
    ends = [end for one in some for end in (one.ci95 or ())] or [0.0, 1.0]
    low, high = 10 * math.floor(10 * min(ends)), 10 * math.ceil(10 * max(ends))
    return Scale(low=max(0, low), high=min(100, max(high, low + 10)))


def draw_axis(on: Scale) -> Markup:
    """The head of a column of marks: its ends in numbers."""
    look: dict[str, str | int] = {"y": 11, "font_size": 10, "fill": "var(--soft)"}
    ends = (
        tag("text", str(on.low), x=on.at(on.low / 100.0) - 4, **look),
        tag("text", str(on.high), x=on.at(on.high / 100.0) + 4, text_anchor="end", **look),
    )
    return _drawing("scale", *ends)


def draw_interval(one: Estimate, on: Scale, colour: str) -> Markup:
    """A dot for the mean, a line for the interval, thin lines at each tenth."""
    if one.mean is None:
        return NOTHING
    low, high = one.ci95 or (one.mean, one.mean)
    step = 10 if on.high - on.low <= 60 else 20
    grid = (
        tag("line", x1=on.at(tenth / 100), x2=on.at(tenth / 100), y1=0, y2=_HIGH, stroke="var(--line)")
        for tenth in range(on.low, on.high + 1, step)
    )
    middle, ink = _HIGH / 2, f"var(--{colour})"
    bar = tag("line", x1=on.at(low), x2=on.at(high), y1=middle, y2=middle, stroke_width="2.5")
    dot = tag("circle", cx=on.at(one.mean), cy=middle, r="3.6")
    words = f"{100 * one.mean:.1f} %, 95 % interval {100 * low:.1f} to {100 * high:.1f}"
    return _drawing(words, *grid, tag("g", bar, dot, stroke=ink, fill=ink, stroke_linecap="round"))


def _drawing(words: str, *parts: Piece) -> Markup:
    box = f"0 0 {_WIDE:g} {_HIGH:g}"
    return tag("svg", tag("title", words), *parts, role="img", width=_WIDE, height=_HIGH, viewBox=box)
