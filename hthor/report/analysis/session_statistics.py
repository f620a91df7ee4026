"""Statistics of time spent and trust in one run."""

import math
from collections.abc import Sequence

import numpy as np

from hthor.eval.metrics import trial_metrics
from hthor.eval.results import estimates
from hthor.report.analysis.document import TimeSpent, TrustCurve
from hthor.report.analysis.load_runs import Run

_DIGITS = 6
_QUARTILES = (0.0, 0.25, 0.5, 0.75, 1.0)


def time_spent(run: Run) -> TimeSpent:
    """Minimum, quartiles and maximum of the time spent, and the share of trials solved by each second."""
    times = trial_metrics.column((record.metrics for record in run.records), "time_s")
    least, lower, median, upper, most = (round(float(value), _DIGITS) for value in np.quantile(times, _QUARTILES))
    unsolved = sum(not record.met for record in run.records)
    ends = np.sort(times[[record.met for record in run.records]])
    seconds = np.arange(math.ceil(max(record.spec.task.time_limit for record in run.records)) + 1)
    solved = np.searchsorted(ends, seconds, side="right") / len(times)
    return TimeSpent(
        arm=run.label,
        trials=len(times),
        least=least,
        lower=lower,
        median=median,
        upper=upper,
        most=most,
        unsolved=unsolved,
        solved=tuple(round(float(share), _DIGITS) for share in solved),
    )


def trust_curve(run: Run) -> TrustCurve | None:
    """Trust by trial of the session; None if nobody rated a robot."""
    rated = [
        (one.spec.session, one.spec.index, value) for one in run.records if (value := one.metrics["trust"]) is not None
    ]
    if not run.plan.seats or not rated:
        return None
    indices = sorted({index for _, index, _ in rated})
    by_trial = [[float(value) for _, index, value in rated if index == wanted] for wanted in indices]
    by_session = [[(index, value) for own, index, value in rated if own == one] for one in _sessions(rated)]
    slopes = [slope for marks in by_session if (slope := _slope(marks)) is not None]
    return TrustCurve(
        arm=run.label,
        trial=tuple(index + 1 for index in indices),
        mean=tuple(round(_mean(values), _DIGITS) for values in by_trial),
        ci95=tuple(one.ci95 for one in estimates.trust_by_trial(run.records) if one.ci95 is not None),
        sessions=tuple(len(values) for values in by_trial),
        slope=round(_mean(slopes), _DIGITS) if len(slopes) > 1 else None,
        slope_se=_error(slopes),
    )


def _sessions(rated: Sequence[tuple[int, int, float]]) -> list[int]:
    return sorted({session for session, _, _ in rated})


def _slope(marks: Sequence[tuple[int, float]]) -> float | None:
    """Least-squares slope of one session's ratings [points per trial]; None if there is only one rating."""
    if len(marks) < 2:
        return None
    x, y = (np.array(values, dtype=float) for values in zip(*marks, strict=True))
    x = x - x.mean()
    return float((x * y).sum() / (x * x).sum())


def _error(values: Sequence[float]) -> float | None:
    """Standard error of the mean; None for fewer than two values."""
    if len(values) < 2:
        return None
    mean = _mean(values)
    return round(math.sqrt(sum((value - mean) ** 2 for value in values) / (len(values) - 1) / len(values)), _DIGITS)


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)
