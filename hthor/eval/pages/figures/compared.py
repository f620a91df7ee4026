"""Runs against each other over the trials that they share."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from hthor.eval.compare import Comparison
from hthor.eval.pages import ink
from hthor.eval.pages.figures import marks
from hthor.eval.pages.findings import Arm

_PANELS = (
    ("sr", "success [points]", 100.0),
    ("twsr", "time-weighted [points]", 100.0),
    ("time_s", "time saved [s]", -1.0),
)


def figure(pairs: Sequence[Comparison], arms: Sequence[Arm]) -> Figure:
    """Paired differences with their intervals, those of success as the verdicts have them.

    Right of the line the robot that is named first is better.
    """
    own, rows = marks.of(arms), len(pairs)
    names = [f"{pair.second} − {pair.first}" for pair in pairs]
    with ink.style():
        made = ink.sheet(0.62 + rows * marks.high(names, 0.34))
        panels = made.subplots(1, len(_PANELS), sharey=True)
        for ax, (name, title, scale) in zip(panels, _PANELS, strict=True):
            ink.bare(ax)
            ax.set_title(title)
            ax.axvline(0.0, color=ink.SOFT, lw=0.9)
            for y, pair in enumerate(pairs):
                one = pair.success if name == "sr" else pair.differences[name]
                ends = None if one.ci95 is None else sorted(scale * end for end in one.ci95)
                marks.interval(ax, y, scale * one.difference, ends, own[pair.second])
            ax.margins(x=0.08)
        labels = [f"{marks.label(name)}\nn = {pair.n}" for name, pair in zip(names, pairs, strict=True)]
        panels[0].set_yticks(range(rows), labels)
        panels[0].set_ylim(rows - 0.45, -0.55)
    return made
