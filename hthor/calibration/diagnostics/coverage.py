"""Whether intervals hold the truth as often as they claim.

Simulated studies, whose truth is known, are fitted; and every two conditions of the published study predict the third.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from msgspec import Struct

from hthor.calibration.emulator.emulator import Emulator, Rates
from hthor.calibration.emulator.mlp import single_thread
from hthor.calibration.evidence import HeldOutCondition
from hthor.calibration.inference import design_effects, likelihood, posterior
from hthor.calibration.inference.design_effects import DesignEffects
from hthor.calibration.inference.posterior import PriorSample
from hthor.calibration.inference.summary_statistics import StudyResults
from hthor.calibration.targets import CONDITIONS

Array = np.ndarray[Any, Any]

PROPOSALS = 1 << 17
"""Points of the prior that are weighted by each study."""
LEVEL = 0.9
BINS = 10
"""Bins of the histogram of ranks."""
_BAND80 = (0.1, 0.5, 0.9)


class Coverage(Struct, frozen=True, kw_only=True, eq=False):
    """What was found, by parameter (P,).

    ``covered`` is the share of studies whose 90 % interval held the truth, ``overall`` its mean over all parameters.
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
    """Fit every study, simulated at the truths ``points`` (S, P), drawn from the prior.

    The emulator must not have seen them; the design effects for one are estimated from others.
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
    rivals: Mapping[str, Rates] | None = None,
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
                rivals={name: _score(rival, only, effects) for name, rival in sorted((rivals or {}).items())},
            )
        )
    return tuple(found)


def _score(rates: Rates, study: StudyResults, effects: DesignEffects) -> float:
    """Log of the mean probability [nats] over equally likely rates."""
    log = likelihood.log_likelihood(rates, study, effects)
    top = float(log.max())
    return top + float(np.log(np.mean(np.exp(log - top))))
