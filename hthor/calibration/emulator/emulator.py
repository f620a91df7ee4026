"""Predicts what people do without simulating them: rates of every condition at any point of the prior.

It is trained on single trials and averages over people, tasks and the order of trials because these are not among its
inputs: sessions are assigned evenly, so nothing is lost by it except precision. The mean of an ensemble's members is
the prediction; how far they disagree says how good it is, up to a factor that is estimated on studies that no member
has seen (`hthor.calibration.inference.design_effects`).
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from msgspec import Struct

from hthor.calibration.emulator import ensemble, outcomes
from hthor.calibration.emulator.ensemble import MEMBERS
from hthor.calibration.emulator.mlp import Network
from hthor.calibration.emulator.single_thread import single_thread
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import CONDITIONS

Array = np.ndarray[Any, Any]

_CHUNK = 50_000


class Rates(Struct, frozen=True, kw_only=True, eq=False):
    """What to expect at N points, float64 arrays (N, 3) by condition; adoption without a robot is 0.

    Attributes:
        sr: chance of success. ratio: mean of T*/max(T*, T) over successes. ratio_sd: its spread between successes.
        adoption: chance that a robot's message is accepted.
        sr_se, ratio_se, adoption_se: how far the ensemble disagrees, sd of a member's prediction.
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
        """What to expect of the populations at points (N, P) of the unit cube."""
        with single_thread():
            return join_rates([self._rates(chunk) for chunk in _chunks(points)])

    def _rates(self, points: Array) -> Rates:
        columns: dict[str, list[Array]] = {name: [] for name in Rates.__struct_fields__}
        for number, condition in enumerate(CONDITIONS):
            inputs = outcomes.network_inputs(points, number)
            members = [outcomes.success_rates(member(inputs, outcomes.SUCCESS_QUESTIONS)) for member in self.success]
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
    """An emulator of the trials of a table. Points of any density will do: it learns what follows from a point.

    Args:
        table: sessions; each should have a point of its own.
        t_star: T* [s] by task.
        seed: of the networks.

    Raises:
        MissingExtra: without scikit-learn.
        ValueError: with fewer than two members, or fewer points than members.
    """
    if members < 2 or len(np.unique(table.point)) < members:
        raise ValueError(f"an ensemble needs two members and a point for each, got {members} members")
    inputs = outcomes.network_inputs(table.unit(), table.condition)
    robots, width = table.condition > 0, len(table.names)
    success, messages = outcomes.success_outcomes(table, t_star), outcomes.message_outcomes(table)[robots]
    return Emulator(
        names=table.names,
        success=ensemble.fit_ensemble(inputs, success, table.point, width, seed, "doing", members),
        messages=ensemble.fit_ensemble(
            inputs[robots], messages, table.point[robots], width, seed, "listening", members
        ),
    )


def join_rates(parts: list[Rates]) -> Rates:
    """The rates at the points of all parts, one after the other."""
    return Rates(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in Rates.__struct_fields__})


def _chunks(points: Array) -> Iterator[Array]:
    for at in range(0, max(1, len(points)), _CHUNK):
        yield points[at : at + _CHUNK]
