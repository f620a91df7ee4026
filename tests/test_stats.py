"""Intervals: they hold the mean, they repeat, and they hold the truth about as often as they say."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hthor.eval import stats

TRUTH = NormalDist().cdf(0.9 / (1.0 + 1.0 + 0.16) ** 0.5)
"""Success rate of `_world`."""


def _names(count: int) -> tuple[list[str], list[int]]:
    return [f"t{number}" for number in range(count)], [number % 6 for number in range(count)]


@settings(max_examples=25)
@given(st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=40))
def test_the_mean_lies_inside_its_interval(values: list[float]):
    found = stats.estimate(values, *_names(len(values)), name="x")
    low, high = found.ci95
    assert low <= found.mean <= high
    assert min(values) - 1e-6 <= low
    assert high <= max(values) + 1e-6


def test_equal_values_leave_no_doubt():
    assert stats.estimate([0.25] * 30, *_names(30), name="x").ci95 == (0.25, 0.25)


def test_nothing_is_nothing():
    assert stats.estimate([], [], [], name="x") == stats.Estimate(mean=None, ci95=None, n=0)


def test_the_same_numbers_give_the_same_interval():
    values = [float(number % 3 == 0) for number in range(60)]
    assert stats.estimate(values, *_names(60), name="x") == stats.estimate(values, *_names(60), name="x")
    assert stats.estimate(values, *_names(60), name="x") != stats.estimate(values, *_names(60), name="y")


def test_names_do_not_matter():
    values = [float(number % 3 == 0) for number in range(60)]
    tasks, people = _names(60)
    renamed = stats.estimate(values, [name[::-1] + "z" for name in tasks], [9 - who for who in people], name="x")
    assert renamed == stats.estimate(values, tasks, people, name="x")


def _world(chance: np.random.Generator, tasks: int, people: int) -> np.ndarray:
    """Successes (tasks, people) where both the task and the person matter."""
    hard, able = chance.normal(0, 1.0, (tasks, 1)), chance.normal(0, 0.4, (1, people))
    return (0.9 + hard + able + chance.normal(0, 1.0, (tasks, people)) > 0).astype(float)


def _coverage(crossed: bool, repeats: int = 120) -> float:
    """How often a 95 % interval holds the true rate."""
    chance = np.random.default_rng(7)
    tasks = np.repeat(np.arange(30), 6) if crossed else np.arange(60)
    people = np.tile(np.arange(6), 30) if crossed else np.arange(60) % 6
    held = 0
    for _ in range(repeats):
        values = _world(chance, 30 if crossed else 60, 6)[tasks, people]
        low, high = np.quantile(stats.bootstrap(values, tasks, people, name="x", draws=300), [0.025, 0.975])
        held += low <= TRUTH <= high
    return held / repeats


@pytest.mark.parametrize("crossed", [True, False], ids=["everyone-does-all", "every-task-once"])
def test_intervals_are_honest(crossed: bool):
    assert _coverage(crossed) >= 0.9


def test_taking_trials_for_independent_would_not_be():
    chance = np.random.default_rng(7)
    held = 0
    for _ in range(120):
        values = _world(chance, 30, 6).ravel()
        half = 1.96 * values.std() / len(values) ** 0.5
        held += abs(values.mean() - TRUTH) <= half
    assert held / 120 < 0.85
