"""Draws the success of every run within parts of the trials, or with each human population."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from msgspec import Struct

from hthor.report.analysis.document import Arm, Group, Split
from hthor.report.drawing import text_fit
from hthor.report.html import matplotlib_svg
from hthor.report.page.figures import run_styles
from hthor.report.page.figures.run_styles import RunStyle

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ROW = 0.13
"""Height of each robot's row within a group [in]."""
_HEAD = 0.45
"""Height of the name of a split, in heights of a group."""
_LEGEND = 5
"""Columns of the legend at most."""
_LONG = 8
"""If there are more groups, they stand in two columns."""


class _Line(Struct):
    """A line of the figure: a group, or the name of the property that divides the groups below."""

    word: str
    group: Group | None = None


def figure(splits: Sequence[Split], arms: Sequence[Arm], *, ranked: bool = False) -> Figure:
    """One row per group with its number of trials, and one mark per run with its 95 % interval.

    Args:
        ranked: whether the group in which people do worst comes first.
    """
    own = run_styles.run_styles(arms, (label for split in splits for group in split.groups for label in group.sr))
    lines: list[_Line] = []
    for split in splits:
        lines += [_Line(word=split.word)] if len(splits) > 1 else []
        held = _ranked(split.groups) if ranked else split.groups
        lines += [
            _Line(word=f"{group.name}, {run_styles.trial_count(list(group.sr.values()))}", group=group)
            for group in held
        ]
    half = -(-len(lines) // 2) if ranked and len(lines) > _LONG else len(lines)
    columns = [lines[:half], lines[half:]] if half < len(lines) else [lines]
    labels = [label for label in own if any(line.group and label in line.group.sr for line in lines)]
    ends = [
        100.0 * value
        for line in lines
        if line.group
        for one in line.group.sr.values()
        for value in (one.mean, *(one.ci95 or ()))
        if value is not None
    ]
    with matplotlib_svg.style():
        high = max(_places(column)[1] for column in columns)
        made = matplotlib_svg.new_figure(0.85 + high * (_ROW * len(labels) + 0.12))
        panels = made.subplots(1, len(columns), sharex=True, squeeze=False)[0]
        for ax, column in zip(panels, columns, strict=True):
            _draw(ax, column, {label: own[label] for label in labels})
            ax.set_ylim(high, 0.0)
            ax.set_xlabel("success rate [%]")
        panels[0].set_xlim(run_styles.window(ends, 10.0, (-1.0, 101.0)))
        handles = [run_styles.legend_handle(own[label], label) for label in labels]
        text_fit.legend(made, handles, _LEGEND, loc="outside upper left")
    return made


def _draw(ax: Axes, lines: Sequence[_Line], own: dict[str, RunStyle]) -> None:
    labels, step = list(own), 0.74 / max(1, len(own))
    shaded, (places, _) = False, _places(lines)
    for y, line in zip(places, lines, strict=True):
        shaded = line.group is not None and not shaded
        if shaded:
            ax.axhspan(y - 0.5, y + 0.5, color=matplotlib_svg.SHADE, lw=0, zorder=0)
        for label, one in line.group.sr.items() if line.group else ():
            shift = step * (labels.index(label) - (len(labels) - 1) / 2)
            run_styles.estimate(ax, y + shift, one, own[label], thin=True)
    matplotlib_svg.quiet_axes(ax)
    ax.set_yticks(places, [line.word for line in lines])
    for tick, line in zip(ax.get_yticklabels(), lines, strict=True):
        if line.group is None:
            tick.set(style="italic", color=matplotlib_svg.SOFT)


def _places(lines: Sequence[_Line]) -> tuple[list[float], float]:
    """The middle of each line, counted from the top, and the height of all lines."""
    places, y = [], 0.0
    for line in lines:
        high = _HEAD if line.group is None else 1.0
        places.append(y + (high / 2 if line.group is not None else 0.7 * high))
        y += high
    return places, y


def _ranked(groups: Sequence[Group]) -> list[Group]:
    def mean(group: Group) -> float:
        rates = [one.mean for one in group.sr.values() if one.mean is not None]
        return sum(rates) / len(rates) if rates else 0.0

    return sorted(groups, key=lambda group: (mean(group), group.name))
