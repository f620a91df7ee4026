"""Which populations fit a study's results: importance sampling from the prior.

Every parameter is sampled, even if the results say nothing about it, so that this ignorance goes into every
prediction. The prior is uniform on the unit cube. When few of its points fit, a second round of points is drawn from a
normal distribution around the points that fit. All points of both rounds are weighted by the mixture that they come
from, so the weights stay exact.
"""

from typing import Any

import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.calibration.emulator.emulator import Emulator, Rates, join_rates
from hthor.calibration.emulator.mlp import single_thread
from hthor.calibration.inference import likelihood
from hthor.calibration.inference.design_effects import DesignEffects
from hthor.calibration.inference.summary_statistics import StudyResults
from hthor.calibration.simulation import design_points

Array = np.ndarray[Any, Any]

PROPOSALS = 1 << 18
"""Points of the prior that are weighted, and as many again in a second round."""
DRAWS = 2000
"""Draws of the posterior that are kept."""
ENOUGH = 4000.0
"""Least effective number of weighted points that needs no second round."""
_INFORMED = 0.03
_WIDER = 1.5
_EDGE = 1e-6


class PriorSample(Struct, frozen=True, kw_only=True, eq=False):
    """Points (N, P), the expected rates at each, and the log density (N,) from which they were drawn."""

    points: Array
    rates: Rates
    density: Array


class Posterior(Struct, frozen=True, kw_only=True, eq=False):
    """Populations that fit, and what was learned about each parameter, in the unit cube.

    ``points`` (D, P) are draws of the same weight; ``mean``, ``sd`` and ``contraction`` (1 - variance / prior variance)
    are (P,); ``effective`` is the effective number of ``proposals``, ``evidence`` the log marginal likelihood [nats].
    """

    names: tuple[str, ...]
    points: Array
    mean: Array
    sd: Array
    contraction: Array
    effective: float
    proposals: int
    evidence: float


def sample_prior(emulator: Emulator, seed: int, proposals: int = PROPOSALS) -> PriorSample:
    """Points that fill the prior evenly; the same points can be weighted for any number of studies."""
    points = design_points.sobol_points(proposals, len(emulator.names), seed, "posterior")
    return PriorSample(points=points, rates=emulator.rates(points), density=np.zeros(proposals))


def sample_posterior(
    emulator: Emulator,
    study: StudyResults,
    effects: DesignEffects,
    seed: int = 0,
    draws: int = DRAWS,
    prior: PriorSample | None = None,
    proposals: int = PROPOSALS,
) -> Posterior:
    """The posterior given the first study of ``study``; ``prior`` has points to weight, else ``proposals`` are made."""
    sample = prior or sample_prior(emulator, seed, proposals)
    with single_thread():
        weight, evidence = importance_weights(sample, study, effects)
        if effective_size(weight) < ENOUGH:
            sample = _around(emulator, sample, weight, seed)
            weight, evidence = importance_weights(sample, study, effects)
        return _posterior(emulator.names, sample, weight, evidence, seed, draws)


def importance_weights(sample: PriorSample, study: StudyResults, effects: DesignEffects) -> tuple[Array, float]:
    """(N,) weights of the points that add up to 1, and the log probability [nats] of the study under the prior."""
    log = likelihood.log_likelihood(sample.rates, study, effects) - sample.density
    top = float(log.max())
    weight = np.exp(log - top)
    return weight / weight.sum(), top + float(np.log(weight.mean()))


def effective_size(weight: Array) -> float:
    """Kish's effective number of weighted points."""
    return float(1.0 / np.sum(weight**2))


def propose_points(posterior: Posterior, count: int, seed: int) -> Array:
    """(count, P) points for the next simulations: draws with noise, to reach a little beyond the posterior."""
    from scipy.special import ndtr

    rng = np.random.Generator(np.random.Philox(seeds.derive(seed, "propose")))
    z = _probit(posterior.points[np.arange(count) * len(posterior.points) // count])
    z = z + 0.6 * z.std(axis=0) * rng.standard_normal(z.shape)
    return design_points.round_points(ndtr(z))


def _around(emulator: Emulator, prior: PriorSample, weight: Array, seed: int) -> PriorSample:
    """The sample and as many new points around points of high weight, with the density of the whole mixture."""
    from scipy.special import ndtr

    z = _probit(prior.points)
    mean = weight @ z
    cov = _WIDER * np.cov(z.T, aweights=weight)
    contraction = 1.0 - 12.0 * _variance(prior.points, weight)
    informed = np.flatnonzero(contraction > _INFORMED)
    mean, cov = mean[informed], cov[np.ix_(informed, informed)] + 1e-3 * np.eye(len(informed))
    root = np.linalg.cholesky(cov)

    count, dimensions = prior.points.shape
    rng = np.random.Generator(np.random.Philox(seeds.derive(seed, "around")))
    fresh = design_points.sobol_points(count, dimensions, seed, "around")
    fresh[:, informed] = ndtr(mean + rng.standard_normal((count, len(informed))) @ root.T)
    fresh = np.round(np.clip(fresh, _EDGE, 1.0 - _EDGE), 9)  # as many digits as points have in files

    points = np.concatenate([prior.points, fresh])
    away = _probit(points)[:, informed]
    unit = np.linalg.solve(root, (away - mean).T)
    log = -0.5 * (unit**2).sum(axis=0) - np.log(np.diag(root)).sum() - 0.5 * len(informed) * np.log(2.0 * np.pi)
    log = log - (-0.5 * away**2 - 0.5 * np.log(2.0 * np.pi)).sum(axis=1)
    rates = join_rates([prior.rates, emulator.rates(fresh)])
    return PriorSample(points=points, rates=rates, density=np.logaddexp(0.0, log) - np.log(2.0))


def _posterior(
    names: tuple[str, ...], sample: PriorSample, weight: Array, evidence: float, seed: int, draws: int
) -> Posterior:
    mean, variance = weight @ sample.points, _variance(sample.points, weight)
    return Posterior(
        names=names,
        points=sample.points[_mixed(systematic_resample(weight, draws, seeds.draw(seed, "resample")), seed)],
        mean=mean,
        sd=np.sqrt(variance),
        contraction=1.0 - 12.0 * variance,
        effective=effective_size(weight),
        proposals=len(weight),
        evidence=evidence,
    )


def systematic_resample(weight: Array, draws: int, start: float) -> Array:
    """(draws,) row numbers, each as often as its weight requires, within one (systematic resampling)."""
    marks = (np.arange(draws) + start) / draws
    rows: Array = np.minimum(np.searchsorted(np.cumsum(weight), marks, side="right"), len(weight) - 1)
    return rows


def _mixed(rows: Array, seed: int) -> Array:
    """The rows in random order, so that the first few are a good sample too."""
    order = np.random.Generator(np.random.Philox(seeds.derive(seed, "mix"))).permutation(len(rows))
    mixed: Array = rows[order]
    return mixed


def _variance(points: Array, weight: Array) -> Array:
    mean = weight @ points
    variance: Array = weight @ points**2 - mean**2
    return variance


def _probit(points: Array) -> Array:
    from scipy.special import ndtri

    z: Array = ndtri(np.clip(points, _EDGE, 1.0 - _EDGE))
    return z
