"""Foretells what people do without simulating them: rates of every condition at any point of the prior. It is trained
on single trials and averages over people, tasks and the order of trials by not being told of them: sessions are
dealt evenly, so that nothing is lost by it but noise.

The mean of a committee's members foretells; how far they disagree says how well, up to a factor that is found on
studies that no member has seen (`hthor.calibration.inference.design_effects`).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from msgspec import Struct

from hthor.calibration.emulator import ensemble, outcomes
from hthor.calibration.emulator.ensemble import MEMBERS
from hthor.calibration.emulator.mlp import Network
from hthor.calibration.emulator.single_thread import alone
from hthor.calibration.simulation.trial_table import CONDITIONS, Table

Array = np.ndarray[Any, Any]

_CHUNK = 50_000


class Rates(Struct, frozen=True, kw_only=True, eq=False):
    """What to expect at N points, float64 arrays (N, 3) by condition; adoption without a robot is 0.

    Attributes:
        sr: chance of success. ratio: mean of T*/max(T*, T) over successes. ratio_sd: its spread between successes.
        adoption: chance that a robot's message is confirmed.
        sr_se, ratio_se, adoption_se: how far the committee disagrees, sd of a member's answer.
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

    def take(self, rows: Array) -> Rates:
        """The same at some of the points."""
        return Rates(**{name: getattr(self, name)[rows] for name in self.__struct_fields__})


class Emulator(Struct, frozen=True, kw_only=True, eq=False):
    """Committees of networks: ``doing`` for success and time, ``listening`` for messages.

    ``names`` are the parameters of the points; ``trials`` and ``sessions`` what it was trained on.
    """

    names: tuple[str, ...]
    doing: tuple[Network, ...]
    listening: tuple[Network, ...]
    trials: int
    sessions: int

    def rates(self, points: Array) -> Rates:
        """What to expect of the populations at points (N, P) of the unit cube."""
        with alone():
            parts = [self._rates(chunk) for chunk in _chunks(points)]
        return Rates(**{name: np.concatenate([getattr(p, name) for p in parts]) for name in Rates.__struct_fields__})

    def _rates(self, points: Array) -> Rates:
        columns: dict[str, list[Array]] = {name: [] for name in Rates.__struct_fields__}
        for place, condition in enumerate(CONDITIONS):
            told = outcomes.inputs(points, place)
            done = [outcomes.rates(member(told, outcomes.WORTHY)) for member in self.doing]
            sr, ratio, spread = (np.array(part) for part in zip(*done, strict=True))
            alone = condition == CONDITIONS[0]
            heard = [np.zeros(len(points)) if alone else member(told, 1)[:, 0] for member in self.listening]
            adoption = np.array(heard)
            for name, members in (("sr", sr), ("ratio", ratio), ("adoption", adoption)):
                columns[name].append(members.mean(axis=0))
                columns[f"{name}_se"].append(members.std(axis=0, ddof=1))
            columns["ratio_sd"].append(spread.mean(axis=0))
        return Rates(**{name: np.stack(parts, axis=1) for name, parts in columns.items()})

    def quartiles(self, points: Array, shares: tuple[float, ...] = (0.25, 0.5, 0.75)) -> Array:
        """(N, 3, len(shares)) quantiles of the time spent on a trial [s]; a failure takes the whole time limit."""
        found = []
        for place in range(len(CONDITIONS)):
            told = outcomes.inputs(points, place)
            with alone():
                answers = np.mean([member(told) for member in self.doing], axis=0)
            found.append(outcomes.quartiles(answers, shares))
        return np.stack(found, axis=1)


def fit(table: Table, least: Array, seed: int = 0, members: int = MEMBERS) -> Emulator:
    """An emulator of the trials of a table. Points of any density will do: it learns what follows from a point.

    Args:
        table: sessions; each should have a point of its own.
        least: T* [s] by task.
        seed: of the networks.

    Raises:
        MissingExtra: without scikit-learn.
        ValueError: with fewer than two members, or fewer points than members.
    """
    if members < 2 or len(np.unique(table.point)) < members:
        raise ValueError(f"a committee needs two members and a point for each, got {members} members")
    told = outcomes.inputs(table.unit(), table.condition)
    robots, width = table.condition > 0, len(table.names)
    return Emulator(
        names=table.names,
        doing=ensemble.fit(told, outcomes.doing(table, least), table.point, width, seed, "doing", members),
        listening=ensemble.fit(
            told[robots], outcomes.listening(table)[robots], table.point[robots], width, seed, "listening", members
        ),
        trials=len(table),
        sessions=len(np.unique(np.column_stack([table.study, table.session, table.point]), axis=0)),
    )


def _chunks(points: Array) -> Iterator[Array]:
    for at in range(0, max(1, len(points)), _CHUNK):
        yield points[at : at + _CHUNK]
