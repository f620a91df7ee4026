"""Trust by trial of the session."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from hthor import rules
from hthor.eval.pages import ink
from hthor.eval.pages.figures import marks
from hthor.eval.pages.findings import Arm, Curve

_SIDE = 0.07
_APART = 0.34
"""Least distance between two names at the right [points of trust]."""


def figure(curves: Sequence[Curve], arms: Sequence[Arm]) -> Figure:
    """Means with bars of one standard error over people."""
    own = marks.of(arms)
    with ink.style():
        made = ink.sheet(2.6, 5.6)
        ax = made.subplots()
        for number, curve in enumerate(curves):
            mark = own[curve.arm]
            x = [trial + _SIDE * (2 * number - len(curves) + 1) for trial in curve.trial]
            bars = [0.0 if error is None else error for error in curve.se]
            ax.errorbar(
                x, curve.mean, yerr=bars, color=mark.shade, marker=mark.shape, ms=3.6, lw=1.3, elinewidth=0.9, capsize=0
            )
        for curve, height in _heights(curves):
            many = sorted({curve.people[0], curve.people[-1]}, reverse=True)
            people = " to ".join(str(count) for count in many)
            ax.annotate(
                f"{curve.arm} ({people} people)",
                (curve.trial[-1], height),
                (12, 0),
                textcoords="offset points",
                color=own[curve.arm].shade,
                va="center",
                annotation_clip=False,
            )
        ax.set_xticks(sorted({trial for curve in curves for trial in curve.trial}))
        ax.set_ylim(rules.TRUST_MIN, rules.TRUST_MAX)
        ax.set_xlabel("trial of the session")
        ax.set_ylabel("trust, 1 to 7")
        ink.bare(ax, grid="y")
    return made


def _heights(curves: Sequence[Curve]) -> list[tuple[Curve, float]]:
    """Where each curve's name stands: at its end, moved up where it would touch the one below."""
    placed: list[tuple[Curve, float]] = []
    for curve in sorted(curves, key=lambda one: one.mean[-1]):
        lowest = placed[-1][1] + _APART if placed else float(rules.TRUST_MIN)
        placed.append((curve, max(curve.mean[-1], lowest)))
    return placed
