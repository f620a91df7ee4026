"""The least and the greatest value that each metric can have."""

from __future__ import annotations

import math
from collections.abc import Sequence

from hthor import rules

Range = tuple[float, float]
AMOUNT: Range = (0.0, math.inf)
"""The range of whatever is counted and has no bound above."""
_SHARES = ("sr", "twsr", "adoption", "progress", "precision", "usefulness", "work")
_TIMES = ("time_s", "idle_s", "hindered_s", "hindered_by", "first_useful_s")
"""Metrics in seconds of a trial, which ends at its time limit."""


def of(metric: str, limit_s: float | None = None) -> Range:
    """The range of a mean of ``metric``.

    Args:
        limit_s: the mean time limit [s] of the trials; without it a time has no bound above.
    """
    if metric in _SHARES:
        return (0.0, 1.0)
    if metric == "trust":
        return (float(rules.TRUST_MIN), float(rules.TRUST_MAX))
    return (0.0, limit_s) if metric in _TIMES and limit_s is not None else AMOUNT


def among(metric: str, values: Sequence[float], limits: Sequence[float]) -> Range:
    """The range of the mean of these values of ``metric``, for the time limits [s] of their trials."""
    kept = all(value <= limit for value, limit in zip(values, limits, strict=True))
    return of(metric, mean_limit(limits) if kept and limits else None)


def mean_limit(limits: Sequence[float]) -> float:
    """The mean of time limits [s]; exact where all are equal."""
    return limits[0] if len(set(limits)) == 1 else math.fsum(limits) / len(limits)


def room(metric: str, limit_s: float | None = None) -> float:
    """How far apart two means of ``metric`` can be at most; infinite where there is no bound."""
    low, high = of(metric, limit_s)
    return high - low
