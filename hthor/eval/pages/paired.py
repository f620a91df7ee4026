"""What robots change against no robot, trial by trial; knows nothing of how it is shown."""

from __future__ import annotations

from collections.abc import Callable

from hthor.eval import stats
from hthor.eval.pages.findings import Uplift
from hthor.eval.pages.gather import Run
from hthor.eval.record import Record
from hthor.eval.stats import Estimate

Both = tuple[Record, Record]
"""A trial with robots and the same person's at the same task without."""


def uplift(alone: Run, helped: Run) -> Uplift:
    """The differences over all trials that both runs have."""
    others = alone.by_pair
    both = [(record, others[pair]) for pair, record in helped.by_pair.items() if pair in others]
    return Uplift(
        arm=helped.label,
        pairs=len(both),
        sr=_difference(both, lambda one: float(one.metrics.sr)),
        twsr=_difference(both, lambda one: one.metrics.twsr),
        saved_s=_difference(both, lambda one: -one.metrics.time_s),
        wins=sum(a.met and not b.met for a, b in both),
        losses=sum(b.met and not a.met for a, b in both),
    )


def _difference(both: list[Both], value: Callable[[Record], float]) -> Estimate:
    return stats.estimate(
        [value(a) - value(b) for a, b in both],
        [a.spec.task.id for a, _ in both],
        [a.spec.participant for a, _ in both],
    )
