"""Predicts without simulation what people do: rates of every condition at any point of the prior.

It is trained on single trials. It averages over people, tasks and the order of trials, because these are not among its
inputs; sessions are assigned evenly, so this loses only precision. The mean of an ensemble's members is the prediction;
their disagreement shows its precision, up to a factor that is estimated on studies that no member has seen
(`hthor.calibration.inference.design_effects`).
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import rules
from hthor.calibration.emulator import mlp
from hthor.calibration.emulator.mlp import MEMBERS, Network, single_thread
from hthor.calibration.simulation import trial_table as tables
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import CONDITIONS

Array = np.ndarray[Any, Any]

_CHUNK = 50_000
TWSR_LEVELS = tuple(np.round(np.arange(0.1, 1.01, 0.1), 1).tolist())
"""Levels of time-weighted success that a trial may reach; one outcome each."""
SUCCESS_QUESTIONS = 1 + len(TWSR_LEVELS)
"""Number of outcomes about success and time-weighted success."""
TIME_LEVELS_S = tuple(np.arange(10.0, rules.TIME_LIMIT_S, 5.0).tolist())
"""Times [s] at which a trial may still go on."""
MESSAGE_LEVELS_S = (15.0, 30.0, 45.0, 60.0)
"""Times [s] by which a message may have been sent or accepted."""


class Rates(Struct, frozen=True, kw_only=True, eq=False):
    """Expected rates at N points, float64 arrays (N, 3) by condition; adoption without a robot is 0.

    ``ratio`` is the mean of T*/max(T*, T) over successes, ``ratio_sd`` its sd over successes, ``adoption`` the
    probability that a message is accepted; ``_se`` is the ensemble's disagreement, the sd of a member's prediction.
    """

    sr: Array
    ratio: Array
    ratio_sd: Array
    adoption: Array
    sr_se: Array
    ratio_se: Array
    adoption_se: Array

    def __len__(self) -> int:
        return len(self.sr)

    @property
    def twsr(self) -> Array:
        """(N, 3) success weighted by time."""
        return self.sr * self.ratio


class Emulator(Struct, frozen=True, kw_only=True, eq=False):
    """Ensembles of networks: ``success`` for success and time, ``messages`` for adoption; ``names`` are parameters."""

    names: tuple[str, ...]
    success: tuple[Network, ...]
    messages: tuple[Network, ...]

    def rates(self, points: Array) -> Rates:
        """The expected rates of the populations at points (N, P) of the unit cube."""
        with single_thread():
            return join_rates([self._rates(chunk) for chunk in _chunks(points)])

    def _rates(self, points: Array) -> Rates:
        columns: dict[str, list[Array]] = {name: [] for name in Rates.__struct_fields__}
        for number, condition in enumerate(CONDITIONS):
            inputs = network_inputs(points, number)
            members = [success_rates(member(inputs, SUCCESS_QUESTIONS)) for member in self.success]
            sr, ratio, spread = (np.array(part) for part in zip(*members, strict=True))
            if condition == CONDITIONS[0]:
                adoption = np.zeros((len(self.messages), len(points)))
            else:
                adoption = np.array([member(inputs, 1)[:, 0] for member in self.messages])
            for name, predictions in (("sr", sr), ("ratio", ratio), ("adoption", adoption)):
                columns[name].append(predictions.mean(axis=0))
                columns[f"{name}_se"].append(predictions.std(axis=0, ddof=1))
            columns["ratio_sd"].append(spread.mean(axis=0))
        return Rates(**{name: np.stack(parts, axis=1) for name, parts in columns.items()})


def fit_emulator(table: Table, t_star: Array, seed: int = 0, members: int = MEMBERS) -> Emulator:
    """An emulator fitted to the trials of a table. The points may have any density in the prior.

    Args:
        table: sessions, preferably each at a different point.
        t_star: T* [s] by task.
        seed: seed of the networks.

    Raises:
        MissingExtra: without scikit-learn.
        ValueError: with fewer than two members, or fewer points than members.
    """
    if members < 2 or len(np.unique(table.point)) < members:
        raise ValueError(f"an ensemble needs two members and a point for each, got {members} members")
    inputs = network_inputs(table.unit(), table.condition)
    robots, width = table.condition > 0, len(table.names)
    success, messages = success_outcomes(table, t_star), message_outcomes(table)[robots]
    return Emulator(
        names=table.names,
        success=mlp.fit_ensemble(inputs, success, table.point, width, seed, "doing", members),
        messages=mlp.fit_ensemble(inputs[robots], messages, table.point[robots], width, seed, "listening", members),
    )


def join_rates(parts: list[Rates]) -> Rates:
    """The rates at the points of all parts, one after the other."""
    return Rates(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in Rates.__struct_fields__})


def _chunks(points: Array) -> Iterator[Array]:
    for at in range(0, max(1, len(points)), _CHUNK):
        yield points[at : at + _CHUNK]


def network_inputs(points: Array, condition: Array | int) -> Array:
    """(N, P + 3) a network's inputs for trials: the point, from -1 to 1, and the condition as indicators."""
    chosen = np.eye(len(CONDITIONS))[np.broadcast_to(condition, len(points))]
    return np.column_stack([2.0 * points - 1.0, 2.0 * chosen - 0.7])


def success_outcomes(table: Table, t_star: Array) -> Array:
    """(N, 1 + levels + times) goal met, TWSR at least each level, still going at each time; T* [s] by task."""
    twsr, spent = tables.twsr(table, t_star), tables.time_spent_s(table)
    reached = twsr[:, None] >= np.array(TWSR_LEVELS) - 1e-9
    return np.column_stack([table.met, reached, spent[:, None] > np.array(TIME_LEVELS_S)])


def message_outcomes(table: Table) -> Array:
    """(N, 2 + 2 times) whether a message was accepted, and sent, in the whole trial and by each time."""
    by = np.array(MESSAGE_LEVELS_S) / rules.TICK_S
    accepted, sent = table.accepted[:, None], table.sent[:, None]
    early = (accepted >= 0) & (accepted <= by), (sent >= 0) & (sent <= by)
    return np.column_stack([table.adopted, table.sent >= 0, *early])


def success_rates(answers: Array) -> tuple[Array, Array, Array]:
    """(N,) SR, ratio TWSR / SR, and its sd between successes, from the answers (N, ...) to `success_outcomes`."""
    met, reached = answers[:, 0], answers[:, 1:SUCCESS_QUESTIONS]
    levels = np.array([0.0, *TWSR_LEVELS])
    chance = np.minimum.accumulate(np.column_stack([met, np.minimum(reached, met[:, None])]), axis=1)
    middle = (chance[:, 1:] + chance[:, :-1]) / 2.0
    safe = np.maximum(met, 1e-6)
    mean = np.minimum((middle * np.diff(levels)).sum(axis=1) / safe, 1.0)
    square = (middle * np.diff(levels**2)).sum(axis=1) / safe
    return met, mean, np.sqrt(np.maximum(square - mean**2, 1e-4))
