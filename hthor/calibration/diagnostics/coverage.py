"""Whether intervals contain the truth as often as they claim.

Simulated studies, whose true parameters are known, are fitted. Each condition of the published study is predicted from
the other two.

Approximate Bayesian computation (ABC) also checks the posterior by simulated studies alone, without the emulator.
Studies simulated at points of the prior are weighted by how near their summary is to that of the published study, and a
local-linear regression moves each kept parameter to where its summary would equal the published one (Beaumont et al.
2002). The summary of a study for a parameter is the mean that our posterior would give it (Fearnhead and Prangle 2012):
one number, so that the few hundred studies that we can afford reveal a posterior that is off by half its width. They
do not reveal information that the summary loses, or the shape of tails.
"""

from typing import Any

import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.calibration.emulator.emulator import Emulator, Rates
from hthor.calibration.emulator.mlp import single_thread
from hthor.calibration.evidence import AbcShift, HeldOutCondition
from hthor.calibration.inference import design_effects, likelihood, posterior
from hthor.calibration.inference.design_effects import DesignEffects
from hthor.calibration.inference.posterior import Posterior, PriorSample
from hthor.calibration.inference.summary_statistics import StudyResults
from hthor.calibration.targets import CONDITIONS

Array = np.ndarray[Any, Any]

PROPOSALS = 1 << 17
"""Points of the prior that are weighted by each study."""
LEVEL = 0.9
BINS = 10
"""Bins of the histogram of ranks."""
_BAND80 = (0.1, 0.5, 0.9)
KEPT = 0.5
"""Share of the studies within the bandwidth of ABC."""
FEWEST = 40
"""Least number of studies for ABC."""
_REPLICAS = 200
"""Bootstrap replicas of the studies, for the standard error."""


class Coverage(Struct, frozen=True, kw_only=True, eq=False):
    """The findings by parameter (P,).

    ``covered`` is the share of studies whose 90 % interval has the truth, ``overall`` its mean over all parameters.
    ``means`` (S, P) are posterior means, ``ranks`` (S, P) the share of the posterior below the truth, uniform when
    posteriors are calibrated; ``recovery`` is the correlation of truth and posterior mean.
    """

    names: tuple[str, ...]
    covered: Array
    overall: float
    means: Array
    ranks: Array
    recovery: Array

    def histogram(self, column: int) -> tuple[int, ...]:
        """Ranks of one parameter, counted in `BINS` bins."""
        counts, _ = np.histogram(self.ranks[:, column], bins=BINS, range=(0.0, 1.0))
        return tuple(int(count) for count in counts)


def check_coverage(
    emulator: Emulator, points: Array, studies: StudyResults, seed: int = 0, proposals: int = PROPOSALS
) -> Coverage:
    """Fit every simulated study; their true ``points`` (S, P) were drawn from the prior.

    The emulator must not have seen these studies; the design effects for each are estimated from others.
    """
    prior, rates = posterior.sample_prior(emulator, seed, proposals), emulator.rates(points)
    ranks, means = np.zeros(points.shape), np.zeros(points.shape)
    with single_thread():
        for rows, effects in design_effects.cross_validated_effects(rates, studies):
            for row in rows:
                weight, _ = posterior.importance_weights(prior, studies.one(row), effects)
                likely = weight > weight.max() * 1e-6
                kept, weight = prior.points[likely], weight[likely] / weight[likely].sum()
                ranks[row] = weight @ (kept < points[row])
                means[row] = weight @ kept
    covered = np.mean(np.abs(ranks - 0.5) <= LEVEL / 2.0, axis=0)
    return Coverage(
        names=emulator.names,
        covered=covered,
        overall=float(covered.mean()),
        means=means,
        ranks=ranks,
        recovery=_correlations(points, means),
    )


def _correlations(truth: Array, estimate: Array) -> Array:
    a, b = truth - truth.mean(axis=0), estimate - estimate.mean(axis=0)
    size = np.sqrt((a**2).sum(axis=0) * (b**2).sum(axis=0))
    correlations: Array = (a * b).sum(axis=0) / np.maximum(size, 1e-12)
    return correlations


def predict_held_out(
    emulator: Emulator,
    study: StudyResults,
    effects: DesignEffects,
    prior: PriorSample,
    seed: int = 0,
) -> tuple[HeldOutCondition, ...]:
    """Leave out each condition of the published study (S = 1) in turn, and predict its figures."""
    found = []
    for condition in CONDITIONS:
        others, only = study.without(condition), study.only(condition)
        fitted = posterior.sample_posterior(emulator, others, effects, seed, prior=prior)
        rates = emulator.rates(fitted.points)
        figures = likelihood.draw_studies(rates, study, effects, seed).figures()
        found.append(
            HeldOutCondition(
                condition=condition,
                fitted=tuple(name for name in CONDITIONS if name != condition),
                figures=likelihood.compare_figures(figures, only, _BAND80),
                log_score=_score(rates, only, effects),
                log_score_prior=_score(prior.rates, only, effects),
            )
        )
    return tuple(found)


def _score(rates: Rates, study: StudyResults, effects: DesignEffects) -> float:
    """Log of the mean probability [nats] over equally likely rates."""
    log = likelihood.log_likelihood(rates, study, effects)
    top = float(log.max())
    return top + float(np.log(np.mean(np.exp(log - top))))


def compare_posteriors(
    ours: Posterior, points: Array, summaries: Array, parameters: tuple[str, ...], seed: int = 0
) -> tuple[AbcShift, ...]:
    """How far ABC's median of each of these parameters lies from the posterior's.

    Studies were simulated at ``points`` (S, P) of the prior; ``summaries`` (S, P) are their posterior means.

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
    """Median of the true values at an ``offset`` of 0 from the published summary, in the unit interval."""
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
