"""Which populations fit a study's results: importance sampling from the prior.

Every parameter is sampled, those that the results say nothing of too, so that ignorance of them goes into whatever is
foretold. The prior is uniform on the unit cube. When few of its points fit, a second round of points is drawn from a
normal distribution around those that do, and all points of both rounds are weighed by the mixture that they come from:
the weights stay exact.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.calibration.emulator.emulator import Emulator, Rates
from hthor.calibration.emulator.single_thread import alone
from hthor.calibration.inference import likelihood
from hthor.calibration.inference.design_effects import Effects
from hthor.calibration.inference.summary_statistics import Observed
from hthor.calibration.simulation import design_points as places
from hthor.errors import MissingExtra

Array = np.ndarray[Any, Any]

PROPOSALS = 1 << 18
"""Points of the prior that are weighed, and as many again in a second round."""
DRAWS = 2000
"""Draws of the posterior that are kept."""
ENOUGH = 4000.0
"""Effective number of weighed points from which no second round is needed."""
_INFORMED = 0.03
_WIDER = 1.5
_EDGE = 1e-6


class Bank(Struct, frozen=True, kw_only=True, eq=False):
    """Points (N, P), what to expect at each, and the log of the density (N,) that they were drawn from."""

    points: Array
    rates: Rates
    density: Array


class Posterior(Struct, frozen=True, kw_only=True, eq=False):
    """Populations that fit, and what was learned about each parameter, in the unit cube.

    Attributes:
        names: the P parameters. points: (D, P) draws, all of the same weight.
        mean, sd: (P,). contraction: (P,) 1 - variance / prior variance. correlation: (P, P).
        effective: effective number of the ``proposals`` that were weighed.
        evidence: log chance [nats] of the results under the prior.
    """

    names: tuple[str, ...]
    points: Array
    mean: Array
    sd: Array
    contraction: Array
    correlation: Array
    effective: float
    proposals: int
    evidence: float

    def quantiles(self, shares: tuple[float, ...] = (0.05, 0.5, 0.95)) -> Array:
        """(len(shares), P) quantiles of the draws."""
        found: Array = np.quantile(self.points, shares, axis=0)
        return found


def bank(emulator: Emulator, seed: int, proposals: int = PROPOSALS) -> Bank:
    """Points that fill the prior evenly. It can be weighed by any number of studies."""
    points = places.spread(proposals, len(emulator.names), seed, "posterior")
    return Bank(points=points, rates=emulator.rates(points), density=np.zeros(proposals))


def sample(
    emulator: Emulator,
    study: Observed,
    effects: Effects,
    seed: int = 0,
    draws: int = DRAWS,
    prior: Bank | None = None,
    proposals: int = PROPOSALS,
) -> Posterior:
    """The posterior given the first study of ``study``.

    Args:
        prior: a `bank` to weigh; by default one of ``proposals`` points is made.
    """
    held = prior or bank(emulator, seed, proposals)
    with alone():
        weight, evidence = weights(held, study, effects)
        if effective(weight) < ENOUGH:
            held = _around(emulator, held, weight, seed)
            weight, evidence = weights(held, study, effects)
        return _posterior(emulator.names, held, weight, evidence, seed, draws)


def weights(held: Bank, study: Observed, effects: Effects) -> tuple[Array, float]:
    """(N,) weights of a bank's points that add up to 1, and the log chance [nats] of the study under the prior."""
    log = likelihood.log(held.rates, study, effects) - held.density
    top = float(log.max())
    weight = np.exp(log - top)
    return weight / weight.sum(), top + float(np.log(weight.mean()))


def effective(weight: Array) -> float:
    """Kish's effective number of weighed points."""
    return float(1.0 / np.sum(weight**2))


