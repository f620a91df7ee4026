"""What was measured of one person, with an interval, or why it was not; and the intervals of plain estimators."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from msgspec import Struct

LEVEL = 0.9
"""Every interval contains the person's own value in so many of such sessions, if the model of people is right."""
_TAILS = ((1.0 - LEVEL) / 2.0, (1.0 + LEVEL) / 2.0)

Bound = Literal["", "at least", "at most"]


class Measure(Struct, frozen=True, kw_only=True):
    """One number of a person, in its own unit.

    Attributes:
        value: None if it is not known; ``unknown`` says why not then. low, high: the interval of `LEVEL`.
        bound: whether the value is only a bound, as the page or the body allows no more.
        n: how many data it was made from. how: from what, in words.
    """

    name: str
    unit: str
    value: float | None = None
    low: float = math.nan
    high: float = math.nan
    bound: Bound = ""
    n: int = 0
    how: str = ""
    unknown: str = ""


def unknown(name: str, unit: str, reason: str) -> Measure:
    """A number that is not known, for a reason."""
    return Measure(name=name, unit=unit, unknown=reason)


def typical(values: Sequence[float], *, error: float = 0.0) -> tuple[float, float, float]:
    """The geometric mean of positive values and its interval, by Student's distribution of their logarithms.

    Args:
        values: two or more. error: a relative error that all of them have in common.
    """
    from scipy.stats import t

    logs = np.log(values)
    spread = math.hypot(float(np.std(logs, ddof=1)) / math.sqrt(len(logs)), error)
    middle, reach = float(np.mean(logs)), float(t.ppf(_TAILS[1], len(logs) - 1)) * spread
    return math.exp(middle), math.exp(middle - reach), math.exp(middle + reach)


def lowest(value: float, *, error: float) -> float:
    """The lower end of the interval of a positive number that was measured as ``value``, with this relative error."""
    from scipy.stats import norm

    return value * math.exp(-float(norm.ppf(_TAILS[1])) * error)


def middle(values: Sequence[float], *, error: float = 0.0) -> tuple[float, float, float]:
    """The median of positive values, of which some are wrong, and its interval by the ranks of the values.

    Args:
        values: five or more.
        error: a relative error that all of them have in common.
    """
    from scipy.stats import binom

    order = np.sort(np.asarray(values, dtype=float))
    rank = int(binom.ppf(_TAILS[0], len(order), 0.5))
    last = max(rank - 1, 0)
    return float(np.median(order)), float(order[last]) * (1.0 - error), float(order[-1 - last]) * (1.0 + error)


def share(hits: int, count: int) -> tuple[float, float, float]:
    """The share of hits and its interval by Jeffreys' prior, which ends at 0 or 1 where there was nothing else."""
    from scipy.stats import beta

    low, high = (float(beta.ppf(tail, hits + 0.5, count - hits + 0.5)) for tail in _TAILS)
    return hits / count, 0.0 if hits == 0 else low, 1.0 if hits == count else high


def weighted(values: Any, log_weights: Any) -> tuple[float, float, float]:
    """The median of values (N,) and their interval, weighted by the exponentials of some logarithms (N,)."""
    at, logs = np.asarray(values, dtype=float), np.asarray(log_weights, dtype=float)
    weight = np.exp(logs - logs.max())
    order = np.argsort(at)
    cumulated = np.cumsum(weight[order]) - 0.5 * weight[order]
    low, middle, high = np.interp((_TAILS[0], 0.5, _TAILS[1]), cumulated / weight.sum(), at[order])
    return float(middle), float(low), float(high)
