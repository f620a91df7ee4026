"""Figures of published and predicted numbers, of time spent and of trust."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from hthor.calibration.evidence import Band, HeldOutCondition, PredictedFigure
from hthor.calibration.targets import CONDITIONS
from hthor.calibration.validation.report.findings import FigurePrediction, Findings
from hthor.eval.metrics import registry
from hthor.report.html import matplotlib_svg
from hthor.report.html.matplotlib_svg import CONDITION as COLOUR
from hthor.report.html.matplotlib_svg import INK, LINE, ORACLE, PAPER, PRIOR, PUBLISHED, SHADE, SOFT

if TYPE_CHECKING:
    from matplotlib.axes import Axes
from hthor import rules
from hthor.calibration.validation.report.findings import TimeSpent, TrustFindings

METRICS = {name: registry.get(name).title for name in ("sr", "twsr", "adoption")}
CONDITION = {"none": "no robot", "frontier": "frontier", "oracle": "oracle"}


def table(rows: Sequence[FigurePrediction]) -> Figure:
    """The eight figures: published values, and intervals of simulated study groups."""
    with matplotlib_svg.style():
        made, panels = _panels(1.75, [row.band for row in rows])
        for row in rows:
            metric, condition = row.figure.split()
            ax, y, shade = panels[metric], CONDITIONS.index(condition), COLOUR[condition]
            half = 100.0 * row.tolerance
            ax.barh(y, 2 * half, left=100.0 * row.published - half, height=0.56, color=SHADE, zorder=1)
            _interval(ax, y, row.band, shade)
            _diamond(ax, y, row.published)
        made.legend(
            handles=[_line(SOFT, "study group, median and 90 %"), _mark("published"), _patch("allowed for the median")],
            loc="outside lower center",
            ncols=3,
        )
    return made


def before_after(rows: Sequence[PredictedFigure], published: dict[str, float]) -> Figure:
    """Prior and posterior predictive intervals of the eight figures."""
    with matplotlib_svg.style():
        made, panels = _panels(2.1, [band for row in rows for band in (row.prior, row.posterior)])
        for row in rows:
            metric, condition = row.figure.split()
            ax, y = panels[metric], CONDITIONS.index(condition)
            _interval(ax, y - 0.2, row.prior, PRIOR, width=2.0)
            _interval(ax, y + 0.2, row.posterior, COLOUR[condition])
            _diamond(ax, y, published[row.figure])
        made.legend(
            handles=[_line(PRIOR, "prior, 90 %"), _line(ORACLE, "posterior, 90 %"), _mark("published")],
            loc="outside lower center",
            ncols=3,
        )
    return made


def held_out(parts: Sequence[HeldOutCondition]) -> Figure:
    """Each condition as predicted from the other two, 80 % intervals."""
    with matplotlib_svg.style():
        made, panels = _panels(1.75, [row.band for part in parts for row in part.figures])
        for part in parts:
            for row in part.figures:
                metric, condition = row.figure.split()
                ax, y = panels[metric], CONDITIONS.index(condition)
                _interval(ax, y, row.band, COLOUR[condition])
                _diamond(ax, y, row.published)
        made.legend(
            handles=[_line(SOFT, "predicted without it, median and 80 %"), _mark("published")],
            loc="outside lower center",
            ncols=2,
        )
    return made


def scores(findings: Findings) -> Figure:
    """Log scores of each condition's published data: held out, prior, and simple human models."""
    assert findings.evidence is not None
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(1.9)
        panels = made.subplots(1, len(findings.evidence.held_out), sharex=True, sharey=True, squeeze=False)[0]
        for ax, part in zip(panels, findings.evidence.held_out, strict=True):
            named = {
                "fitted on the others": part.log_score,
                "prior": part.log_score_prior,
                **dict(sorted(part.rivals.items())),
            }
            for y, score in enumerate(named.values()):
                shade = COLOUR[part.condition] if y == 0 else PRIOR
                ax.barh(y, score, height=0.6, color=shade)
                ax.text(score, y, f"{score:.1f} ".replace("-", "−"), ha="right", va="center", fontsize=7, color=INK)
            ax.set_yticks(range(len(named)), list(named))
            ax.set_title(f"{CONDITION[part.condition]} held out")
            ax.set_xlabel("log score [nats], higher is better")
            matplotlib_svg.quiet_axes(ax)
            ax.set_xlim(1.3 * min(0.0, *named.values()), 0.0)
        panels[0].invert_yaxis()
    return made


def _panels(height: float, bands: Sequence[Band]) -> tuple[Figure, dict[str, Axes]]:
    """Three axes that share a scale, which begins at the multiple of ten below the lowest band."""
    first = 10 * int(10.0 * min([0.5, *(band.low for band in bands)]))
    made = matplotlib_svg.new_figure(height)
    panels = made.subplots(1, 3, sharey=True)
    for ax, (metric, title) in zip(panels, METRICS.items(), strict=True):
        matplotlib_svg.quiet_axes(ax)
        ax.set_title(f"{title} [%]")
        ax.set_xlim(first, 100)
        ax.set_ylim(2.6, -0.6)
        ax.set_yticks(range(3), [CONDITION[name] for name in CONDITIONS])
        if metric == "adoption":
            ax.text((first + 100) / 2, 0, "no robot to adopt", ha="center", va="center", color=SOFT, fontsize=7)
    return made, dict(zip(METRICS, panels, strict=True))


def _interval(ax: Axes, y: float, band: Band, shade: str, width: float = 2.6) -> None:
    ax.plot((100.0 * band.low, 100.0 * band.high), (y, y), color=shade, lw=width, zorder=3)
    ax.plot(100.0 * band.median, y, "o", color=shade, ms=5.2, mec=PAPER, mew=0.9, zorder=4)


def _diamond(ax: Axes, y: float, value: float) -> None:
    ax.plot(100.0 * value, y, "D", mfc="none", mec=PUBLISHED, mew=1.4, ms=6.4, zorder=5)


def _line(shade: str, label: str) -> Line2D:
    return Line2D([], [], color=shade, lw=2.6, marker="o", ms=5, mec=PAPER, mew=0.9, label=label)


def _mark(label: str) -> Line2D:
    return Line2D([], [], ls="", marker="D", mfc="none", mec=PUBLISHED, mew=1.4, ms=6, label=label)


def _patch(label: str) -> Patch:
    return Patch(facecolor=SHADE, edgecolor=LINE, linewidth=0.5, label=label)


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
