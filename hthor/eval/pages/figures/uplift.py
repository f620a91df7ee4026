"""What each robot changes against no robot, over the same people at the same tasks."""

from __future__ import annotations

from matplotlib.figure import Figure

from hthor.eval.pages import ink
from hthor.eval.pages.figures import marks
from hthor.eval.pages.findings import Findings

_PANELS = (
    ("sr", "success [points]", 100.0),
    ("twsr", "time-weighted success [points]", 100.0),
    ("saved_s", "time saved [s]", 1.0),
)


def figure(found: Findings) -> Figure:
    """Paired differences with 95 % intervals; right of the line is better than no robot."""
    own, rows = marks.of(found.arms), len(found.uplift)
    with ink.style():
        made = ink.sheet(0.65 + 0.3 * rows)
        panels = made.subplots(1, 3, sharey=True)
        for ax, (name, title, scale) in zip(panels, _PANELS, strict=True):
            ink.bare(ax)
            ax.set_title(title)
            ax.axvline(0.0, color=ink.SOFT, lw=0.8)
            for y, one in enumerate(found.uplift):
                marks.interval(ax, y, getattr(one, name), own[one.arm], scale)
        panels[0].set_yticks(range(rows), [f"{one.arm}, {one.pairs} pairs" for one in found.uplift])
        panels[0].set_ylim(rows - 0.5, -0.5)
    return made
