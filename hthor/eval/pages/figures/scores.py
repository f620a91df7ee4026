"""Success, time-weighted success and adoption of every run beside the published ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from hthor.eval.pages import ink
from hthor.eval.pages.figures import marks
from hthor.eval.pages.findings import Findings

if TYPE_CHECKING:
    from matplotlib.axes import Axes

METRICS = {"sr": "success rate", "twsr": "time-weighted success", "adoption": "adoption"}


def figure(found: Findings) -> Figure:
    """Means with 95 % intervals; diamonds are the paper's, with intervals of their own where it tells counts."""
    own, rows = marks.of(found.arms), len(found.arms)
    with ink.style():
        made = ink.sheet(0.85 + 0.34 * rows)
        panels = made.subplots(1, 3, sharey=True)
        for ax, (metric, title) in zip(panels, METRICS.items(), strict=True):
            ink.bare(ax)
            ax.set_title(f"{title} [%]")
            ax.set_xlim(0, 100)
            ax.set_xticks(range(0, 101, 20), ["", "20", "40", "60", "80", ""])
            for y, arm in enumerate(found.arms):
                one = getattr(arm.scores, metric)
                marks.interval(ax, y - 0.12, one, own[arm.label])
                if one.mean is None:
                    ax.text(50, y, "nothing to adopt", ha="center", va="center", color=ink.SOFT, fontsize=7)
                if found.published is not None:
                    _publish(ax, y + 0.2, f"{metric} {arm.condition}", found)
        panels[0].set_yticks(range(rows), [f"{arm.label}, n = {arm.trials}" for arm in found.arms])
        panels[0].set_ylim(rows - 0.4, -0.6)
        handles = [Line2D([], [], color=ink.SOFT, lw=2.2, marker="o", ms=5, mec=ink.PAPER, label="mean and 95 %")]
        if found.published is not None and any(arm.condition for arm in found.arms):
            word = f"published ({found.published.name}), 95 % from its counts"
            handles.append(Line2D([], [], color=ink.PUBLISHED, lw=0.8, marker="D", mfc="none", ms=4.6, label=word))
        made.legend(handles=handles, loc="outside lower center", ncols=2)
    return made


def _publish(ax: Axes, y: float, name: str, found: Findings) -> None:
    published = found.published
    assert published is not None
    if name not in published.figures:
        return
    if name in published.counts:
        ax.plot([100.0 * end for end in published.counts[name].ci95], (y, y), color=ink.PUBLISHED, lw=0.8, zorder=2)
    ax.plot(100.0 * published.figures[name], y, "D", mfc="none", mec=ink.PUBLISHED, mew=1.1, ms=4.6, zorder=5)
