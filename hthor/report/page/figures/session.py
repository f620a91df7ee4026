"""Draws a session's course: the time spent, trust by trial, and the outcomes of the robots' messages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from hthor import rules
from hthor.eval.metrics import registry
from hthor.report.analysis.document import Arm, TimeSpent, TrustCurve
from hthor.report.drawing import text_fit, trial_trace
from hthor.report.html import matplotlib_svg
from hthor.report.page.figures import run_styles

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from hthor.report.page.figures.run_styles import RunStyle

_EDGES_IN = 0.8
"""Height of the title and labels of the figure of times [in]."""
_MANY = 6
"""Up to this many curves have their names at their ends; if there are more, only the boxes have names."""
_SIDE = 0.06
_HIGH_IN, _TRUST_EDGES_IN = 2.7, 0.75
"""Height of the figure of trust, and of its title and labels [in]."""
FATES = {
    "accepted": ("accepted", trial_trace.MESSAGE),
    "declined": ("declined", trial_trace.IDLE_MESSAGE),
    "covered": ("covered by a newer one", matplotlib_svg.PRIOR),
    "unanswered": ("unanswered", matplotlib_svg.LINE),
}
_PANELS = ("first_useful_s", "interruptions_per_min")


def time_figure(parts: Sequence[TimeSpent], arms: Sequence[Arm]) -> Figure:
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


def trust_figure(curves: Sequence[TrustCurve], arms: Sequence[Arm]) -> Figure:
    """Means with bars and bands of their 95 % intervals."""
    own, ends = run_styles.run_styles(arms), []
    low, high = trust_window(curves)
    high_in = max(_HIGH_IN, _TRUST_EDGES_IN + run_styles.names_height(curve.arm for curve in curves))
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(high_in)
        ax = made.subplots()
        for number, curve in enumerate(curves):
            mark = own[curve.arm]
            x = [trial + _SIDE * (2 * number - len(curves) + 1) for trial in curve.trial]
            lower, upper = ([pair[end] for pair in curve.ci95] for end in (0, 1))
            ax.fill_between(x, lower, upper, color=mark.shade, alpha=0.13, lw=0, zorder=2)
            ax.plot(x, curve.mean, color=mark.shade, lw=1.4, zorder=3)
            ax.vlines(x, lower, upper, color=mark.shade, lw=1.0, zorder=3)
            ax.plot(x, curve.mean, mark.shape, color=mark.shade, ms=5.4, mec=matplotlib_svg.PAPER, mew=0.6, zorder=4)
            ends.append((x[-1], curve.mean[-1], curve.arm, mark))
        ax.set_xticks(sorted({trial for curve in curves for trial in curve.trial}))
        ax.set_yticks(range(round(low), round(high) + 1))
        ax.set_ylim(low, high)
        run_styles.draw_names(ax, ends, run_styles.LINE_IN / (high_in - _TRUST_EDGES_IN) * (high - low))
        ax.set_xlabel("trial of the session")
        ax.set_title(f"trust, {rules.TRUST_MIN} to {rules.TRUST_MAX}")
        matplotlib_svg.quiet_axes(ax, grid="y")
    return made


def trust_window(curves: Sequence[TrustCurve]) -> tuple[float, float]:
    """The part of the trust scale that is drawn, between whole points."""
    values = [end for curve in curves for pair in curve.ci95 for end in pair]
    low, high = run_styles.window(values, 1.0, (float(rules.TRUST_MIN), float(rules.TRUST_MAX)))
    if high - low < 2.0:
        low, high = (low - 1.0, high) if low - 1.0 >= rules.TRUST_MIN else (low, high + 1.0)
    return low, high


def communication_figure(arms: Sequence[Arm]) -> Figure:
    """Messages per trial by their outcome, and means with 95 % intervals of their costs and benefits.

    Args:
        arms: runs with robots.
    """
    own, rows = run_styles.run_styles(arms), len(arms)
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(1.0 + rows * run_styles.row_height(arm.label for arm in arms))
        bars, *others = made.subplots(1, 1 + len(_PANELS), sharey=True, width_ratios=(1.5, 1.0, 1.0))
        for y, arm in enumerate(arms):
            left = 0.0
            for name, (_, shade) in FATES.items():
                share = arm.scores[name].mean or 0.0
                bars.barh(y, share, left=left, height=0.46, facecolor=shade, edgecolor=matplotlib_svg.PAPER, lw=0.6)
                left += share
        bars.set_title("messages a trial")
        bars.set_xlim(left=0.0)
        for ax, metric in zip(others, map(registry.get, _PANELS), strict=True):
            ax.set_title(f"{metric.brief} [{metric.unit.name}]" if metric.unit.name else metric.brief)
            for y, arm in enumerate(arms):
                one = arm.scores[metric.name]
                run_styles.estimate(ax, y, one, own[arm.label], 1.0)
            held = [arm.scores[metric.name] for arm in arms]
            most = max((end for one in held for end in (one.mean, *(one.ci95 or ())) if end), default=1.0)
            ax.set_xlim(0.0, 1.06 * most)
        for ax in (bars, *others):
            matplotlib_svg.quiet_axes(ax)
        bars.set_yticks(range(rows), [f"{run_styles.axis_label(arm.label)}\nn = {arm.trials}" for arm in arms])
        bars.set_ylim(rows - 0.45, -0.55)
        handles = [Patch(facecolor=shade, edgecolor="none", label=word) for word, shade in FATES.values()]
        text_fit.legend(made, handles, len(FATES), loc="outside lower left", handlelength=1.0, handleheight=0.9)
    return made
