"""Means with honest intervals; knows nothing of what is averaged."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from msgspec import Struct

from hthor import seeds

DRAWS = 2000
"""Bootstrap draws."""
LEVEL = 0.95
_DIGITS = 6


class Estimate(Struct, frozen=True, kw_only=True):
    """A mean over ``n`` trials and its 95 % interval; None where there is nothing to average."""

    mean: float | None
    ci95: tuple[float, float] | None
    n: int


NOTHING = Estimate(mean=None, ci95=None, n=0)


def estimate(values: Sequence[float], tasks: Sequence[str], people: Sequence[int], *, name: str) -> Estimate:
    """Mean of ``values`` with an interval for new tasks and new people of the same population.

    The two-way "pigeonhole" bootstrap: tasks and people are drawn with replacement, each on its own, and a trial counts
    as often as its task times as often as its person. Trials that share either are not independent, and an interval
    that took them for independent would be too narrow. Where every task was done once, the interval is cautious: in
    simulations of that design it held the truth in 96 to 100 of 100 runs.

    Args:
        values: one number a trial. tasks: the trial's task. people: the trial's person.
        name: of the chance stream; equal names give equal draws.
    """
    if not values:
        return NOTHING
    if min(values) == max(values):  # every sample of it has the same mean
        level = round(values[0], _DIGITS)
        return Estimate(mean=level, ci95=(level, level), n=len(values))
    drawn = bootstrap(np.asarray(values, dtype=np.float64), _codes(tasks), _codes(people), name=name)
    mean = sum(values) / len(values)
    tail = (1.0 - LEVEL) / 2.0
    low, high = np.quantile(drawn, [tail, 1.0 - tail])
    return Estimate(
        mean=round(mean, _DIGITS),
        ci95=(round(min(float(low), mean), _DIGITS), round(max(float(high), mean), _DIGITS)),
        n=len(values),
    )


def bootstrap(
    values: np.ndarray, tasks: np.ndarray, people: np.ndarray, *, name: str, draws: int = DRAWS
) -> np.ndarray:
    """Means (at most ``draws``,) of pigeonhole samples.

    Args:
        values: (N,) float64. tasks: (N,) indices from 0. people: (N,) indices from 0.
    """
    chance = np.random.Generator(np.random.Philox(key=seeds.derive(0, "bootstrap", name)))
    sums, weights = np.zeros(draws), np.zeros(draws)
    of_task = _counts(chance, int(tasks.max()) + 1, draws)
    of_person = _counts(chance, int(people.max()) + 1, draws)
    for value, task, person in zip(values.tolist(), tasks.tolist(), people.tolist(), strict=True):
        weight = of_task[task] * of_person[person]
        weights += weight
        sums += weight * value
    held = weights > 0.0  # a sample can miss every trial where few tasks met few people
    means: np.ndarray = sums[held] / weights[held]
    return means if means.size else np.full(1, values.mean())


def _counts(chance: np.random.Generator, sort: int, draws: int) -> np.ndarray:
    """How often each of ``sort`` things is drawn, (sort, draws)."""
    return np.ascontiguousarray(chance.multinomial(sort, np.full(sort, 1.0 / sort), size=draws).T.astype(np.float64))


def _codes(names: Sequence[object]) -> np.ndarray:
    """Each name's index among the distinct names in order of first appearance."""
    index: dict[object, int] = {}
    return np.array([index.setdefault(name, len(index)) for name in names], dtype=np.int64)
