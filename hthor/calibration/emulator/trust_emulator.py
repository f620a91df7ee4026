"""How trust goes over a session, by robot, at any point of the prior.

The mean report after each trial is foretold by a committee of networks, like rates. How much people differ around it,
and how alike one person's reports are, is the covariance of what is left over in people whom a network has not seen, so
that the curve of a few raters, which is what a study shows, can be drawn with its noise.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from msgspec import Struct

from hthor import rules, seeds
from hthor.calibration.emulator import ensemble, outcomes
from hthor.calibration.emulator.ensemble import MEMBERS
from hthor.calibration.emulator.mlp import Network
from hthor.calibration.emulator.single_thread import alone
from hthor.calibration.simulation.trial_table import CONDITIONS, Table

Array = np.ndarray[Any, Any]

ROBOTS = CONDITIONS[1:]
"""Conditions in which trust is asked for."""
EPOCHS = 8
"""Passes over the reports: few, as the ten reports of one person are much alike and easily learnt by heart."""
RATERS = 6
"""People that rate each robot in the published study."""
_NOISE = 128
_PRACTICE = 3.0
"""Trials in which most of the change happens, as one of the inputs sees it."""


class TrustCurve(Struct, frozen=True, kw_only=True, eq=False):
    """Networks for P(report > 1), ..., P(report > 6); ``covariance`` (2, 10, 10) of one person's reports, by robot."""

    members: tuple[Network, ...]
    covariance: Array

    def mean(self, points: Array) -> Array:
        """(N, 2, 10) mean report from 1 to 7, by robot (`ROBOTS`) and trial."""
        found = np.zeros((len(points), len(ROBOTS), rules.SESSION_TASKS))
        for robot in range(len(ROBOTS)):
            for index in range(rules.SESSION_TASKS):
                told = _inputs(points, np.full(len(points), robot + 1), np.full(len(points), index))
                with alone():
                    above = np.mean([member(told) for member in self.members], axis=0)
                found[:, robot, index] = rules.TRUST_MIN + above.sum(axis=1)
        return found

    def group(self, points: Array, raters: int = RATERS, seed: int = 0) -> Array:
        """(N, 2, 10) mean report of a group of raters for each robot, drawn with its noise."""
        mean = self.mean(points)
        chance = np.random.Generator(np.random.Philox(seeds.derive(seed, "raters")))
        return mean + self._noise(len(points), raters, chance)

    def events(self, points: Array, raters: int = RATERS, seed: int = 0) -> Array:
        """(N, 2) chances that such groups trust the oracle more after every trial, and that its curve rises.

        A curve rises when the least-squares slope over the session is positive. Means of whole reports of a few raters
        are often equal: a gap counts from half a step on.
        """
        chance = np.random.Generator(np.random.Philox(seeds.derive(seed, "events")))
        noise, mean = self._noise(_NOISE, raters, chance), self.mean(points)
        gap = (mean[:, 1] - mean[:, 0])[:, None] + (noise[:, 1] - noise[:, 0])[None]
        index = np.arange(rules.SESSION_TASKS) - (rules.SESSION_TASKS - 1) / 2.0
        slope = (mean[:, 1] @ index)[:, None] + (noise[:, 1] @ index)[None]
        return np.stack([(gap > 0.5 / raters).all(axis=2).mean(axis=1), (slope > 0.0).mean(axis=1)], axis=1)

    def _noise(self, count: int, raters: int, chance: np.random.Generator) -> Array:
        """(count, 2, 10) what chance adds to the mean of so many raters."""
        parts = [
            chance.standard_normal((count, rules.SESSION_TASKS)) @ np.linalg.cholesky(covariance / raters).T
            for covariance in self.covariance
        ]
        return np.stack(parts, axis=1)


def fit(table: Table, seed: int = 0, members: int = MEMBERS) -> TrustCurve:
    """Learn trust from the trials of a table in which it was asked for; whole sessions of ten trials.

    Raises:
        MissingExtra: without scikit-learn.
        ValueError: when no session of ten trials has trust in each robot.
    """
    held = table.take(table.trust > 0)
    told = _inputs(held.unit(), held.condition, held.index)
    above = held.trust[:, None] > np.arange(rules.TRUST_MIN, rules.TRUST_MAX)
    nets = ensemble.fit(told, above, held.point, len(table.names), seed, "trust", members, EPOCHS)
    rows, chance = ensemble.unseen(nets, told, held.point, seed)
    left = np.full(len(held), np.nan)
    left[rows] = held.trust[rows] - rules.TRUST_MIN - chance.sum(axis=1)
    covariance = [_covariance(held, left, robot) for robot in range(1, len(CONDITIONS))]
    return TrustCurve(members=nets, covariance=np.stack(covariance))


def reports(table: Table) -> Array:
    """(S, 2, 10) mean reports of the raters of each simulated study, by robot and trial; NaN where nobody was asked."""
    numbers, study = np.unique(table.study, return_inverse=True)
    total, count = np.zeros((2, len(numbers), len(CONDITIONS), rules.SESSION_TASKS))
    asked = table.trust > 0
    where = (study[asked], table.condition[asked], table.index[asked])
    np.add.at(total, where, table.trust[asked])
    np.add.at(count, where, 1.0)
    with np.errstate(invalid="ignore"):
        found: Array = (total / count)[:, 1:]
    return found


def _inputs(points: Array, condition: Array, index: Array) -> Array:
    late = 1.0 - np.exp(-index / _PRACTICE)
    return np.column_stack([outcomes.inputs(points, condition), 2.0 * late - 1.0, index / rules.SESSION_TASKS - 0.5])


def _covariance(held: Table, left: Array, robot: int) -> Array:
    """(10, 10) of what is left over of one person's ten reports, a little towards independent ones."""
    key = np.column_stack([held.study, held.point, held.session])
    _, person = np.unique(key, axis=0, return_inverse=True)
    rows = np.full((person.max() + 1, rules.SESSION_TASKS), np.nan)
    mine = held.condition == robot
    rows[person[mine], held.index[mine]] = left[mine]
    whole = rows[np.isfinite(rows).all(axis=1)]
    if len(whole) < 2:
        raise ValueError(
            f"trust needs whole sessions of {rules.SESSION_TASKS} trials with the {CONDITIONS[robot]} robot"
        )
    found: Array = np.cov(whole.T)
    return 0.99 * found + 0.01 * np.diag(np.diag(found)) + 1e-6 * np.eye(len(found))
