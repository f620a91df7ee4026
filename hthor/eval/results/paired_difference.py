"""The difference of two runs in one metric over the same trials: interval, p-value and detectable difference."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import msgspec
import numpy as np
from msgspec import Struct

from hthor.eval.metrics import registry, trial_metrics
from hthor.eval.metrics.metric import mean_limit
from hthor.eval.statistics import intervals, power, variance_components
from hthor.eval.statistics.variance_components import MeanSpread

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hthor.eval.metrics.metric import Metric
    from hthor.eval.results.pairing import Pair

CODE_ROOT = "scoring"

_DIGITS = 6


class Difference(Struct, frozen=True, kw_only=True):
    """The second run's mean of a metric minus the first's, over ``n`` trials that both runs have.

    Attributes:
        first, second: the means over these trials. difference: the second minus the first.
        ci95: for new tasks and new participants. p: the two-sided p-value of no difference, consistent with ci95.
        mde80: the smallest true difference that so many trials would detect with a power of 80 %.
        correlation: of the two runs' values in the same trial; None if one of them never varies.
        gain: how many times fewer trials pairing needs: the variance of a difference between unpaired trials over that
            between paired ones; None if no trial differs.
        more_tasks: about how many more tasks, done once each, would show a difference of this size with 80 % power; 0
            if these are enough, None if there is no difference to show.
    """

    n: int
    first: float
    second: float
    difference: float
    ci95: tuple[float, float] | None
    p: float | None
    mde80: float | None
    correlation: float | None
    gain: float | None
    more_tasks: int | None

    @property
    def separated(self) -> bool:
        """Whether the difference is significant at 5 %."""
        return self.p is not None and self.p < 1.0 - intervals.LEVEL


class Noise(Struct, frozen=True, kw_only=True):
    """How much single trials of two runs vary: their paired differences, and differences of unpaired trials."""

    paired: power.Scatter
    unpaired: power.Scatter


class McNemar(Struct, frozen=True, kw_only=True):
    """Trials that only the first run solved, and only the second; the exact two-sided p of McNemar's test.

    The test assumes independent trials, but trials of one participant are not quite independent.
    """

    only_first: int
    only_second: int
    p: float


class Verdict(Struct, frozen=True, kw_only=True):
    """The verdict on one difference among several.

    Attributes:
        among: how many comparisons were judged together.
        p: the p-value of no difference, adjusted for all comparisons by Holm's method; unadjusted for a single one.
        level: the level at which Holm's method tests this difference, 0.95 for a single comparison. The interval of
            this level excludes 0 exactly when ``sign`` is not 0.
        sign: 1 when the difference is above 0, -1 when it is below, 0 when these data cannot tell.
    """

    among: int
    p: float
    level: float
    sign: int


def paired_difference(pairs: Sequence[Pair], metric: str, *, level: float = intervals.LEVEL) -> Difference | None:
    """The difference in a metric with an interval of this level; None where no trial has a value in both runs."""
    values = [(pair.one.metrics[metric], pair.other.metrics[metric], pair.one.spec) for pair in pairs]
    rows = [(one, other, spec) for one, other, spec in values if one is not None and other is not None]
    if not rows:
        return None
    return difference_of_values(
        np.array([one for one, _, _ in rows], dtype=np.float64),
        np.array([other for _, other, _ in rows], dtype=np.float64),
        variance_components.group_codes([spec.task.id for _, _, spec in rows]),
        variance_components.group_codes([spec.session for _, _, spec in rows]),
        registry.get(metric),
        limit_s=mean_limit([spec.task.time_limit for _, _, spec in rows]),
        level=level,
    )


def difference_of_values(
    first: np.ndarray,
    second: np.ndarray,
    tasks: np.ndarray,
    people: np.ndarray,
    metric: Metric,
    *,
    limit_s: float | None,
    level: float = intervals.LEVEL,
) -> Difference:
    """The difference of two rows of values of a metric, (N,) each, of the same trials.

    Args:
        tasks, people: (N,) indices from 0. limit_s: the mean time limit [s], None where it is not known.
        level: of the interval, two-sided; above 0.95 for one of several comparisons.
    """
    count, share, room = len(first), metric.is_share, metric.width(limit_s)
    found = difference_spread((second - first)[None], tasks, people, share=share)
    raw, freedom = float(found.mean[0]), float(found.freedom[0])
    known = math.isfinite(float(found.variance[0]))
    low, high = (float(end[0]) for end in interval_ends(found, share=share, room=room, level=(1.0 + level) / 2.0))
    needed = float(intervals.detectable_difference(found, count)[0])
    gap = rounded(float(second.mean())) - rounded(float(first.mean()))  # as `hthor power` reads it
    return Difference(
        n=count,
        first=rounded(float(first.mean())),
        second=rounded(float(second.mean())),
        difference=rounded(raw),
        ci95=(rounded(min(low, raw)), rounded(max(high, raw))) if known else None,
        p=p_value(raw, float(null_variance(found, share=share)[0]), freedom) if known else None,
        mde80=rounded(needed) if known else None,
        correlation=_correlation(first, second),
        gain=_gain(first, second),
        more_tasks=more_trials(gap, float(found.variance[0]) * count, freedom, count) if known else None,
    )


def difference_spread(gaps: np.ndarray, tasks: np.ndarray, people: np.ndarray, *, share: bool) -> MeanSpread:
    """The spread of the mean of differences, (..., N), as all comparisons use it.

    Args:
        share: whether they are differences of shares. The variance of their mean is then never below that of two trials
            with a difference of 1: two robots that never differed in sixty trials are not certainly equal.
    """
    found, count = variance_components.two_way_spread(gaps, tasks, people, differences=True), gaps.shape[-1]
    if not share:
        return found
    variance, single = np.maximum(found.variance, 2.0 / count**2), np.maximum(found.single, 2.0 / count)
    return msgspec.structs.replace(found, variance=variance, single=single)


def null_variance(found: MeanSpread, *, share: bool) -> np.ndarray:
    """The variance of a mean difference under the hypothesis of no difference.

    For shares it is taken about zero instead of about the mean, so that a few trials in favour of one robot do not look
    more certain than they are (a score test; McNemar's, if trials are independent).
    """
    return found.variance * (1.0 + found.mean**2 / found.single) if share else found.variance


def interval_ends(
    found: MeanSpread, *, share: bool, room: float = 1.0, level: float = (1.0 + intervals.LEVEL) / 2.0
) -> tuple[np.ndarray, np.ndarray]:
    """The 95 % interval: every true difference from which the observed difference does not differ significantly.

    The variance under a true difference is as in `null_variance`, but about that difference instead of 0, and never
    more than is possible: differences between -``room`` and ``room`` with mean d have a variance of at most room² - d².
    So the interval never leaves these bounds, and it contains 0 exactly when `p_value` does not reject 0.

    Args:
        room: the largest possible difference, 1 for shares; infinite where there is no bound.
        level: of the quantile, one-sided.
    """
    quantile = intervals.student_quantile(found.freedom, level)
    some = quantile**2 * found.variance
    half = np.sqrt(some)
    if share:
        left = 1.0 - some / found.single
        half = np.where(left > 0.0, np.sqrt(some / np.where(left > 0.0, left, 1.0)), np.inf)
    low, high = found.mean - half, found.mean + half
    return (low, high) if math.isinf(room) else _inside(found, some, room, low, high)


def _inside(
    found: MeanSpread, some: np.ndarray, room: float, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The part of an interval in which differences need not vary more than possible: a score interval like Wilson's."""
    known = np.isfinite(some) & (found.single > 0.0)
    worth = np.where(known, some / np.where(known, found.single, 1.0), 0.0)
    mean = np.clip(found.mean / room, -1.0, 1.0)
    half = np.sqrt(worth * (1.0 - mean**2 + worth))
    least, most = room * (mean - half) / (1.0 + worth), room * (mean + half) / (1.0 + worth)
    return np.where(known, np.maximum(low, least), low), np.where(known, np.minimum(high, most), high)


def p_value(centre: float, variance: float, freedom: float) -> float:
    """Two-sided p of a mean of 0, by Student's t."""
    if variance <= 0.0:
        return 1.0 if centre == 0.0 else 0.0
    from scipy import special

    return float(f"{2.0 * float(special.stdtr(freedom, -abs(centre) / math.sqrt(variance))):.6g}")


def mcnemar(pairs: Sequence[Pair]) -> McNemar:
    """McNemar's exact test of success."""
    first = trial_metrics.column((pair.one.metrics for pair in pairs), "sr")
    second = trial_metrics.column((pair.other.metrics for pair in pairs), "sr")
    only_first, only_second = int((first > second).sum()), int((first < second).sum())
    return McNemar(only_first=only_first, only_second=only_second, p=exact_p_value(only_first, only_second))


def exact_p_value(one: int, other: int) -> float:
    """Probability of a split at least as uneven as this when either side is as likely."""
    count, least = one + other, min(one, other)
    below = sum(math.comb(count, k) for k in range(least + 1))
    return float(f"{min(1.0, 2 * below / 2**count):.6g}")  # whole numbers to the end: nothing underflows


def holm_adjusted(p: Sequence[float]) -> list[float]:
    """Holm's adjusted p-values for several comparisons at once, in the order given."""
    order = sorted(range(len(p)), key=lambda k: (p[k], k))
    adjusted, most = [0.0] * len(p), 0.0
    for rank, k in enumerate(order):
        most = max(most, min(1.0, (len(p) - rank) * p[k]))
        adjusted[k] = float(f"{most:.6g}")
    return adjusted


def verdicts(differences: Sequence[tuple[float, float | None]]) -> tuple[Verdict, ...]:
    """The verdicts on differences that are judged together, each given with its own p (None when unknown).

    This is the rule by which one robot is called better than another; ranks use the same test and the same adjustment.
    """
    own = [1.0 if p is None else p for _, p in differences]
    adjusted, levels = holm_adjusted(own), _levels(own)
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
    """The levels of Holm's tests: the smallest of n p-values at 5 % / n, the next at 5 % / (n - 1), until one fails."""
    order = sorted(range(len(p)), key=lambda k: (p[k], k))
    levels, left, failed = [intervals.LEVEL] * len(p), len(p), False
    for k in order:
        least = (1.0 - intervals.LEVEL) / left
        levels[k] = round(1.0 - least, 6)
        failed = failed or p[k] >= least
        left -= not failed
    return levels


def trial_noise(pairs: Sequence[Pair], metric: str) -> Noise:
    """How much single trials of these pairs vary in a metric that every trial has."""
    values = np.array([[one.metrics[metric] for one in (pair.one, pair.other)] for pair in pairs], dtype=float)
    tasks = variance_components.group_codes([pair.one.spec.task.id for pair in pairs])
    people = variance_components.group_codes([pair.one.spec.session for pair in pairs])
    gap = difference_spread((values[:, 1] - values[:, 0])[None], tasks, people, share=registry.get(metric).is_share)
    each = variance_components.two_way_spread(values.T, tasks, people)
    count = len(pairs)
    first, second = (count * each.variance).tolist()
    return Noise(
        paired=power.Scatter(variance=count * float(gap.variance[0]), freedom=_a_trial(float(gap.freedom[0]), count)),
        unpaired=power.Scatter(variance=first + second, freedom=_a_trial(float(each.freedom.min()), count)),
    )


def _a_trial(freedom: float, count: int) -> float:
    """Degrees of freedom that one trial adds, if ``count`` trials have ``freedom``."""
    return min(1.0, (freedom + 1.0) / count)


def more_trials(difference: float, variance: float, freedom: float, count: int) -> int | None:
    """How many more trials than ``count`` would show a difference; ``variance`` is that of a single trial."""
    needed = power.trials_needed(difference, power.Scatter(variance=variance, freedom=_a_trial(freedom, count)))
    return None if needed is None else max(0, needed - count)


def _correlation(first: np.ndarray, second: np.ndarray) -> float | None:
    one, other = first - first.mean(), second - second.mean()
    both = math.sqrt(float((one**2).sum()) * float((other**2).sum()))
    return round(float((one * other).sum()) / both, 4) if both > 1e-12 else None


def _gain(first: np.ndarray, second: np.ndarray) -> float | None:
    within = float((second - first).var())
    return round(float(first.var() + second.var()) / within, 4) if within > 1e-12 else None


def rounded(value: float) -> float:
    """A number of a result."""
    return round(value, _DIGITS) + 0.0
