"""Success, time-weighted success, adoption and progress of every run beside the published ones."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from hthor.eval.metrics import registry
from hthor.report.analysis.document import Findings
from hthor.report.drawing import text_fit
from hthor.report.html import matplotlib_svg
from hthor.report.page.figures import run_styles

if TYPE_CHECKING:
    from matplotlib.axes import Axes

METRICS = tuple(metric for metric in registry.MAIN if metric.is_share)
"""The metrics that have a panel."""
_SHIFT = 0.17
_MANY = 4
"""So many panels have short titles."""


def figure(found: Findings) -> Figure:
    """Means with 95 % intervals; diamonds are the article's, with intervals of their own where it tells counts."""
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
            handles = [
                Line2D(
                    [],
                    [],
                    color=matplotlib_svg.SOFT,
                    lw=1.6,
                    marker="o",
                    ms=5,
                    mec=matplotlib_svg.PAPER,
                    label="mean and 95 %",
                )
            ]
            handles.append(
                Line2D([], [], color=matplotlib_svg.PUBLISHED, lw=0.9, marker="D", mfc="none", ms=4.6, label=word)
            )
            text_fit.legend(made, handles, 2, loc="outside lower right")
    return made


_QUIET = {"ha": "center", "va": "center", "color": matplotlib_svg.SOFT, "fontsize": 7}


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
        ax.plot(
            [100.0 * end for end in published.counts[name].ci95],
            (y, y),
            color=matplotlib_svg.PUBLISHED,
            lw=0.9,
            zorder=2,
        )
    ax.plot(
        100.0 * published.figures[name], y, "D", mfc="none", mec=matplotlib_svg.PUBLISHED, mew=1.1, ms=4.6, zorder=5
    )
