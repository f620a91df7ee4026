"""Intervals of what has bounds: they never leave them, hold the estimate, and agree with the test of no difference."""

from __future__ import annotations

import math

import eval_fakes as fakes
import msgspec
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from law_cases import cases

from benchmarks import bounded
from hthor.eval.metrics import registry
from hthor.eval.metrics.metric import AMOUNTS
from hthor.eval.results import estimates, paired_difference
from hthor.eval.statistics import intervals, variance_components

METRICS = ("sr", "twsr", "adoption", "progress", "precision", "trust", "time_s", "idle_s", "first_useful_s", "sent")
LIMITS = (90.0, 180.0, 0.1)


@st.composite
def _trials(draw, least: int = 1, metrics=METRICS):
    """A metric, its range, and values within it, of few tasks and people."""
    metric, limit = draw(st.sampled_from(metrics)), draw(st.sampled_from(LIMITS))
    low, high = registry.get(metric).range(limit)
    value = st.floats(low, high if math.isfinite(high) else 50.0).map(lambda one: round(one, 6))  # as logs have it
    rows = draw(st.lists(st.tuples(value, value), min_size=least, max_size=30))
    people = draw(st.integers(1, 6))
    return metric, limit, np.array(rows), np.arange(len(rows)) // draw(st.integers(1, 3)), np.arange(len(rows)) % people


@settings(max_examples=cases(150))
@given(_trials())
def test_an_interval_lies_within_the_bounds_and_holds_the_estimate(trials):
    metric, limit, rows, tasks, people = trials
    low, high = registry.get(metric).range(limit)
    found = intervals.estimate(rows[:, 0].tolist(), tasks.tolist(), people.tolist(), within=(low, high))
    if found.ci95 is not None:
        assert low <= found.ci95[0] <= found.mean <= found.ci95[1] <= high + 1e-6


@settings(max_examples=cases(150))
@given(_trials(least=2))
def test_so_does_that_of_a_difference(trials):
    metric, limit, rows, tasks, people = trials
    room = registry.get(metric).width(limit)
    found = paired_difference.difference_of_values(
        rows[:, 0], rows[:, 1], tasks, people, registry.get(metric), limit_s=limit
    )
    least, most = found.ci95
    assert -room - 1e-6 <= least <= found.difference <= most <= room + 1e-6


@settings(max_examples=cases(150))
@given(_trials(least=2))
def test_an_interval_leaves_out_zero_exactly_when_the_test_refuses_it(trials):
    metric, limit, rows, tasks, people = trials
    record = registry.get(metric)
    room = record.width(limit)
    for level in (0.95, 0.99):
        found = paired_difference.difference_of_values(
            rows[:, 0], rows[:, 1], tasks, people, record, limit_s=limit, level=level
        )
        least, most = found.ci95
        if abs(least) > 1e-4 * room and abs(most) > 1e-4 * room and math.isfinite(room):  # no rounding decides it
            assert (least > 0.0 or most < 0.0) == (found.p < 1.0 - level)


@settings(max_examples=cases(100))
@given(_trials(least=2))
def test_a_surer_interval_is_wider(trials):
    metric, limit, rows, tasks, people = trials
    record = registry.get(metric)
    narrow, wide = (
        paired_difference.difference_of_values(
            rows[:, 0], rows[:, 1], tasks, people, record, limit_s=limit, level=level
        ).ci95
        for level in (0.9, 0.99)
    )
    assert wide[0] <= narrow[0] + 1e-6
    assert narrow[1] <= wide[1] + 1e-6


@settings(max_examples=cases(100))
@given(_trials(least=2, metrics=("sr", "twsr", "trust", "time_s")))
def test_turned_about_the_middle_it_is_the_same_interval_turned(trials):
    metric, limit, rows, tasks, people = trials
    low, high = within = registry.get(metric).range(limit)
    one, other = (
        variance_components.two_way_spread(row[None], tasks, people) for row in (rows[:, 0], low + high - rows[:, 0])
    )
    here, there = (intervals.confidence_interval(found, len(rows), within) for found in (one, other))
    assert here[0] == pytest.approx(low + high - there[1], abs=1e-6)
    assert here[1] == pytest.approx(low + high - there[0], abs=1e-6)


