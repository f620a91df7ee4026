"""The estimates of all metrics over some trials."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec
from msgspec import Struct

from hthor.eval.metrics import registry
from hthor.eval.statistics.intervals import NOTHING, Estimate


class Estimates(Struct, frozen=True, kw_only=True):
    """Means with intervals by metric: fractions, seconds, trust points and counts per trial, one field per metric."""

    def __getitem__(self, metric: str) -> Estimate:
        """The estimate of a metric with one value per trial."""
        estimate: Estimate = getattr(self, metric)
        return estimate

    def by_seat(self, metric: str) -> dict[str, Estimate]:
        """The estimates of a metric by seat, or by pair of seats such as "human by robot"."""
        estimates: dict[str, Estimate] | msgspec.UnsetType = getattr(self, metric)
        return estimates or {}


if TYPE_CHECKING:
    Scores = Estimates
if not TYPE_CHECKING:
    Scores = registry.define_record(
        "Scores", Estimates, __name__, single=Estimate, default=NOTHING, by_seat=dict[str, Estimate]
    )
