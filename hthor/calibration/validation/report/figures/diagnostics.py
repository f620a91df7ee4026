"""Figures that show how reliable the fit itself is: parameters, ranks, emulator."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from hthor.calibration.evidence import EmulatorFit, ParameterFinding, ParameterSwing
from hthor.calibration.targets import CONDITIONS
from hthor.calibration.validation.report import phrases
from hthor.calibration.validation.report.figures.predictions import CONDITION
from hthor.report.html import matplotlib_svg
from hthor.report.html.matplotlib_svg import CONDITION as COLOUR
from hthor.report.html.matplotlib_svg import FRONTIER, INK, LINE, ORACLE, PAPER, PRIOR, SHADE, SOFT, WIDE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_SHADES = {phrases.IDENTIFIED: ORACLE, phrases.WEAKLY: FRONTIER, phrases.NOT: PRIOR}


def contraction(parameters: Sequence[ParameterFinding]) -> Figure:
    """How much narrower than its prior each parameter's posterior is, and whether simulated studies recover it."""
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(0.6 + 0.165 * len(parameters), 6.2)
        ax = made.subplots()
        for y, one in enumerate(parameters):
            ax.barh(y, max(0.0, one.contraction), height=0.62, color=_SHADES[phrases.identified(one)])
            if one.recovery is not None:
                ax.plot(max(0.0, one.recovery), y, "o", mfc=PAPER, mec=INK, mew=0.9, ms=3.8)
        ax.set_yticks(range(len(parameters)), [one.name for one in parameters], family="monospace", fontsize=7)
        ax.set_ylim(len(parameters) - 0.4, -0.6)
        ax.set_xlim(0.0, 1.0)
        ax.set_xlabel("contraction (bar), recovery r (ring)")
        matplotlib_svg.quiet_axes(ax)
        rings = Line2D([], [], ls="", marker="o", mfc=PAPER, mec=INK, ms=3.8, label="recovery r")
        handles = [*(Patch(color=shade, label=word) for word, shade in _SHADES.items()), rings]
        made.legend(handles=handles, loc="outside upper center", ncols=4)
    return made


def ranks(parameters: Sequence[ParameterFinding]) -> Figure:
    """Ranks of the truth among posterior draws, for the parameters that have ranks; they should be flat."""
    shown = [one for one in parameters if one.ranks]
    rows = max(1, math.ceil(len(shown) / 5))
    columns = max(1, math.ceil(len(shown) / rows))
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(0.45 + 0.95 * rows)
        panels = made.subplots(rows, columns, squeeze=False, sharey=True).ravel()
        for ax, one in zip(panels, shown, strict=False):
            _histogram(ax, one)
        for ax in panels[len(shown) :]:
            ax.set_visible(False)
        made.supxlabel("rank of the true value, lowest to highest", fontsize=8)
    return made


def _histogram(axes: Axes, one: ParameterFinding) -> None:
    counts = np.asarray(one.ranks, dtype=float)
    mean = counts.mean()
    # Normal limits of a binomial count: 95 of 100 bars of a correct posterior lie within them.
    half = 1.96 * math.sqrt(mean * (1.0 - 1.0 / len(counts)))
    axes.axhspan(max(0.0, mean - half), mean + half, color=SHADE)
    axes.bar(np.arange(len(counts)), counts, width=0.9, color=ORACLE)
    axes.axhline(mean, color=SOFT, lw=0.7)
    axes.set_title(one.name, family="monospace", fontsize=7.5)
    axes.set_xticks([])
    matplotlib_svg.quiet_axes(axes, grid="y")


def reliability(parts: Sequence[EmulatorFit]) -> Figure:
    """Predicted against observed frequency, on trials that the emulators had not seen."""
    outcomes = list(dict.fromkeys(one.outcome for one in parts if one.bins))
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(2.5, min(WIDE, 2.5 * max(1, len(outcomes)) + 0.3))
        panels = made.subplots(1, max(1, len(outcomes)), squeeze=False, sharey=True)[0]
        for ax, outcome in zip(panels, outcomes, strict=True):
            ax.plot((0, 100), (0, 100), color=SOFT, lw=0.7, ls=(0, (4, 3)))
            for one in parts:
                if one.outcome == outcome and one.bins:
                    predicted, observed, _ = zip(*one.bins, strict=True)
                    ax.plot(
                        [100 * x for x in predicted],
                        [100 * y for y in observed],
                        "o-",
                        ms=3.2,
                        lw=1.1,
                        color=COLOUR[one.condition],
                        label=CONDITION[one.condition],
                    )
            ax.set(xlim=(-2, 102), ylim=(-2, 102), aspect="equal", title=outcome, xlabel="predicted [%]")
            matplotlib_svg.quiet_axes(ax, grid="both")
        panels[0].set_ylabel("observed [%]")
        handles = {
            name: Line2D([], [], color=COLOUR[name], marker="o", ms=3.2, label=CONDITION[name]) for name in CONDITIONS
        }
        made.legend(handles=list(handles.values()), loc="outside lower center", ncols=3)
    return made


def swings(parts: Sequence[ParameterSwing]) -> Figure:
    """The change of the gaps in success between robots when each parameter moves over its prior."""
    pairs = list(dict.fromkeys((one.better, one.worse) for one in parts))
    widest: dict[str, float] = {}
    for one in parts:
        widest[one.name] = max(widest.get(one.name, 0.0), abs(one.high - one.low))
    names = sorted(widest, key=lambda name: -widest[name])
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(0.75 + 0.165 * len(names))
        panels = made.subplots(1, len(pairs), sharey=True, squeeze=False)[0]
        for ax, (better, worse) in zip(panels, pairs, strict=True):
            ax.axvline(0.0, color=SOFT, lw=0.8)
            for one in parts:
                if (one.better, one.worse) == (better, worse):
                    y = names.index(one.name)
                    ax.plot((100 * one.low, 100 * one.high), (y, y), color=LINE, lw=2.4, zorder=2)
                    ax.plot(100 * one.low, y, "o", mfc=PAPER, mec=ORACLE, mew=1.1, ms=4.2, zorder=3)
                    ax.plot(100 * one.high, y, "o", color=ORACLE, ms=4.6, zorder=4)
            ax.set_title(f"SR, {CONDITION[better]} minus {CONDITION[worse]} [points]")
            ax.set_yticks(range(len(names)), names, family="monospace", fontsize=7)
            matplotlib_svg.quiet_axes(ax)
        panels[0].set_ylim(len(names) - 0.4, -0.6)
        ends = [
            Line2D([], [], ls="", marker="o", mfc=PAPER, mec=ORACLE, ms=4.2, label="low end of the prior"),
            Line2D([], [], ls="", marker="o", color=ORACLE, ms=4.6, label="high end"),
        ]
        made.legend(handles=ends, loc="outside lower center", ncols=2)
    return made
