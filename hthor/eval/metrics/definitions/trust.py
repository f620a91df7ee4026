"""People's trust in the robots."""

import functools
import statistics

from hthor import rules
from hthor.eval.metrics.metric import HIGHER, Metric, Trial


def trust(trial: Trial) -> float | None:
    """The human's rating of the robots after the trial, 1 to 7 (P); with several people, the mean of their ratings."""
    given = [rating for rating in trial.log.ratings.values() if rating is not None]
    return statistics.mean(given) if given else None


def trust_by_person(trial: Trial) -> dict[str, float]:
    """Each person's rating; only with several people."""
    return {seat: float(rating) for seat, rating in trial.log.ratings.items() if rating is not None}


_SCALE = (float(rules.TRUST_MIN), float(rules.TRUST_MAX))

_trust = functools.partial(Metric, decimals=2, better=HIGHER, needs_robot=True, limits=_SCALE)

METRICS = (
    _trust("trust", "trust (1 to 7)", trust, rank=60, main=True),
    _trust("trust_by", "trust", trust_by_person, rank=940, by_seat=True, several=True),
)
