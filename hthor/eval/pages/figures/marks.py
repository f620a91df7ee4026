"""How robots are told apart in every figure: a colour, and a mark for those who see none; knows nothing of results."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from matplotlib.lines import Line2D
from msgspec import Struct

from hthor.eval.pages import ink
from hthor.eval.pages.findings import Arm
from hthor.eval.stats import Estimate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_OTHERS = ("#9a5fb5", "#2f9270", "#c4587f", "#7f7a2c", "#4a79c4")
_SHAPES = {"none": "o", "frontier": "s", "oracle": "^"}
_MORE = ("v", "P", "X", "p", "h")


class Mark(Struct, frozen=True, kw_only=True):
    """A run's colour and mark."""

    shade: str
    shape: str


def of(arms: Sequence[Arm], more: Iterable[str] = ()) -> dict[str, Mark]:
    """A mark for each run by its label; the paper's three conditions always look alike, the first of each at least.

    Args:
        more: labels that may be of none of the runs.
    """
    found: dict[str, Mark] = {}
    taken: set[str] = set()
    conditions = {arm.label: arm.condition for arm in arms}
    for label in dict.fromkeys((*conditions, *more)):
        condition = conditions.get(label, "")
        if condition and condition not in taken:
            taken.add(condition)
            found[label] = Mark(shade=ink.CONDITION[condition], shape=_SHAPES[condition])
        else:
            number = len(found) - len(taken)
            found[label] = Mark(shade=_OTHERS[number % len(_OTHERS)], shape=_MORE[number % len(_MORE)])
    return found


def interval(ax: Axes, y: float, one: Estimate, mark: Mark, scale: float = 100.0, *, thin: bool = False) -> None:
    """A mean with its 95 % interval, lying."""
    if one.mean is None or one.ci95 is None:
        return
    ends = [scale * end for end in one.ci95]
    ax.plot(ends, (y, y), color=mark.shade, lw=1.1 if thin else 2.2, zorder=3)
    size = 4.4 if thin else 6.0
    ax.plot(scale * one.mean, y, mark.shape, color=mark.shade, ms=size, mec=ink.PAPER, mew=0.7, zorder=4)


def handle(mark: Mark, label: str) -> Line2D:
    """An entry of a legend."""
    return Line2D([], [], color=mark.shade, lw=1.4, marker=mark.shape, ms=5, mec=ink.PAPER, mew=0.7, label=label)


def count(estimates: Sequence[Estimate]) -> str:
    """How many trials: "n = 60", or the range where runs differ."""
    counts = sorted({one.n for one in estimates})
    return f"n = {counts[0]}" if len(counts) == 1 else f"n = {counts[0]} to {counts[-1]}"
