"""The human's trust in the robots."""

import statistics

from hthor import rules
from hthor.eval.metrics.metric import HIGHER, Metric, Trial


def trust(trial: Trial) -> float | None:
    """The human's rating of the robot after the trial, 1 to 7 (P)."""
    given = [rating for rating in trial.log.ratings.values() if rating is not None]
    return statistics.mean(given) if given else None


_SCALE = (float(rules.TRUST_MIN), float(rules.TRUST_MAX))

METRICS = (
    Metric(
        "trust", "trust (1 to 7)", trust, decimals=2, better=HIGHER, rank=60, main=True, needs_robot=True, limits=_SCALE
    ),
)
