"""What became of the robots' messages, and how good a channel they were."""

from collections.abc import Sequence

from matplotlib.figure import Figure
from matplotlib.patches import Patch

from hthor.eval.metrics import registry
from hthor.report.analysis.document import Arm
from hthor.report.drawing import text_fit, trial_trace
from hthor.report.html import matplotlib_svg
from hthor.report.page.figures import run_styles

FATES = {
    "accepted": ("confirmed", trial_trace.MESSAGE),
    "declined": ("declined", trial_trace.IDLE_MESSAGE),
    "covered": ("covered by a newer one", matplotlib_svg.PRIOR),
    "unanswered": ("unanswered", matplotlib_svg.LINE),
}
_PANELS = ("first_useful_s", "interruptions_per_min")


def figure(arms: Sequence[Arm]) -> Figure:
    """Messages a trial by their fate, and means with 95 % intervals of what they cost and brought.

    Args:
        arms: those with robots.
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
