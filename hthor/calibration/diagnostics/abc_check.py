"""A check of the posterior by simulated studies alone, without the emulator: approximate Bayesian computation.

Studies simulated at points of the prior are weighted by how near their summary is to the published study's, and a
local-linear regression moves each kept parameter to where its summary would be the published one (Beaumont et al.
2002). The summary of a study for a parameter is the mean that our posterior would give it (Fearnhead and Prangle
2012): one number, so that a few hundred studies, which is all that can be afforded, are enough to see a posterior that
is off by half its width. What this cannot see: whether the study tells more than the summary keeps, and the shape of
tails.
"""

from typing import Any

import numpy as np

from hthor import seeds
from hthor.calibration.evidence import AbcShift
from hthor.calibration.inference.posterior import Posterior

Array = np.ndarray[Any, Any]

KEPT = 0.5
"""Share of the studies within the bandwidth."""
FEWEST = 40
"""Studies that are needed."""
_REPLICAS = 200
"""Bootstrap replicas of the studies, for the standard error."""


def compare_posteriors(
    ours: Posterior, points: Array, summaries: Array, parameters: tuple[str, ...], seed: int = 0
) -> tuple[AbcShift, ...]:
    """How far ABC's median of each of these parameters lies from the posterior's.

    Args:
        points: (S, P) points of the prior that studies were simulated at.
        summaries: (S, P) posterior means of those studies, see `coverage.Coverage.means`.

    Raises:
        ValueError: with fewer than `FEWEST` studies.
    """
    if len(points) < FEWEST:
        raise ValueError(f"ABC needs at least {FEWEST} simulated studies, got {len(points)}")
    rng = np.random.Generator(np.random.Philox(seeds.derive(seed, "abc")))
    replicas = rng.integers(0, len(points), (_REPLICAS, len(points)))
    shifts = []
    for place, name in enumerate(ours.names):
        if name in parameters:
            truth, offset = points[:, place], summaries[:, place] - ours.mean[place]
            width = max(float(ours.sd[place]), 1e-3)
            shift = (_median(truth, offset) - float(np.median(ours.points[:, place]))) / width
            error = float(np.std([_median(truth[rows], offset[rows]) for rows in replicas])) / width
            shifts.append(AbcShift(name=name, shift=shift, error=error))
    return tuple(shifts)


def _median(truth: Array, offset: Array) -> float:
    """Median of the truth where the summaries' offset is 0, in the unit interval."""
    reach = max(float(np.quantile(np.abs(offset), KEPT)), 1e-9)
    weight = np.maximum(0.0, 1.0 - (offset / reach) ** 2)
    near = weight > 0.0
    logit, offset, weight = np.log(truth[near] / (1.0 - truth[near])), offset[near], weight[near]
    centre, middle = np.average(offset, weights=weight), np.average(logit, weights=weight)
    spread = float(np.sum(weight * (offset - centre) ** 2))
    slope = float(np.sum(weight * (offset - centre) * (logit - middle))) / spread if spread > 1e-12 else 0.0
    moved = logit - slope * offset
    order = np.argsort(moved, kind="stable")
    total = np.cumsum(weight[order])
    median = moved[order][np.searchsorted(total, total[-1] / 2.0)]
    return float(1.0 / (1.0 + np.exp(-median)))
