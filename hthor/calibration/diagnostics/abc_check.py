"""A check of the posterior by simulated studies alone: does the truth lie where studies like the published one say? It
is approximate Bayesian computation: studies simulated at points of the prior are kept by how near their summary is
to the published study's, and a local-linear regression moves each kept parameter to where its summary would be the
published one (Beaumont et al. 2002). The summary of a study for a parameter is the mean that our posterior would
give it (Fearnhead and Prangle 2012): one number, so that a few hundred studies, which is all that can be afforded,
are enough to see a posterior that is off by half its width. What this cannot see: whether the study tells more than
the summary keeps, and the shape of tails.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.calibration.inference.posterior import Posterior

Array = np.ndarray[Any, Any]

KEPT = 0.5
"""Share of the studies within the bandwidth."""
MOST = 0.5
"""Largest shift of a median that passes, in posterior standard deviations."""
FEWEST = 40
"""Studies that are needed."""
_TOLD = 0.1
_REPLICAS = 200


class Check(Struct, frozen=True, kw_only=True, eq=False):
    """By how much ABC's median of each parameter (P,) differs from the posterior's, in the posterior's sd.

    ``error`` (P,) is the standard error of that shift, by bootstrap over the studies: a shift of that size means
    nothing. ``worst`` is the largest absolute shift of the parameters asked about, ``passed`` that it is below `MOST`.
    """

    names: tuple[str, ...]
    shift: Array
    error: Array
    worst: float
    passed: bool
    studies: int


def check(found: Posterior, points: Array, summaries: Array, seed: int = 0, fitted: tuple[str, ...] = ()) -> Check:
    """Compare a posterior with what studies simulated in the prior say.

    Args:
        points: (S, P) points of the prior that studies were simulated at.
        summaries: (S, P) posterior means of those studies, see `coverage.Coverage.means`.
        fitted: parameters that must agree; by default those whose contraction is at least .1.

    Raises:
        ValueError: with fewer than `LEAST_WORDS` studies.
    """
    if len(points) < FEWEST:
        raise ValueError(f"ABC needs at least {FEWEST} simulated studies, got {len(points)}")
    chance = np.random.Generator(np.random.Philox(seeds.derive(seed, "abc")))
    drawn = chance.integers(0, len(points), (_REPLICAS, len(points)))
    middle = np.median(found.points, axis=0)
    shift, error = np.zeros(len(found.names)), np.zeros(len(found.names))
    for place, aim in enumerate(found.mean):
        truth, said = points[:, place], summaries[:, place] - aim
        width = max(float(found.sd[place]), 1e-3)
        shift[place] = (_median(truth, said) - middle[place]) / width
        error[place] = np.std([_median(truth[rows], said[rows]) for rows in drawn]) / width
    asked = [name in fitted if fitted else found.contraction[k] >= _TOLD for k, name in enumerate(found.names)]
    worst = float(np.abs(shift[asked]).max()) if any(asked) else 0.0
    return Check(names=found.names, shift=shift, error=error, worst=worst, passed=worst < MOST, studies=len(points))


def _median(truth: Array, off: Array) -> float:
    """Median of the truth where summaries are off by 0, in the unit interval."""
    reach = max(float(np.quantile(np.abs(off), KEPT)), 1e-9)
    weight = np.maximum(0.0, 1.0 - (off / reach) ** 2)
    near = weight > 0.0
    logit, off, weight = np.log(truth[near] / (1.0 - truth[near])), off[near], weight[near]
    centre, middle = np.average(off, weights=weight), np.average(logit, weights=weight)
    spread = float(np.sum(weight * (off - centre) ** 2))
    slope = float(np.sum(weight * (off - centre) * (logit - middle))) / spread if spread > 1e-12 else 0.0
    moved = logit - slope * off
    order = np.argsort(moved, kind="stable")
    total = np.cumsum(weight[order])
    found = moved[order][np.searchsorted(total, total[-1] / 2.0)]
    return float(1.0 / (1.0 + np.exp(-found)))
