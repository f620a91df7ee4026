"""Success of every run within parts of the trials, or with each kind of person."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from hthor.eval.pages import ink
from hthor.eval.pages.figures import marks
from hthor.eval.pages.findings import Arm, Group, Split

_STEP, _ROW = 0.22, 0.145
"""Distance of two robots within a group [rows], and inches that each of them takes up."""


def figure(splits: Sequence[Split], arms: Sequence[Arm], *, ranked: bool = False) -> Figure:
    """A row a group with its number of trials, a mark a run, with 95 % intervals.

    Args:
        ranked: the group in which people do worst first.
    """
    own = marks.of(arms, (label for split in splits for group in split.groups for label in group.sr))
    groups = [(split, _ranked(split.groups) if ranked else split.groups) for split in splits]
    labels = [label for label in own if any(label in group.sr for _, held in groups for group in held)]
    height = (len(labels) - 1) * _STEP + 0.55
    rows = sum(len(held) for _, held in groups)
    with ink.style():
        made = ink.sheet(0.75 + _ROW * rows * max(2.0, len(labels)) + 0.24 * len(splits), 6.4)
        ax = made.subplots()
        y, ticks = 0.0, []
        for split, held in groups:
            if len(splits) > 1:
                ax.text(-0.5, y, f"by {split.word}", ha="right", va="center", fontsize=7.5, color=ink.SOFT)
                y += 0.75 * height
            for group in held:
                ticks.append((y, f"{group.name}, {marks.count(list(group.sr.values()))}"))
                for label, one in group.sr.items():
                    shift = labels.index(label) - (len(labels) - 1) / 2
                    marks.interval(ax, y + _STEP * shift, one, own[label], thin=True)
                ax.axhline(y + height / 2, color=ink.LINE, lw=0.4)
                y += height
            y += 0.2
        ax.set_yticks([place for place, _ in ticks], [name for _, name in ticks])
        ax.set_ylim(y - 0.2 - height / 2, -height / 2)
        ax.set_xlim(-1, 101)
        ax.set_xlabel("success rate [%], with 95 % intervals")
        ink.bare(ax)
        handles = [marks.handle(own[label], label) for label in labels]
        made.legend(handles=handles, loc="outside upper right", ncols=min(4, len(handles)))
    return made


def _ranked(groups: Sequence[Group]) -> list[Group]:
    def mean(group: Group) -> float:
        rates = [one.mean for one in group.sr.values() if one.mean is not None]
        return sum(rates) / len(rates) if rates else 0.0

    return sorted(groups, key=lambda group: (mean(group), group.name))
