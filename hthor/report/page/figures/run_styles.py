"""Tells runs apart in figures: each has a colour, and a mark for people who cannot see colours."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from matplotlib.lines import Line2D
from msgspec import Struct

from hthor.eval.statistics.intervals import Estimate
from hthor.report.analysis.document import Arm
from hthor.report.drawing import text_fit
from hthor.report.html import matplotlib_svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_OTHERS = ("#9a5fb5", "#2f9270", "#c4587f", "#7f7a2c", "#4a79c4")
_SHAPES = {"none": "o", "frontier": "s", "oracle": "^"}
_NAME_IN, _NAME_PT = 1.35, 8.0
"""Width of a name at most [in], and size of its letters [pt]."""
LINE_IN = 0.135
"""Height of a line of a name [in]."""
_MORE = ("v", "P", "X", "p", "h")


class RunStyle(Struct, frozen=True, kw_only=True):
    """A run's colour and mark."""

    shade: str
    shape: str


def run_styles(arms: Sequence[Arm], more: Iterable[str] = ()) -> dict[str, RunStyle]:
    """A style for each run by its label; the first run with each of the article's three conditions always has the same.

    Args:
        more: further labels, which may belong to no run.
    """
    found: dict[str, RunStyle] = {}
    taken: set[str] = set()
    conditions = {arm.label: arm.condition for arm in arms}
    for label in dict.fromkeys((*conditions, *more)):
        condition = conditions.get(label, "")
        if condition and condition not in taken:
            taken.add(condition)
            found[label] = RunStyle(shade=matplotlib_svg.CONDITION[condition], shape=_SHAPES[condition])
        else:
            number = len(found) - len(taken)
            found[label] = RunStyle(shade=_OTHERS[number % len(_OTHERS)], shape=_MORE[number % len(_MORE)])
    return found


def interval(
    ax: Axes, y: float, mean: float | None, ci95: Sequence[float] | None, mark: RunStyle, *, thin: bool = False
) -> None:
    """Draw a mean with a horizontal 95 % interval; its ends have ticks because the mark hides short intervals."""
    if mean is None:
        return
    if ci95 is not None:
        ax.plot(tuple(ci95), (y, y), color=mark.shade, lw=1.0 if thin else 1.6, solid_capstyle="butt", zorder=3)
        ax.plot(tuple(ci95), (y, y), "|", color=mark.shade, ms=3.6 if thin else 6.0, mew=0.9 if thin else 1.2, zorder=3)
    size = (4.4 if thin else 5.4) * (1.15 if mark.shape == "^" else 1.0)
    ax.plot(mean, y, mark.shape, color=mark.shade, ms=size, mec=matplotlib_svg.PAPER, mew=0.5, zorder=4)


def estimate(ax: Axes, y: float, one: Estimate, mark: RunStyle, scale: float = 100.0, *, thin: bool = False) -> None:
    """An estimate, as `interval` draws it."""
    if one.mean is not None:
        ends = None if one.ci95 is None else [scale * end for end in one.ci95]
        interval(ax, y, scale * one.mean, ends, mark, thin=thin)


def window(
    values: Iterable[float], step: float, most: tuple[float, float] = (-math.inf, math.inf)
) -> tuple[float, float]:
    """Limits of an axis that holds these values with a margin, at whole multiples of ``step``."""
    held = list(values) or [0.0]
    low = step * math.floor((min(held) - 0.15 * step) / step)
    high = step * math.ceil((max(held) + 0.15 * step) / step)
    return max(low, most[0]), min(max(high, low + step), most[1])


def draw_names(ax: Axes, ends: Sequence[tuple[float, float, str, RunStyle]], line: float) -> None:
    """Write names to the right of all curves, each as near to its curve's end as the other names allow.

    The y limits of the axes must be set already: no name leaves them.

    Args:
        ends: x, y, name and style of each curve. line: the height of a line of a name, in units of y.
    """
    if not ends:
        return
    right = max(x for x, _, _, _ in ends)  # a name that began at its own curve's end could be covered by other marks
    ordered = sorted(ends, key=lambda end: end[1])
    words = [axis_label(name) for _, _, name, _ in ordered]
    highs = [line * (text.count("\n") + 1) for text in words]
    places = _apart([y for _, y, _, _ in ordered], highs, ax.get_ylim())
    for (_, _, _, mark), text, y in zip(ordered, words, places, strict=True):
        look: dict[str, Any] = {"color": mark.shade, "fontsize": _NAME_PT, "va": "center"}
        ax.annotate(text, (right, y), (9, 0), textcoords="offset points", annotation_clip=False, **look)


def _apart(middles: Sequence[float], highs: Sequence[float], within: tuple[float, float]) -> list[float]:
    """Move the middles, lowest first, so that no names of these heights overlap or leave the limits, if there is room.

    Names that overlap move as little as possible, up or down: a group is centred on the mean of their wanted places.
    """
    groups: list[tuple[list[float], list[float]]] = []  # wanted middles, and heights
    for middle, high in zip(middles, highs, strict=True):
        groups.append(([middle], [high]))
        while len(groups) > 1 and _foot(groups[-1], within) < _foot(groups[-2], within) + sum(groups[-2][1]):
            wishes, tall = groups.pop()
            groups[-1][0].extend(wishes)
            groups[-1][1].extend(tall)
    found: list[float] = []
    for group in groups:
        foot = _foot(group, within)
        for high in group[1]:
            found.append(foot + high / 2.0)
            foot += high
    return found


def _foot(group: tuple[list[float], list[float]], within: tuple[float, float]) -> float:
    """The lower end of a group."""
    wishes, highs = group
    starts = [
        wish - high / 2.0 - sum(highs[:place]) for place, (wish, high) in enumerate(zip(wishes, highs, strict=True))
    ]
    foot = sum(starts) / len(starts)
    return max(within[0], min(foot, within[1] - sum(highs)))


def axis_label(name: str) -> str:
    """A long name, broken into lines that are short enough for an axis."""
    return text_fit.wrapped(name, _NAME_IN, _NAME_PT)


def row_height(names: Iterable[str], least: float = 0.36) -> float:
    """The height of a row whose name has a line for n below it [in]."""
    lines = 1 + max(axis_label(name).count("\n") + 1 for name in names)
    return max(least, LINE_IN * lines + 0.08)


def names_height(names: Iterable[str]) -> float:
    """The height of all names, one below another [in]."""
    return sum(LINE_IN * (axis_label(name).count("\n") + 1) for name in names)


def legend_handle(mark: RunStyle, label: str) -> Line2D:
    """An entry of a legend."""
    return Line2D(
        [], [], color=mark.shade, lw=1.4, marker=mark.shape, ms=5, mec=matplotlib_svg.PAPER, mew=0.5, label=label
    )


def trial_count(estimates: Sequence[Estimate]) -> str:
    """How many trials: "n = 60", or the range where runs differ."""
    counts = sorted({one.n for one in estimates})
    return f"n = {counts[0]}" if len(counts) == 1 else f"n = {counts[0]} to {counts[-1]}"
