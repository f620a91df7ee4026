"""The human's trust in the robots."""

from hthor import rules
from hthor.eval.metrics.metric import HIGHER, Metric, Trial


def trust(trial: Trial) -> int | None:
    """The human's rating of the robot after the trial, 1 to 7 (P)."""
    return trial.log.trust


_SCALE = (float(rules.TRUST_MIN), float(rules.TRUST_MAX))

METRICS = (
    Metric(
        "trust", "trust (1 to 7)", trust, decimals=2, better=HIGHER, rank=60, main=True, needs_robot=True, limits=_SCALE
    ),
)
