"""What became of the robots' messages, and how good a channel they were."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure
from matplotlib.patches import Patch

from hthor.eval import text_fit, trace
from hthor.eval.pages import ink
from hthor.eval.pages.figures import marks
from hthor.eval.pages.findings import Arm

FATES = {
    "accepted": ("confirmed", trace.MESSAGE),
    "declined": ("declined", trace.IDLE_MESSAGE),
    "covered": ("covered by a newer one", ink.PRIOR),
    "unanswered": ("unanswered", ink.LINE),
}
_PANELS = (("first_useful_s", "first useful message [s]"), ("interruptions_per_min", "interruptions a minute"))


def figure(arms: Sequence[Arm]) -> Figure:
    """Messages a trial by their fate, and means with 95 % intervals of what they cost and brought.

    Args:
        arms: those with robots.
    """
    own, rows = marks.of(arms), len(arms)
    with ink.style():
        made = ink.sheet(1.0 + rows * marks.high(arm.label for arm in arms))
        bars, *others = made.subplots(1, 1 + len(_PANELS), sharey=True, width_ratios=(1.5, 1.0, 1.0))
        for y, arm in enumerate(arms):
            left = 0.0
            for name, (_, shade) in FATES.items():
                share = getattr(arm.scores, name).mean or 0.0
                bars.barh(y, share, left=left, height=0.46, facecolor=shade, edgecolor=ink.PAPER, lw=0.6)
                left += share
        bars.set_title("messages a trial")
        bars.set_xlim(left=0.0)
        for ax, (metric, title) in zip(others, _PANELS, strict=True):
            ax.set_title(title)
            for y, arm in enumerate(arms):
                one = getattr(arm.scores, metric)
                marks.estimate(ax, y, one, own[arm.label], 1.0)
            held = [getattr(arm.scores, metric) for arm in arms]
            most = max((end for one in held for end in (one.mean, *(one.ci95 or ())) if end), default=1.0)
            ax.set_xlim(0.0, 1.06 * most)
        for ax in (bars, *others):
            ink.bare(ax)
        bars.set_yticks(range(rows), [f"{marks.label(arm.label)}\nn = {arm.trials}" for arm in arms])
        bars.set_ylim(rows - 0.45, -0.55)
        handles = [Patch(facecolor=shade, edgecolor="none", label=word) for word, shade in FATES.values()]
        text_fit.legend(made, handles, len(FATES), loc="outside lower left", handlelength=1.0, handleheight=0.9)
    return made
