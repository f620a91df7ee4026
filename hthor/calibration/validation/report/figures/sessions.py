"""Figures of sessions: time spent, and trust by trial."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from hthor import rules
from hthor.calibration.validation.report.figures.predictions import CONDITION
from hthor.calibration.validation.report.findings import TimeSpent, TrustFindings
from hthor.report.html import matplotlib_svg
from hthor.report.html.matplotlib_svg import CONDITION as COLOUR
from hthor.report.html.matplotlib_svg import PAPER


def spent(parts: Sequence[TimeSpent]) -> Figure:
    """Box plots of the time spent: minimum, quartiles, maximum."""
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(0.7 + 0.36 * len(parts), 6.2)
        ax = made.subplots()
        for y, one in enumerate(parts):
            shade = COLOUR[one.condition]
            ax.plot((one.least, one.most), (y, y), color=shade, lw=1.0, zorder=2)
            ax.barh(
                y,
                one.upper - one.lower,
                left=one.lower,
                height=0.52,
                facecolor=PAPER,
                edgecolor=shade,
                lw=1.4,
                zorder=3,
            )
            ax.plot(
                (one.median, one.median), (y - 0.26, y + 0.26), color=shade, lw=2.4, solid_capstyle="butt", zorder=4
            )
            ax.plot((one.least, one.most), (y, y), "|", color=shade, ms=9, mew=1.2, zorder=4)
        ax.set_yticks(range(len(parts)), [CONDITION[one.condition] for one in parts])
        ax.set_ylim(len(parts) - 0.45, -0.55)
        ax.set_xlim(0.0, 1.02 * rules.TIME_LIMIT_S)
        ax.set_xlabel("time spent [s]; unsolved trials count with the limit")
        matplotlib_svg.quiet_axes(ax)
    return made


def trust(found: TrustFindings) -> Figure:
    """Mean trust by trial, bars of one standard error."""
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(2.5, 5.2)
        ax = made.subplots()
        for shift, curve in zip((-0.06, 0.06), found.curves, strict=False):
            shade = COLOUR[curve.condition]
            x = [trial + 1 + shift for trial in range(len(curve.mean))]
            ax.errorbar(
                x, curve.mean, yerr=curve.se, color=shade, marker="o", ms=3.2, lw=1.4, elinewidth=1.0, capsize=0
            )
            ax.annotate(
                CONDITION[curve.condition],
                (x[-1], curve.mean[-1]),
                (8, 0),
                textcoords="offset points",
                color=shade,
                va="center",
                annotation_clip=False,
            )
        ax.set_xticks(range(1, 1 + max(len(curve.mean) for curve in found.curves)))
        ax.set_ylim(rules.TRUST_MIN, rules.TRUST_MAX)
        ax.set_xlabel("trial of the session")
        ax.set_ylabel("trust, 1 to 7")
        matplotlib_svg.quiet_axes(ax, grid="y")
    return made
