"""Runs against each other over the trials that they share."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from hthor.eval.comparison.compare import Comparison
from hthor.eval.metrics import registry
from hthor.eval.results import result_file
from hthor.report.analysis.document import Arm
from hthor.report.html import matplotlib_svg
from hthor.report.page.figures import run_styles


def figure(pairs: Sequence[Comparison], arms: Sequence[Arm]) -> Figure:
    """Paired differences with their intervals, those of success as the verdicts have them.

    Right of the line the robot that is named first is better.
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
