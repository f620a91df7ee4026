"""Draws every run's scores next to the published ones, and differences between runs over the trials that they share."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from hthor.eval.comparison.comparison import Comparison
from hthor.eval.metrics import registry
from hthor.eval.results import result_file
from hthor.report.analysis.document import Arm, Findings
from hthor.report.drawing import text_fit
from hthor.report.html import matplotlib_svg
from hthor.report.page.figures import run_styles

if TYPE_CHECKING:
    from matplotlib.axes import Axes

METRICS = tuple(metric for metric in registry.MAIN if metric.is_share)
"""The metrics that have a panel."""
_SHIFT = 0.17
_MANY = 4
"""From this number of panels on, their titles are short."""
_QUIET = {"ha": "center", "va": "center", "color": matplotlib_svg.SOFT, "fontsize": 7}


def scores_figure(found: Findings) -> Figure:
    """Means with 95 % intervals; diamonds are the article's values, with intervals where it gives counts."""
    own, rows = run_styles.run_styles(found.arms), len(found.arms)
    held = [metric for metric in METRICS if any(arm.scores[metric.name].n for arm in found.arms)]
    study = found.published is not None and any(arm.condition for arm in found.arms)
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(0.95 + rows * run_styles.row_height(arm.label for arm in found.arms))
        panels = made.subplots(1, len(held), sharey=True, squeeze=False)[0]
        for ax, metric in zip(panels, held, strict=True):
            matplotlib_svg.quiet_axes(ax)
            ax.set_title(f"{metric.title if len(held) < _MANY else metric.brief} [%]")
            ax.set_xlim(run_styles.window(_ends(found, metric.name), 10.0, (0.0, 100.0)))
            for y, arm in enumerate(found.arms):
                one = arm.scores[metric.name]
                run_styles.estimate(ax, y - _SHIFT if study else y, one, own[arm.label])
                if one.mean is None:
                    ax.text(0.5, y, "no robot" if not one.n else "", transform=ax.get_yaxis_transform(), **_QUIET)
                _publish(ax, y + _SHIFT, f"{metric.name} {arm.condition}", found)
        panels[0].set_yticks(
            range(rows), [f"{run_styles.axis_label(arm.label)}\nn = {arm.trials}" for arm in found.arms]
        )
        panels[0].set_ylim(rows - 0.45, -0.55)
        if study and found.published is not None:
            word = f"published ({found.published.name}), 95 % from its counts where it has any"
            mine = Line2D([], [], color=matplotlib_svg.SOFT, lw=1.6, marker="o", ms=5, mec=matplotlib_svg.PAPER)
            theirs = Line2D([], [], color=matplotlib_svg.PUBLISHED, lw=0.9, marker="D", mfc="none", ms=4.6, label=word)
            mine.set_label("mean and 95 %")
            text_fit.legend(made, [mine, theirs], 2, loc="outside lower right")
    return made


def _ends(found: Findings, metric: str) -> Iterator[float]:
    """Every number of a panel, in per cent."""
    for arm in found.arms:
        one, name = arm.scores[metric], f"{metric} {arm.condition}"
        yield from (100.0 * value for value in (one.mean, *(one.ci95 or ())) if value is not None)
        if found.published is not None and name in found.published.figures:
            yield 100.0 * found.published.figures[name]
            yield from (
                100.0 * end for end in (found.published.counts[name].ci95 if name in found.published.counts else ())
            )


def _publish(ax: Axes, y: float, name: str, found: Findings) -> None:
    published = found.published
    if published is None or name not in published.figures:
        return
    if name in published.counts:
        ends = [100.0 * end for end in published.counts[name].ci95]
        ax.plot(ends, (y, y), color=matplotlib_svg.PUBLISHED, lw=0.9, zorder=2)
    value = 100.0 * published.figures[name]
    ax.plot(value, y, "D", mfc="none", mec=matplotlib_svg.PUBLISHED, mew=1.1, ms=4.6, zorder=5)


def comparison_figure(pairs: Sequence[Comparison], arms: Sequence[Arm]) -> Figure:
    """Paired differences with their intervals; the intervals of success are those of the verdicts.

    To the right of the line, the robot that is named first is better.
    """
    own, rows = run_styles.run_styles(arms), len(pairs)
    names = [f"{pair.second} − {pair.first}" for pair in pairs]
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(0.62 + rows * run_styles.row_height(names, 0.34))
        panels = made.subplots(1, len(result_file.UPLIFT_METRICS), sharey=True)
        for ax, metric in zip(panels, map(registry.get, result_file.UPLIFT_METRICS), strict=True):
            scale = metric.sign * metric.unit.scale
            matplotlib_svg.quiet_axes(ax)
            ax.set_title(metric.gain)
            ax.axvline(0.0, color=matplotlib_svg.SOFT, lw=0.9)
            for y, pair in enumerate(pairs):
                one = pair.success if metric.name == "sr" else pair.differences[metric.name]
                ends = None if one.ci95 is None else sorted(scale * end for end in one.ci95)
                run_styles.interval(ax, y, scale * one.difference, ends, own[pair.second])
            ax.margins(x=0.08)
        labels = [f"{run_styles.axis_label(name)}\nn = {pair.n}" for name, pair in zip(names, pairs, strict=True)]
        panels[0].set_yticks(range(rows), labels)
        panels[0].set_ylim(rows - 0.45, -0.55)
    return made
