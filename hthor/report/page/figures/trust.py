"""Trust by trial of the session."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from hthor import rules
from hthor.report.analysis.document import Arm, TrustCurve
from hthor.report.html import matplotlib_svg
from hthor.report.page.figures import run_styles

_SIDE = 0.06
_HIGH_IN, _EDGES_IN = 2.7, 0.75
"""Inches of the figure, and of its title and labels."""


def figure(curves: Sequence[TrustCurve], arms: Sequence[Arm]) -> Figure:
    """Means with bars and bands of their 95 % intervals."""
    own, ends = run_styles.run_styles(arms), []
    low, high = window(curves)
    high_in = max(_HIGH_IN, _EDGES_IN + run_styles.names_height(curve.arm for curve in curves))
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
        run_styles.draw_names(ax, ends, run_styles.LINE_IN / (high_in - _EDGES_IN) * (high - low))
        ax.set_xlabel("trial of the session")
        ax.set_title(f"trust, {rules.TRUST_MIN} to {rules.TRUST_MAX}")
        matplotlib_svg.quiet_axes(ax, grid="y")
    return made


def window(curves: Sequence[TrustCurve]) -> tuple[float, float]:
    """The part of the scale that is drawn, from a whole point to another."""
    values = [end for curve in curves for pair in curve.ci95 for end in pair]
    low, high = run_styles.window(values, 1.0, (float(rules.TRUST_MIN), float(rules.TRUST_MAX)))
    if high - low < 2.0:
        low, high = (low - 1.0, high) if low - 1.0 >= rules.TRUST_MIN else (low, high + 1.0)
    return low, high
