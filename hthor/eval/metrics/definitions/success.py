"""Success, success weighted by time, and progress."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hthor.eval.metrics.definitions import time_spent
from hthor.eval.metrics.metric import HIGHER, SHARE, SHARES, Metric, Trial


def success(trial: Trial) -> int:
    """1 when the goal was met in time, else 0 (P)."""
    return int(trial.log.met)


def time_weighted_success(trial: Trial) -> float:
    """s · T* / max(T*, T): success, weighted by how close the time spent T came to the time T* (P)."""
    spent = np.array([time_spent.time_spent(trial)])
    return float(time_weighted(np.array([trial.log.met]), np.array([trial.spec.task.t_star]), spent)[0])


def time_weighted(
    met: NDArray[np.bool_], t_star: NDArray[np.float64], spent: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Time-weighted success of trials, (N,): T* / max(T*, T), 0 after a failure, 1 where both times are 0.

    Args:
        met: whether the goal was met. t_star: T* [s]. spent: the time spent T [s].
    """
    longest = np.maximum(t_star, spent)
    share = np.divide(t_star, longest, out=np.ones_like(longest), where=longest > 0.0)
    return np.where(met, share, 0.0)


def progress(trial: Trial) -> float | None:
    """Share of the goal that was met in the end; 1 after a success. Only for kinds of task that count parts."""
    return trial.log.progress


METRICS = (
    Metric(
        name="sr",
        title="success rate",
        short="success",
        abbreviation="SR",
        formula=success,
        unit=SHARE,
        better=HIGHER,
        rank=10,
        main=True,
        bounds=SHARES,
    ),
    Metric(
        name="twsr",
        title="time-weighted success",
        short="time-weighted",
        abbreviation="TWSR",
        formula=time_weighted_success,
        unit=SHARE,
        better=HIGHER,
        rank=20,
        main=True,
        bounds=SHARES,
    ),
    Metric(
        name="progress",
        title="progress",
        formula=progress,
        unit=SHARE,
        better=HIGHER,
        rank=30,
        main=True,
        optional=True,
        bounds=SHARES,
    ),
)
