"""The rule by which one robot is called better than another, for any number of comparisons at once.

`hthor compare` and `hthor report` judge with it; ranks use the same test and the same adjustment.
"""

from collections.abc import Sequence

from msgspec import Struct

from hthor.eval.results import paired_difference
from hthor.eval.statistics import intervals


class Verdict(Struct, frozen=True, kw_only=True):
    """The verdict on one difference among several.

    Attributes:
        among: how many comparisons were judged together.
        p: of no difference, adjusted for all of them by Holm's method; that of the difference alone where it is one.
        level: of the interval that belongs to the verdict, 0.95 of a single one: the level at which Holm's method tests
            this difference. The interval of this level leaves 0 out exactly when the verdict is not 0.
        sign: 1 when the difference is above 0, -1 when it is below, 0 when these data cannot tell.
    """

    among: int
    p: float
    level: float
    sign: int


def verdicts(differences: Sequence[tuple[float, float | None]]) -> tuple[Verdict, ...]:
    """The verdicts on differences that are looked at together, each given with its own p (None when unknown)."""
    own = [1.0 if p is None else p for _, p in differences]
    adjusted, levels = paired_difference.holm_adjusted(own), _levels(own)
    return tuple(
        Verdict(
            among=len(own),
            p=p,
            level=level,
            sign=0 if p >= 1.0 - intervals.LEVEL else (difference > 0.0) - (difference < 0.0),
        )
        for (difference, _), p, level in zip(differences, adjusted, levels, strict=True)
    )


def _levels(p: Sequence[float]) -> list[float]:
    """The level at which each is tested: the least p against 5 % by their number, and so on to the first that fails."""
    order = sorted(range(len(p)), key=lambda k: (p[k], k))
    levels, left, failed = [intervals.LEVEL] * len(p), len(p), False
    for k in order:
        least = (1.0 - intervals.LEVEL) / left
        levels[k] = round(1.0 - least, 6)
        failed = failed or p[k] >= least
        left -= not failed
    return levels
