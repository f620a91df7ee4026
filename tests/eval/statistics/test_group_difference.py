"""The difference of two groups of different people: laws, and how often its interval holds the truth."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks import group_coverage
from hthor.eval.results import group_difference, paired_difference


def groups(seed: int, people: tuple[int, int] = (6, 6), tasks: int = 60) -> tuple[np.ndarray, ...]:
    """Values of two groups, and the tasks and people of both."""
    chance = np.random.default_rng(seed)
    (one, who), (other, whose) = (group_coverage.hands(count, tasks) for count in people)
    values = [(chance.random(len(done)) < 0.6).astype(float) for done in (one, other)]
    return *values, np.concatenate([one, other]), np.concatenate([who, whose + people[0]])


@given(st.integers(0, 200))
def test_changing_the_groups_changes_the_sign(seed: int) -> None:
    first, second, tasks, people = groups(seed)
    there = group_difference.difference_of_groups(first, second, tasks, people, "sr", limit_s=90.0)
    size = len(first)
    tasks, people = (np.concatenate([codes[size:], codes[:size]]) for codes in (tasks, people))
    back = group_difference.difference_of_groups(second, first, tasks, people, "sr", limit_s=90.0)
    assert back.difference == -there.difference
    assert back.ci95 == pytest.approx(tuple(-end for end in reversed(there.ci95 or ())), abs=2e-6)
    assert back.p == pytest.approx(there.p, rel=1e-5)
    assert there.ci95 is not None
    assert there.p is not None
    assert (there.p < 0.05) == (there.ci95[0] > 0.0 or there.ci95[1] < 0.0) or abs(there.p - 0.05) < 1e-4
    assert there.difference == pytest.approx(float(second.mean() - first.mean()), abs=1e-6)


def test_the_error_of_a_difference_is_estimated_without_what_tasks_have_in_common() -> None:
    """The groups do the same tasks: on average over data sets the variance is that of the difference's true error."""
    chance, (done, who) = np.random.default_rng(5), group_coverage.hands(18, 60)
    hard, repeats = 0.5 * chance.normal(size=(400, 60))[:, done], 400
    first, second = (hard + chance.normal(size=(repeats, 180)) for _ in range(2))
    codes = np.concatenate([done, done]), np.concatenate([who, who + 18])
    found = group_difference.group_spread(first, second, *codes, share=False)
    true = float((second.mean(axis=1) - first.mean(axis=1)).var())
    assert 0.85 * true < float(found.variance.mean()) < 1.4 * true
    other_tasks = float(first.mean(axis=1).var() + second.mean(axis=1).var())
    assert float(found.variance.mean()) < 0.8 * other_tasks


def test_one_person_in_each_group_shows_nothing() -> None:
    values = np.array([1.0, 0.0, 1.0])
    found = group_difference.difference_of_groups(
        values, values, np.array([0, 1, 2, 0, 1, 2]), np.array([0, 0, 0, 1, 1, 1]), "sr", limit_s=90.0
    )
    assert (found.ci95, found.p, found.mde80) == (None, None, None)


def test_groups_that_never_differed_are_not_proved_equal() -> None:
    same = np.ones(60)
    tasks, people = group_coverage.hands(6, 60)
    found = group_difference.difference_of_groups(
        same, same, np.concatenate([tasks, tasks]), np.concatenate([people, people + 6]), "sr", limit_s=90.0
    )
    assert (found.difference, found.p) == (0.0, 1.0)
    assert found.ci95 is not None
    assert found.ci95[0] < -0.02 < 0.02 < found.ci95[1]


def test_pairs_are_worth_more_than_groups() -> None:
    """With the same people the interval is narrower, where people differ much."""
    chance = np.random.default_rng(3)
    tasks, people = group_coverage.hands(6, 60)
    liking = chance.normal(size=6)[people]
    first, second = ((liking + 0.3 * chance.normal(size=60) > 0.0).astype(float) for _ in range(2))
    apart = group_difference.group_spread(
        first[None], second[None], np.concatenate([tasks, tasks]), np.concatenate([people, people + 6]), share=True
    )
    paired = paired_difference.difference_spread((second - first)[None], tasks, people, share=True)
    assert float(apart.variance[0]) > 2.0 * float(paired.variance[0])


@pytest.mark.parametrize("design", [(6, 6, 60), (18, 18, 60), (7, 6, 60)])
@pytest.mark.parametrize("difference", [0.0, 0.2])
def test_the_interval_holds_the_truth_as_often_as_it_says(design: tuple[int, int, int], difference: float) -> None:
    held, _ = group_coverage.share_held(design, 0.6, (1.0, 0.4), 400, difference)
    assert 0.92 <= held <= 0.985