@pytest.mark.parametrize(("metric", "limit"), [("time_s", 90.0), ("twsr", None), ("trust", None)])
def test_a_higher_value_does_not_lower_the_interval(metric: str, limit: float | None):
    low, high = within = registry.get(metric).range(limit)
    before = (low, low)
    for level in np.linspace(0.0, 1.0, 21):
        values = low + (high - low) * np.clip(level + np.linspace(-0.1, 0.1, 60), 0.0, 1.0)
        found = intervals.estimate(values.tolist(), list(range(60)), [k % 6 for k in range(60)], within=within)
        assert found.ci95[0] >= before[0] - 1e-6
        assert found.ci95[1] >= before[1] - 1e-6
        before = found.ci95


def test_two_people_who_take_nearly_all_their_time_cannot_take_more():
    times = [90.0] * 9 + [60.0] + [90.0] * 4 + [55.0, 12.0, 44.0, 90.0, 61.0, 19.0]
    tasks, people = list(range(20)), [k // 10 for k in range(20)]
    plain = intervals.estimate(times, tasks, people)
    assert plain.ci95[1] > 90.0, "the mean and some standard errors leave what is possible"
    low, high = intervals.estimate(times, tasks, people, within=registry.get("time_s").range(90.0)).ci95
    assert 0.0 < low < high < 90.0


@example([3, 0, 0, 1])
@settings(max_examples=cases(50))
@given(st.lists(st.integers(0, 9), min_size=2, max_size=40))
def test_counts_have_no_interval_below_nothing(values: list[int]):
    tasks, people = list(range(len(values))), [k // 10 for k in range(len(values))]
    found = intervals.estimate([float(value) for value in values], tasks, people, within=AMOUNTS)
    low, high = found.ci95
    assert 0.0 <= low <= found.mean <= high
    assert low > 0.0 or found.mean == 0.0


def test_a_runs_times_are_held_within_their_limits():
    _, dealt = fakes.run_of(20)
    kept = [one for session in dealt for one in fakes.records(session)]
    slow = [
        msgspec.structs.replace(
            one, metrics=msgspec.structs.replace(one.metrics, time_s=one.spec.task.time_limit - (k % 10 == 0) * 80.0)
        )
        for k, one in enumerate(kept)
    ]
    low, high = estimates.estimate_metrics(slow).time_s.ci95
    assert low < 82.0 < high <= 90.0


def test_means_of_trials_with_other_limits_end_at_the_mean_limit():
    assert registry.get("time_s").range_of([10.0, 170.0], [90.0, 180.0]) == (0.0, 135.0)
    assert registry.get("time_s").range_of([91.0, 170.0], [90.0, 180.0]) == AMOUNTS, "such a time is none of a trial's"
    assert registry.get("trust").width() == 6.0
    assert registry.get("sent").width(90.0) == math.inf


@pytest.mark.parametrize(("metric", "level"), [("time_s", 2.0), ("twsr", 2.0), ("trust", 2.5)])
def test_they_hold_the_truth_as_often_near_a_bound_with_few_people(metric: str, level: float):
    sort = next(one for one in bounded.SORTS if one.metric == metric)
    tasks, people = np.arange(60), np.arange(60) // 10
    values = sort.value(next(bounded.latent(tasks, people, level, 800)))
    within, mean = registry.get(metric).range(bounded.LIMIT_S), bounded.truth(sort, level)
    low, high = intervals.confidence_interval(variance_components.two_way_spread(values, tasks, people), 60, within)
    assert 0.93 <= np.mean((low <= mean) & (mean <= high)) <= 0.98


def test_an_amount_of_unknown_variance_has_no_interval_and_no_warning_of_the_library() -> None:
    """As in a run of three trials in which nothing was counted."""
    one = np.ones(2)
    found = variance_components.MeanSpread(
        mean=np.array([0.0, 2.0]), variance=np.inf * one, freedom=one, uneven=one, single=one
    )
    low, high = intervals.confidence_interval(found, 3, (0.0, math.inf))
    assert not np.isfinite(high - low).any()
