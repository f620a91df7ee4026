"""The time spent: box plots, and how many trials were done by when."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from hthor.report.analysis.document import Arm, TimeSpent
from hthor.report.html import matplotlib_svg
from hthor.report.page.figures import run_styles

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from hthor.report.page.figures.run_styles import RunStyle

_EDGES_IN = 0.8
"""Inches of title and labels."""
_MANY = 6
"""So many curves are named at their ends; boxes have the names of more."""


def figure(parts: Sequence[TimeSpent], arms: Sequence[Arm]) -> Figure:
    """On the left minimum, quartiles and maximum; on the right the share of trials that was solved by each second."""
    own = run_styles.run_styles(arms)
    longest = max(max(one.most for one in parts), len(parts[0].solved) - 1.0)
    with matplotlib_svg.style():
        rows = len(parts) * run_styles.row_height((one.arm for one in parts), 0.38)
        high_in = max(2.3, 0.75 + rows)
        made = matplotlib_svg.new_figure(high_in)
        boxes, curves = made.subplots(1, 2, width_ratios=(1.15, 1.0))
        for y, one in enumerate(parts):
            _box(boxes, y, one, own[one.arm])
            curves.plot(
                range(len(one.solved)), [100.0 * share for share in one.solved], color=own[one.arm].shade, lw=1.5
            )
        boxes.set_yticks(range(len(parts)), [f"{run_styles.axis_label(one.arm)}\nn = {one.trials}" for one in parts])
        boxes.set_ylim(len(parts) - 0.4, -0.6)
        boxes.set_title("time spent [s]")
        curves.set_title("trials solved by then [%]")
        ends = [(len(one.solved) - 1.0, 100.0 * one.solved[-1], one.arm, own[one.arm]) for one in parts]
        curves.set_ylim(0.0, 100.0)
        run_styles.draw_names(
            curves, ends if len(ends) <= _MANY else [], 100.0 * run_styles.LINE_IN / (high_in - _EDGES_IN)
        )
        for ax, grid in ((boxes, "x"), (curves, "both")):
            ax.set_xlim(0.0, 1.01 * longest)
            ax.xaxis.set_major_locator(MaxNLocator(nbins=7, steps=[1, 1.5, 3, 5, 10]))
            ax.set_xlabel("time since the start [s]" if ax is curves else "an unsolved trial counts with its limit")
            matplotlib_svg.quiet_axes(ax, grid="x" if grid == "x" else "both")
    return made


def _box(ax: Axes, y: int, one: TimeSpent, mark: RunStyle) -> None:
    shade, wide = mark.shade, one.upper - one.lower
    ax.plot((one.least, one.most), (y, y), color=shade, lw=1.0, zorder=2)
    ax.plot((one.least, one.most), (y, y), "|", color=shade, ms=8, mew=1.1, zorder=2)
    ax.barh(y, wide, left=one.lower, height=0.5, facecolor=matplotlib_svg.PAPER, edgecolor="none", zorder=2.5)
    ax.barh(y, wide, left=one.lower, height=0.5, facecolor=shade, edgecolor="none", alpha=0.18, zorder=3)
    ax.barh(y, wide, left=one.lower, height=0.5, facecolor="none", edgecolor=shade, lw=1.2, zorder=3.5)
    ax.plot((one.median, one.median), (y - 0.25, y + 0.25), color=shade, lw=2.4, solid_capstyle="butt", zorder=4)
