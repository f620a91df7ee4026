"""Success, success weighted by time, and progress."""

import functools

import numpy as np
from numpy.typing import NDArray

from hthor.eval.metrics.definitions import time_spent
from hthor.eval.metrics.metric import HIGHER, SHARE, Metric, Trial


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


_share = functools.partial(Metric, unit=SHARE, better=HIGHER, main=True)

METRICS = (
    _share("sr", "success rate", success, short="success", abbreviation="SR", rank=10),
    _share("twsr", "time-weighted success", time_weighted_success, short="time-weighted", abbreviation="TWSR", rank=20),
    _share("progress", "progress", progress, rank=30, optional=True),
)
