"""Box plots of the time spent."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from hthor.eval.pages import ink
from hthor.eval.pages.figures import marks
from hthor.eval.pages.findings import Arm, Spent

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def figure(parts: Sequence[Spent], arms: Sequence[Arm]) -> Figure:
    """Minimum, quartiles and maximum; how many trials were not solved stands beside."""
    own = marks.of(arms)
    with ink.style():
        made = ink.sheet(0.6 + 0.36 * len(parts), 6.2)
        ax = made.subplots()
        for y, one in enumerate(parts):
            _box(ax, y, one, own[one.arm].shade)
        longest = max(one.most for one in parts)
        ax.set_yticks(range(len(parts)), [f"{one.arm}, n = {one.trials}" for one in parts])
        ax.set_ylim(len(parts) - 0.45, -0.55)
        ax.set_xlim(0.0, 1.02 * longest)
        ax.xaxis.set_major_locator(MaxNLocator(nbins=8, steps=[1, 1.5, 3, 5, 10]))
        ax.set_xlabel("time spent [s]; unsolved trials count with the limit")
        ink.bare(ax)
    return made


def _box(ax: Axes, y: int, one: Spent, shade: str) -> None:
    ax.plot((one.least, one.most), (y, y), color=shade, lw=1.0, zorder=2)
    ax.barh(
        y, one.upper - one.lower, left=one.lower, height=0.5, facecolor=ink.PAPER, edgecolor=shade, lw=1.3, zorder=3
    )
    ax.plot((one.median, one.median), (y - 0.25, y + 0.25), color=shade, lw=2.4, solid_capstyle="butt", zorder=4)
    ax.plot((one.least, one.most), (y, y), "|", color=shade, ms=8, mew=1.1, zorder=4)
    share = f"{100.0 * one.unsolved / one.trials:.0f} % unsolved"
    ax.annotate(
        share,
        (1.0, y),
        (6, 0),
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        va="center",
        fontsize=7,
        color=ink.SOFT,
        annotation_clip=False,
    )