def propose(posterior: Posterior, count: int, seed: int) -> Array:
    """(count, P) points to simulate at next: draws, jittered so that they reach a little beyond."""
    chance = np.random.Generator(np.random.Philox(seeds.derive(seed, "propose")))
    from_, _ = _normal()
    z = _probit(posterior.points[np.arange(count) * len(posterior.points) // count])
    z = z + 0.6 * z.std(axis=0) * chance.standard_normal(z.shape)
    return places.tidy(from_(z))


def _around(emulator: Emulator, prior: Bank, weight: Array, seed: int) -> Bank:
    """The bank and as many points again around those of high weight, with the density of the whole mixture."""
    cdf, pdf = _normal()
    z = _probit(prior.points)
    mean = weight @ z
    cov = _WIDER * np.cov(z.T, aweights=weight)
    contraction = 1.0 - 12.0 * _variance(prior.points, weight)
    told = np.flatnonzero(contraction > _INFORMED)
    mean, cov = mean[told], cov[np.ix_(told, told)] + 1e-3 * np.eye(len(told))
    root = np.linalg.cholesky(cov)

    count, dimensions = prior.points.shape
    chance = np.random.Generator(np.random.Philox(seeds.derive(seed, "around")))
    fresh = places.spread(count, dimensions, seed, "around")
    fresh[:, told] = cdf(mean + chance.standard_normal((count, len(told))) @ root.T)
    fresh = np.round(np.clip(fresh, _EDGE, 1.0 - _EDGE), 9)  # as many digits as points have in files

    points = np.concatenate([prior.points, fresh])
    away = _probit(points)[:, told]
    unit = np.linalg.solve(root, (away - mean).T)
    log = -0.5 * (unit**2).sum(axis=0) - np.log(np.diag(root)).sum() - 0.5 * len(told) * np.log(2.0 * np.pi)
    log = log - pdf(away).sum(axis=1)
    rates = emulator.rates(fresh)
    parts = {name: (getattr(prior.rates, name), getattr(rates, name)) for name in Rates.__struct_fields__}
    both = {name: np.concatenate(pair) for name, pair in parts.items()}
    return Bank(points=points, rates=Rates(**both), density=np.logaddexp(0.0, log) - np.log(2.0))


def _posterior(names: tuple[str, ...], held: Bank, weight: Array, evidence: float, seed: int, draws: int) -> Posterior:
    mean, variance = weight @ held.points, _variance(held.points, weight)
    covariance = np.cov(held.points.T, aweights=weight, ddof=0)
    sd = np.sqrt(variance)
    return Posterior(
        names=names,
        points=held.points[_mixed(resampled(weight, draws, seeds.draw(seed, "resample")), seed)],
        mean=mean,
        sd=sd,
        contraction=1.0 - 12.0 * variance,
        correlation=covariance / np.outer(sd, sd),
        effective=effective(weight),
        proposals=len(weight),
        evidence=evidence,
    )


def resampled(weight: Array, draws: int, start: float) -> Array:
    """(draws,) row numbers, each as often as its weight says to within one (systematic resampling)."""
    marks = (np.arange(draws) + start) / draws
    found: Array = np.minimum(np.searchsorted(np.cumsum(weight), marks, side="right"), len(weight) - 1)
    return found


def _mixed(rows: Array, seed: int) -> Array:
    """The same in an order of no meaning, so that the first few are as good a sample as any."""
    order = np.random.Generator(np.random.Philox(seeds.derive(seed, "mix"))).permutation(len(rows))
    mixed: Array = rows[order]
    return mixed


def _variance(points: Array, weight: Array) -> Array:
    mean = weight @ points
    found: Array = weight @ points**2 - mean**2
    return found


def _probit(points: Array) -> Array:
    try:
        from scipy.special import ndtri
    except ImportError:
        raise MissingExtra("calibration", "calibration") from None
    z: Array = ndtri(np.clip(points, _EDGE, 1.0 - _EDGE))
    return z


def _normal() -> tuple[Any, Any]:
    """The normal distribution function, and the log of its density."""
    try:
        from scipy.special import ndtr
    except ImportError:
        raise MissingExtra("calibration", "calibration") from None
    return ndtr, lambda z: -0.5 * z**2 - 0.5 * np.log(2.0 * np.pi)
