"""What an emulator is asked of a trial, as yes-or-no questions, and how rates follow from the answers. A mean is the
integral of chances to exceed a level, so chances of levels are enough for means, spreads and quantiles, and networks
learn from all levels at once.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hthor import rules
from hthor.calibration.simulation import trial_table as tables
from hthor.calibration.simulation.trial_table import CONDITIONS, Table

Array = np.ndarray[Any, Any]

WORTHS = tuple(np.round(np.arange(0.1, 1.01, 0.1), 1).tolist())
"""Levels of s T*/max(T*, T) that a trial may reach."""
WORTHY = 1 + len(WORTHS)
"""How many of the questions are about success and worth."""
SECONDS = tuple(np.arange(10.0, rules.TIME_LIMIT_S, 5.0).tolist())
"""Times [s] at which a trial may still last."""
HEARD = (15.0, 30.0, 45.0, 60.0)
"""Times [s] by which a message may have come, or have been confirmed."""


def inputs(points: Array, condition: Array | int) -> Array:
    """(N, P + 3) what a network is told of trials: the point, from -1 to 1, and which condition it is."""
    chosen = np.eye(len(CONDITIONS))[np.broadcast_to(condition, len(points))]
    return np.column_stack([2.0 * points - 1.0, 2.0 * chosen - 0.7])


def doing(table: Table, least: Array) -> Array:
    """(N, 1 + levels + times) met, worth at least each level, not done at each time. ``least`` is T* [s] by task."""
    worth, spent = tables.twsr(table, least), tables.seconds(table)
    reached = worth[:, None] >= np.array(WORTHS) - 1e-9
    return np.column_stack([table.met, reached, spent[:, None] > np.array(SECONDS)])


def listening(table: Table) -> Array:
    """(N, 2 + 2 times) whether a message was confirmed, or sent at all; and each by each time."""
    by = np.array(HEARD) / rules.TICK_S
    confirmed, sent = table.confirmed[:, None], table.sent[:, None]
    early = (confirmed >= 0) & (confirmed <= by), (sent >= 0) & (sent <= by)
    return np.column_stack([table.adopted, table.sent >= 0, *early])


def rates(answers: Array) -> tuple[Array, Array, Array]:
    """(N,) SR, ratio TWSR / SR, and its sd between successes.

    Args:
        answers: (N, ...) chances of what `doing` asks, at least the first `WORTHY` of them.
    """
    met, reached = answers[:, 0], answers[:, 1:WORTHY]
    levels = np.array([0.0, *WORTHS])
    chance = np.minimum.accumulate(np.column_stack([met, np.minimum(reached, met[:, None])]), axis=1)
    middle = (chance[:, 1:] + chance[:, :-1]) / 2.0
    safe = np.maximum(met, 1e-6)
    mean = np.minimum((middle * np.diff(levels)).sum(axis=1) / safe, 1.0)
    square = (middle * np.diff(levels**2)).sum(axis=1) / safe
    return met, mean, np.sqrt(np.maximum(square - mean**2, 1e-4))


def quartiles(answers: Array, shares: tuple[float, ...]) -> Array:
    """(N, len(shares)) quantiles of time spent [s], the time limit where the task is not done by then.

    Args:
        answers: (N, ...) chances of what `doing` asks.
    """
    met, lasts = answers[:, 0], answers[:, WORTHY:]
    times = np.array([0.0, *SECONDS, rules.TIME_LIMIT_S])
    done = np.column_stack([np.zeros(len(met)), 1.0 - lasts, met])
    done = np.maximum.accumulate(done, axis=1)
    return np.array([[_time(row, times, share) for share in shares] for row in done])


def _time(done: Array, times: Array, share: float) -> float:
    if share >= done[-1]:
        return float(times[-1])
    after = int(np.searchsorted(done, share, side="right"))
    part = (share - done[after - 1]) / (done[after] - done[after - 1])
    return float(times[after - 1] + part * (times[after] - times[after - 1]))
