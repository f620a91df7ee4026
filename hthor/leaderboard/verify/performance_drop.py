"""Whether an agent does worse at fresh tasks than its entry claims, and which drop would have been detected.

The tasks differ and the people are the same. The test is Welch's, one-sided, with the variances of
`hthor.eval.statistics.variance_components` for new tasks and new people. It is made for success and for time-
weighted success, each at half the level, so that an honest agent is flagged in one of a hundred verifications.
"""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.eval.statistics import intervals, variance_components

LEVEL = 0.01
STEP = 0.01
"""Simulated drops are multiples of this [share]."""
_GAMES = 400


class Drop(Struct, frozen=True, kw_only=True):
    """How much lower a share is, and the probability of such a drop by chance."""

    gap: float
    p: float

    @property
    def seen(self) -> bool:
        """Whether the drop is significant."""
        return self.p < LEVEL / 2.0


def measure_drop(claimed: np.ndarray, participants: Sequence[int], fresh: np.ndarray, people: Sequence[int]) -> Drop:
    """The drop from the claimed values, (N,), to the fresh values, (M,), with the person of each value."""
    gap, p = _welch(claimed, np.asarray(participants), fresh[None], np.asarray(people))
    return Drop(gap=round(float(gap[0]), 6), p=float(f"{float(p[0]):.3g}"))


def detectable_drop(claimed: np.ndarray, participants: Sequence[int], count: int) -> float | None:
    """The smallest drop that this many fresh tasks detect with the power `intervals.POWER`; None if they detect none.

    People are drawn from the entry, each with their trials. Each of their successes is lost with the same probability,
    so that the mean falls by the drop that is tried.

    Args:
        claimed: success in each trial, (N,). participants: the person of each trial.
    """
    mean = float(claimed.mean())
    for steps in range(1, round(mean / STEP) + 1):
        if detection_rate(claimed, participants, count, steps * STEP) >= intervals.POWER:
            return round(steps * STEP, 4)
    return None


def detection_rate(claimed: np.ndarray, participants: Sequence[int], count: int, fall: float) -> float:
    """How often this many fresh tasks show a drop of this size."""
    chance = np.random.default_rng(abs(seeds.derive(0, "falling", len(claimed), count, round(fall / STEP * 1000))))
    owners, mean = np.asarray(participants), float(claimed.mean())
    size = max(1, round(len(claimed) / (int(owners.max()) + 1)))
    people = max(1, count // size)
    firsts = np.flatnonzero(np.r_[True, owners[1:] != owners[:-1]])
    whole = [first for first in firsts if first + size <= len(claimed)]
    picked = chance.choice(whole, (_GAMES, people))
    rows = claimed[(picked[:, :, None] + np.arange(size)).reshape(_GAMES, people * size)]
    lost = chance.random(rows.shape) < (fall / mean if mean > 0.0 else 0.0)
    _, p = _welch(claimed, owners, np.where(lost, 0.0, rows), np.repeat(np.arange(people), size))
    return float((p < LEVEL / 2.0).mean())


def _welch(
    claimed: np.ndarray, participants: np.ndarray, fresh: np.ndarray, people: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Differences of means and one-sided p-values, for rows of fresh values (R, M)."""
    from scipy import special

    there = variance_components.two_way_spread(claimed[None], np.arange(len(claimed)), participants)
    here = variance_components.two_way_spread(fresh, np.arange(fresh.shape[-1]), people)
    edge = 0.25 / fresh.shape[-1] ** 2  # equal outcomes in all fresh trials still have a variance
    one, two = there.variance, np.maximum(here.variance, edge)
    freedom = (one + two) ** 2 / (one**2 / there.freedom + two**2 / here.freedom)
    gap = there.mean - here.mean
    return gap, np.where(gap > 0.0, special.stdtr(freedom, -gap / np.sqrt(one + two)), 1.0)
