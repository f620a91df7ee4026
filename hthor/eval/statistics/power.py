"""How many trials it takes to detect a difference of two rates."""

import math

import numpy as np
from msgspec import Struct

from hthor import rules
from hthor.errors import HthorError
from hthor.eval.statistics import intervals

_MOST = 10**7


class SampleSize(Struct, frozen=True, kw_only=True):
    """How many trials (tasks done once each) and how many sessions (ten tasks each) are needed for each robot."""

    difference: float
    correlation: float
    power: float
    trials: int
    sessions: int


class Scatter(Struct, frozen=True, kw_only=True):
    """How much a trial's difference varies: its variance as if trials were independent, and degrees of freedom.

    ``freedom`` is the degrees of freedom that each trial adds: 1 for independent trials, less where ten trials are of
    one session and sessions differ.
    """

    variance: float
    freedom: float = 1.0


def variance_of_difference(first: float, second: float, correlation: float) -> float:
    """The variance of one trial's difference in success, for both success rates and the outcomes' correlation."""
    one, other = (rate * (1.0 - rate) for rate in (first, second))
    return one + other - 2.0 * correlation * math.sqrt(one * other)


def correlation_range(first: float, second: float) -> tuple[float, float]:
    """The least and the greatest correlation that outcomes with these rates can have."""
    spread = math.sqrt(first * (1.0 - first) * second * (1.0 - second))
    if spread <= 0.0:
        return 0.0, 0.0
    return ((max(0.0, first + second - 1.0) - first * second) / spread, (min(first, second) - first * second) / spread)


def check_rates(first: float, second: float) -> None:
    """Raise an HthorError that names the first of these numbers that cannot be a rate."""
    for name, rate in (("first", first), ("second", second)):
        if not 0.0 <= rate <= 1.0:
            raise HthorError(f"the {name} rate is {rate:g}, but must be from 0 to 1.")


def sample_size(
    first: float,
    second: float,
    *,
    correlation: float = 0.0,
    power: float = intervals.POWER,
    scatter: Scatter | None = None,
) -> SampleSize:
    """The sample size that separates two success rates, two-sided at 5 %, with tasks that are done once each.

    Args:
        correlation: of the outcomes of the same trial with either robot; 0 for runs that are not paired.
        power: the wanted probability of seeing the difference.
        scatter: the measured scatter of a trial's difference; None for that of independent trials.

    Raises:
        HthorError: when a rate or the correlation is impossible.
    """
    check_rates(first, second)
    low, high = correlation_range(first, second)
    if not low - 1e-9 <= correlation <= high + 1e-9:
        raise HthorError(
            f"outcomes with rates {first:g} and {second:g} cannot correlate by {correlation:g}: "
            f"it must be from {low:.2f} to {high:.2f}."
        )
    held = scatter or Scatter(variance=variance_of_difference(first, second, correlation))
    trials = trials_needed(second - first, held, power=power)
    if trials is None:
        raise HthorError(
            "the two rates are equal, and no number of trials can tell them apart. Give two rates, or --difference."
        )
    return SampleSize(
        difference=round(second - first, 6),
        correlation=round(correlation, 6),
        power=power,
        trials=trials,
        sessions=math.ceil(trials / rules.SESSION_TASKS),
    )


def trials_needed(difference: float, scatter: Scatter, *, power: float = intervals.POWER) -> int | None:
    """How many trials detect this mean difference with this power; None if it is 0, or too many would be needed."""
    if difference == 0.0:
        return None
    few, many = 2, 4
    while not _enough(many, difference, scatter, power):
        few, many = many, 2 * many
        if many > _MOST:
            return None
    while many - few > 1:
        middle = (few + many) // 2
        few, many = (few, middle) if _enough(middle, difference, scatter, power) else (middle, many)
    return many


def rounded_count(number: int) -> str:
    """A predicted count with two significant figures."""
    digits = len(str(number)) - 2
    return str(round(number, -digits)) if digits > 0 else str(number)


def _enough(count: int, difference: float, scatter: Scatter, power: float) -> bool:
    freedom = np.array(max(1.0, count * scatter.freedom - 1.0))
    factor = float(
        intervals.student_quantile(freedom, (1.0 + intervals.LEVEL) / 2.0) + intervals.student_quantile(freedom, power)
    )
    return factor * math.sqrt(scatter.variance / count) <= abs(difference)
