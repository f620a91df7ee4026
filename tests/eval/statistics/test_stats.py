"""Intervals: they hold the mean, they repeat, and they hold the truth about as often as they say."""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor.eval.results import paired_difference
from hthor.eval.statistics import intervals, variance_components

NORMAL = NormalDist()
TASK_SD, PERSON_SD = 1.0, 0.4
"""How much tasks and people differ, beside a single trial's noise of 1, before the threshold of success."""


def _names(count: int) -> tuple[list[str], list[int]]:
    return [f"t{number}" for number in range(count)], [number % 6 for number in range(count)]


@settings(max_examples=cases(25))
@given(st.lists(st.floats(0, 1), min_size=1, max_size=40))
def test_the_mean_lies_inside_its_interval_and_that_inside_the_bounds(values: list[float]):
    found = intervals.estimate(values, *_names(len(values)), within=intervals.SHARE)
    assert found.ci95 is not None
    low, high = found.ci95
    assert -1e-6 <= low <= found.mean <= high <= 1.0 + 1e-6


@settings(max_examples=cases(25))
@given(st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=40))
def test_without_bounds_too(values: list[float]):
    found = intervals.estimate(values, *_names(len(values)))
    assert found.ci95[0] <= found.mean <= found.ci95[1]
    assert found.mde80 >= 0.0


def test_all_alike_at_a_bound_is_not_certain():
    low, high = intervals.estimate([1.0] * 60, *_names(60), within=intervals.SHARE).ci95
    assert high == 1.0
    assert 0.93 < low < 0.95, "sixty of sixty are consistent with one failure in twenty"
    assert intervals.estimate([3.0] * 60, *_names(60)).ci95 == (3.0, 3.0)


def test_nothing_is_nothing_and_one_trial_is_next_to_it():
    assert intervals.estimate([], [], []) == intervals.Estimate(mean=None, ci95=None, n=0)
    assert intervals.estimate([2.0], ["t"], [0]) == intervals.Estimate(mean=2.0, ci95=None, n=1)
    low, high = intervals.estimate([1.0], ["t"], [0], within=intervals.SHARE).ci95
    assert low < 0.1
    assert high == 1.0


def test_names_do_not_matter():
    values = [float(number % 3 == 0) for number in range(60)]
    tasks, people = _names(60)
    renamed = intervals.estimate(values, [name[::-1] + "z" for name in tasks], [9 - who for who in people])
    assert renamed == intervals.estimate(values, tasks, people)


def test_everybody_doing_everything_is_the_textbook_analysis_of_variance():
    chance = np.random.default_rng(3)
    table = chance.normal(size=(12, 1)) * 2 + chance.normal(size=(1, 7)) * 3 + chance.normal(size=(12, 7))
    by_task = 7 * table.mean(1).var(ddof=1)
    by_person = 12 * table.mean(0).var(ddof=1)
    rest = table - table.mean(1, keepdims=True) - table.mean(0, keepdims=True) + table.mean()
    noise = (rest**2).sum() / (11 * 6)
    tasks, people = np.repeat(np.arange(12), 7), np.tile(np.arange(7), 12)
    found = variance_components.two_way_spread(table.ravel()[None], tasks, people)
    assert found.variance[0] == pytest.approx((by_task + by_person - noise) / 84)


def test_every_task_once_is_the_spread_of_peoples_means():
    chance = np.random.default_rng(3)
    table = chance.normal(size=(6, 1)) * 3 + chance.normal(size=(6, 10))
    found = variance_components.two_way_spread(table.reshape(1, -1), np.arange(60), np.repeat(np.arange(6), 10))
    assert found.variance[0] == pytest.approx(table.mean(1).var(ddof=1) / 6)
    assert found.freedom[0] == 5


DESIGNS = {
    "everyone does all": (np.repeat(np.arange(30), 6), np.tile(np.arange(6), 30)),
    "every task once": (np.arange(60), np.arange(60) // 10),
    "every task once, many people": (np.arange(300), np.arange(300) // 10),
    "three of everyone's tasks each": (np.tile(np.arange(60), 2), np.arange(120) // 10),
}


def _worlds(design: str, rate: float, repeats: int, seed: int = 7, **sd: float) -> np.ndarray:
    """Successes (repeats, trials) of a true rate, where both the task and the person matter."""
    tasks, people = DESIGNS[design]
    chance = np.random.default_rng(seed)
    of_task = chance.normal(0, TASK_SD, (repeats, tasks.max() + 1))
    of_person = chance.normal(0, PERSON_SD, (repeats, people.max() + 1))
    level = NORMAL.inv_cdf(rate) * math.sqrt(TASK_SD**2 + PERSON_SD**2 + 1.0)
    noise = chance.normal(0, 1.0, (repeats, len(tasks)))
    return (level + of_task[:, tasks] + of_person[:, people] + noise > 0).astype(float)


@pytest.mark.parametrize("design", DESIGNS)
def test_intervals_hold_the_truth_as_often_as_they_say(design: str):
    tasks, people = DESIGNS[design]
    found = variance_components.two_way_spread(_worlds(design, 0.75, 1000), tasks, people)
    low, high = intervals.confidence_interval(found, len(tasks), intervals.SHARE)
    assert 0.93 <= np.mean((low <= 0.75) & (high >= 0.75)) <= 0.97


@pytest.mark.parametrize("design", DESIGNS)
def test_two_equal_robots_are_seldom_told_apart(design: str):
    tasks, people = DESIGNS[design]
    one, other = _worlds(design, 0.75, 1000), _worlds(design, 0.75, 1000, seed=8)
    low, high = paired_difference.interval_ends(
        paired_difference.difference_spread(one - other, tasks, people, share=True), share=True
    )
    assert 0.93 <= np.mean((low <= 0.0) & (high >= 0.0)) <= 0.97


def test_taking_trials_for_independent_would_not_be_honest():
    values = _worlds("everyone does all", 0.75, 300)
    half = 1.96 * values.std(axis=1) / values.shape[1] ** 0.5
    assert np.mean(np.abs(values.mean(axis=1) - 0.75) <= half) < 0.85
