"""Means of metrics over trials, with intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hthor.eval.metrics import registry
from hthor.eval.results.scores import Scores
from hthor.eval.statistics import intervals

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hthor.eval.metrics.metric import Metric
    from hthor.eval.records.scored_trial import ScoredTrial
    from hthor.eval.statistics.intervals import Estimate

CODE_ROOT = "scoring"


def estimate_metrics(records: Sequence[ScoredTrial]) -> Scores:
    """Means and intervals of every metric; trials for which a metric has no value do not count for it."""
    single = {metric.name: estimate_metric(records, metric) for metric in registry.SINGLE}
    by_seat = {metric.name: _by_seat(records, metric) for metric in registry.BY_SEAT}
    kept = {name: found for name, found in by_seat.items() if found or not registry.get(name).several}
    return Scores(**single, **kept)


def trust_by_trial(records: Sequence[ScoredTrial]) -> tuple[Estimate, ...]:
    """Trust after each trial of a session, in their order."""
    rated = [record for record in records if record.metrics["trust"] is not None]
    last = max((record.spec.index for record in rated), default=-1)
    trust = registry.get("trust")
    return tuple(
        estimate_metric([record for record in rated if record.spec.index == index], trust) for index in range(last + 1)
    )


def _by_seat(records: Sequence[ScoredTrial], metric: Metric) -> dict[str, Estimate]:
    """An estimate for each seat that the metric has values for, in order of first appearance."""
    seats = dict.fromkeys(seat for record in records for seat in record.metrics.by_seat(metric.name))
    return {seat: estimate_metric(records, metric, seat) for seat in seats}


def estimate_metric(records: Sequence[ScoredTrial], metric: Metric, seat: str = "") -> Estimate:
    """The estimate of a metric, of one seat where it has values by seat."""
    values: list[float] = []
    specs = []
    for record in records:
        value = record.metrics.by_seat(metric.name).get(seat) if metric.by_seat else record.metrics[metric.name]
        if value is not None:
            values.append(float(value))
            specs.append(record.spec)
    return intervals.estimate(
        values,
        [spec.task.id for spec in specs],
        [spec.session for spec in specs],
        within=metric.range_of(values, [spec.task.time_limit for spec in specs]),
    )
