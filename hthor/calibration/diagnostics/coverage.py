"""Whether intervals hold what they promise: simulated studies are fitted like the real one, whose truth is known."""

from __future__ import annotations

from typing import Any

import numpy as np
from msgspec import Struct

from hthor.calibration.emulator.emulator import Emulator
from hthor.calibration.emulator.single_thread import alone
from hthor.calibration.inference import design_effects, posterior
from hthor.calibration.inference.summary_statistics import Observed

Array = np.ndarray[Any, Any]

PROPOSALS = 1 << 17
"""Points of the prior that are weighed by each study."""
LEVEL = 0.9
BINS = 10
"""Bins of the histogram of ranks."""


class Coverage(Struct, frozen=True, kw_only=True, eq=False):
    """What came out, by parameter (P,).

    Attributes:
        covered: share of the studies whose 90 % interval held the truth. overall: its mean over all parameters.
        fitted: its mean over the parameters that were asked about.
        means: (S, P) posterior means.
        ranks: (S, P) share of the posterior below the truth; uniform when posteriors are honest.
        recovery: correlation of truth and posterior mean. contraction: median over the studies.
        effective: least and median effective number of points, over studies.
    """

    names: tuple[str, ...]
    covered: Array
    overall: float
    fitted: float
    means: Array
    ranks: Array
    recovery: Array
    contraction: Array
    effective: tuple[float, float]

    def histogram(self, place: int) -> tuple[int, ...]:
        """Ranks of parameter number ``place`` in `BINS` bins."""
        counts, _ = np.histogram(self.ranks[:, place], bins=BINS, range=(0.0, 1.0))
        return tuple(int(count) for count in counts)


def run(
    emulator: Emulator,
    points: Array,
    studies: Observed,
    seed: int = 0,
    proposals: int = PROPOSALS,
    fitted: tuple[str, ...] = (),
) -> Coverage:
    """Fit every study. The emulator must not have seen them; the design effects for one are found on others.

    Args:
        points: (S, P) truths, drawn from the prior.
        fitted: names of the parameters that ``fitted`` is about; by default all.
    """
    held = posterior.bank(emulator, seed, proposals)
    rates = emulator.rates(points)
    ranks, means = np.zeros(points.shape), np.zeros(points.shape)
    variances, numbers = np.zeros(points.shape), np.zeros(len(points))
    with alone():
        for rows, effects in design_effects.crossed(rates, studies):
            for row in rows:
                weight, _ = posterior.weights(held, studies.one(row), effects)
                likely = weight > weight.max() * 1e-6
                some, weight = held.points[likely], weight[likely] / weight[likely].sum()
                ranks[row] = weight @ (some < points[row])
                means[row] = weight @ some
                variances[row] = weight @ some**2 - means[row] ** 2
                numbers[row] = posterior.effective(weight)
    covered = np.mean(np.abs(ranks - 0.5) <= LEVEL / 2.0, axis=0)
    chosen = [place for place, name in enumerate(emulator.names) if not fitted or name in fitted]
    return Coverage(
        names=emulator.names,
        covered=covered,
        overall=float(covered.mean()),
        fitted=float(covered[chosen].mean()),
        means=means,
        ranks=ranks,
        recovery=_correlations(points, means),
        contraction=np.median(1.0 - 12.0 * variances, axis=0),
        effective=(float(numbers.min()), float(np.median(numbers))),
    )


def _correlations(truth: Array, found: Array) -> Array:
    a, b = truth - truth.mean(axis=0), found - found.mean(axis=0)
    size = np.sqrt((a**2).sum(axis=0) * (b**2).sum(axis=0))
    result: Array = (a * b).sum(axis=0) / np.maximum(size, 1e-12)
    return result
