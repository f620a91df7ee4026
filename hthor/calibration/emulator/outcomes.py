"""The yes-or-no questions that an emulator answers about a trial, and how rates follow from the answers.

A mean is the integral of chances to exceed a level, so chances of levels are enough for means and spreads, and networks
learn from all levels at once.
"""

from typing import Any

import numpy as np

from hthor import rules
from hthor.calibration.simulation import trial_table as tables
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import CONDITIONS

Array = np.ndarray[Any, Any]

TWSR_LEVELS = tuple(np.round(np.arange(0.1, 1.01, 0.1), 1).tolist())
"""Levels of time-weighted success that a trial may reach."""
SUCCESS_QUESTIONS = 1 + len(TWSR_LEVELS)
"""How many of the questions are about success and time-weighted success."""
TIME_LEVELS_S = tuple(np.arange(10.0, rules.TIME_LIMIT_S, 5.0).tolist())
"""Times [s] at which a trial may still last."""
MESSAGE_LEVELS_S = (15.0, 30.0, 45.0, 60.0)
"""Times [s] by which a message may have been sent or accepted."""


def network_inputs(points: Array, condition: Array | int) -> Array:
    """(N, P + 3) a network's inputs for trials: the point, from -1 to 1, and which condition it is."""
    chosen = np.eye(len(CONDITIONS))[np.broadcast_to(condition, len(points))]
    return np.column_stack([2.0 * points - 1.0, 2.0 * chosen - 0.7])


def success_outcomes(table: Table, t_star: Array) -> Array:
    """(N, 1 + levels + times) met, TWSR at least each level, not done at each time. ``t_star`` is T* [s] by task."""
    twsr, spent = tables.twsr(table, t_star), tables.time_spent_s(table)
    reached = twsr[:, None] >= np.array(TWSR_LEVELS) - 1e-9
    return np.column_stack([table.met, reached, spent[:, None] > np.array(TIME_LEVELS_S)])


def message_outcomes(table: Table) -> Array:
    """(N, 2 + 2 times) whether a message was accepted, or sent at all; and each of the two by each time."""
    by = np.array(MESSAGE_LEVELS_S) / rules.TICK_S
    confirmed, sent = table.confirmed[:, None], table.sent[:, None]
    early = (confirmed >= 0) & (confirmed <= by), (sent >= 0) & (sent <= by)
    return np.column_stack([table.adopted, table.sent >= 0, *early])


def success_rates(answers: Array) -> tuple[Array, Array, Array]:
    """(N,) SR, ratio TWSR / SR, and its sd between successes.

    Args:
        answers: (N, ...) answers to `success_outcomes`, at least the first `SUCCESS_QUESTIONS` of them.
    """
    met, reached = answers[:, 0], answers[:, 1:SUCCESS_QUESTIONS]
    levels = np.array([0.0, *TWSR_LEVELS])
    chance = np.minimum.accumulate(np.column_stack([met, np.minimum(reached, met[:, None])]), axis=1)
    middle = (chance[:, 1:] + chance[:, :-1]) / 2.0
    safe = np.maximum(met, 1e-6)
    mean = np.minimum((middle * np.diff(levels)).sum(axis=1) / safe, 1.0)
    square = (middle * np.diff(levels**2)).sum(axis=1) / safe
    return met, mean, np.sqrt(np.maximum(square - mean**2, 1e-4))
