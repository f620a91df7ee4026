"""The values of all metrics in one trial, and as columns over several trials."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct, UnsetType
from numpy.typing import NDArray

from hthor.episode.recording.episode_log import EpisodeLog
from hthor.episode.recording.task_part import task_part
from hthor.eval.metrics import registry
from hthor.eval.metrics.metric import Trial, Value
from hthor.types import TrialSpec

CODE_ROOT = "scoring"


class MetricValues(Struct, frozen=True, kw_only=True):
    """The values of one trial by metric: a field for each metric of the registry."""

    def __getitem__(self, metric: str) -> float | None:
        """The value of a metric; None where the trial has none."""
        value: Value = getattr(self, metric)
        return value

    def number(self, metric: str) -> float:
        """The value of a metric that every trial has; raises ValueError when this trial has none."""
        value = self[metric]
        if value is None:
            raise ValueError(f"this trial has no value for '{metric}'")
        return value

    def by_seat(self, metric: str) -> dict[str, float]:
        """The values of a metric by seat or pair of seats."""
        values: dict[str, float] | UnsetType = getattr(self, metric)
        return values or {}


if TYPE_CHECKING:
    TrialMetrics = MetricValues
if not TYPE_CHECKING:
    TrialMetrics = registry.define_record(
        "TrialMetrics", MetricValues, __name__, single=Value, default=None, by_seat=dict[str, float]
    )


def measure(spec: TrialSpec, log: EpisodeLog) -> TrialMetrics:
    """The metrics of a trial; they are about the task itself, not about phases before it."""
    trial = Trial(spec, task_part(log))
    return TrialMetrics(**{metric.name: metric.measure(trial) for metric in registry.METRICS})


def column(trials: Iterable[TrialMetrics], metric: str) -> NDArray[np.float64]:
    """The values of a metric in trials, (N,); NaN where a trial has none."""
    return np.array([np.nan if (value := one[metric]) is None else value for one in trials], dtype=np.float64)
