"""Means with intervals that allow for trials that share tasks and people."""

import math
from collections.abc import Sequence

import numpy as np
from msgspec import Struct

from hthor.eval.statistics import variance_components

LEVEL = 0.95
NORMAL = 1.959964
"""The quantile of the normal distribution for `LEVEL`, two-sided."""
POWER = 0.8
_DIGITS = 6
_EDGE = 1e-12
"""A mean this near to a bound, as a share of the range, lies on it."""
Range = tuple[float, float]
ANY: Range = (-math.inf, math.inf)
SHARE: Range = (0.0, 1.0)


class Estimate(Struct, frozen=True, kw_only=True):
    """A mean over ``n`` trials and its 95 % interval; None where there is nothing to average.

    ``mde80`` is the smallest distance of the true mean from a given number that as many such trials would detect with a
    probability of 0.8. It and the interval are None for a single trial of an unbounded metric.
    """

    mean: float | None
    ci95: tuple[float, float] | None
    n: int
    mde80: float | None = None


NOTHING = Estimate(mean=None, ci95=None, n=0)


def estimate(values: Sequence[float], tasks: Sequence[str], people: Sequence[int], *, within: Range = ANY) -> Estimate:
    """Mean of ``values`` with an interval for new tasks and new people of the same populations.

    Trials that share a task or a person are not independent; `hthor.eval.statistics.variance_components` says how much
    that matters. With bounds the interval is a score interval, which never leaves them: Wilson's between two bounds,
    with the effective number of trials, and Poisson's above one bound. Without bounds it is the mean ± some standard
    errors. All use quantiles of Student's t. docs/statistics.md says how often they contain the true mean.

    Args:
        values: one number per trial. tasks: the trial's task. people: the trial's person.
        within: the smallest and the largest possible value.
    """
    if not values:
        return NOTHING
    found = variance_components.two_way_spread(
        np.asarray(values, dtype=np.float64)[None],
        variance_components.group_codes(tasks),
        variance_components.group_codes(people),
    )
    mean = sum(values) / len(values)
    low, high = (float(end[0]) for end in confidence_interval(found, len(values), within))
    mde = float(detectable_difference(found, len(values), within)[0])
    return Estimate(
        mean=round(mean, _DIGITS),
        ci95=(round(min(low, mean), _DIGITS), round(max(high, mean), _DIGITS)) if math.isfinite(high - low) else None,
        n=len(values),
        mde80=round(mde, _DIGITS) if math.isfinite(mde) else None,
    )


def confidence_interval(
    found: variance_components.MeanSpread, count: int, within: Range = ANY
) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper ends of the 95 % intervals of means over ``count`` trials."""
    low, high = within
    quantile = student_quantile(_freedom(found, within), (1.0 + LEVEL) / 2.0)
    if math.isinf(low):
        half = quantile * np.sqrt(found.variance)
        return found.mean - half, found.mean + half
    if math.isinf(high):
        return _above(found, low, quantile)
    share = np.clip((found.mean - low) / (high - low), 0.0, 1.0)
    some = quantile**2 * _inverse_worth(found, count, within)
    centre = (share + some / 2.0) / (1.0 + some)
    half = np.sqrt(some * share * (1.0 - share) + some**2 / 4.0) / (1.0 + some)
    ends = (np.maximum(centre - half, 0.0), np.minimum(centre + half, 1.0))
    return low + (high - low) * ends[0], low + (high - low) * ends[1]


def _above(found: variance_components.MeanSpread, low: float, quantile: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The score interval of an amount with only a lower bound: its variance grows with its mean, like a count's."""
    mean = np.maximum(found.mean - low, 0.0)
    known = np.isfinite(found.variance)
    variance = np.where(known, found.variance, 0.0)
    some = quantile**2 * np.where(mean > 0.0, variance / np.where(mean > 0.0, mean, 1.0), variance)
    half = np.sqrt(some * mean + some**2 / 4.0)
    upper = mean + some / 2.0 + half
    lower = np.where(upper > 0.0, mean**2 / np.where(upper > 0.0, upper, 1.0), 0.0)  # lower * upper = mean ** 2
    return low + np.where(known, lower, 0.0), np.where(known, low + upper, np.inf)


def detectable_difference(found: variance_components.MeanSpread, count: int, within: Range = ANY) -> np.ndarray:
    """The smallest difference from a given number that is detected with the probability `POWER`."""
    low, high = within
    variance = found.variance
    if math.isfinite(high - low):  # all values at a bound: as the interval's width implies
        inner = np.clip((found.mean - low) / (high - low), 1.0 / (count + 2), (count + 1) / (count + 2))
        edge = inner * (1.0 - inner) * (high - low) ** 2 * _inverse_worth(found, count, within)
        variance = np.where(np.isfinite(variance) & (variance > 0.0), variance, edge)
    freedom = _freedom(found, within)
    factor = student_quantile(freedom, (1.0 + LEVEL) / 2.0) + student_quantile(freedom, POWER)
    needed: np.ndarray = factor * np.sqrt(variance)
    return needed


def _freedom(found: variance_components.MeanSpread, within: Range) -> np.ndarray:
    """Degrees of freedom: near a bound, fewer if the few trials that deviate share tasks or people.

    In the middle between the bounds, such unevenness is mostly chance.
    """
    low, high = within
    if not math.isfinite(high - low):
        return found.freedom
    skew = np.clip(2.0 * (found.mean - low) / (high - low) - 1.0, -1.0, 1.0) ** 2
    uneven = np.where(skew > 0.0, found.uneven / np.where(skew > 0.0, skew, 1.0), np.inf)
    least: np.ndarray = np.maximum(np.minimum(found.freedom, uneven), 1.0)
    return least


def _inverse_worth(found: variance_components.MeanSpread, count: int, within: Range) -> np.ndarray:
    """One divided by the number of independent yes-or-no trials that would be as informative as these trials."""
    low, high = within
    most = (found.mean - low) * (high - found.mean)
    plain = np.full_like(found.mean, 1.0 / count)  # all values at a bound: their correlation is unknown
    inside = most > _EDGE * (high - low) ** 2
    worth: np.ndarray = np.where(inside, found.variance / np.where(inside, most, 1.0), plain)
    return np.where(np.isfinite(worth), worth, plain)


def student_quantile(freedom: np.ndarray, level: float) -> np.ndarray:
    """The quantile of Student's t."""
    from scipy import special

    found: np.ndarray = special.stdtrit(freedom, level)
    return found
