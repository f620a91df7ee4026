"""The likelihood of a study's results at given rates, and random results: beta-binomial counts, normal ratios."""

from typing import Any

import numpy as np

from hthor import seeds
from hthor.calibration.emulator.emulator import Rates
from hthor.calibration.evidence import HeldOutFigure, band
from hthor.calibration.inference.design_effects import DesignEffects
from hthor.calibration.inference.summary_statistics import StudyResults
from hthor.calibration.targets import CONDITIONS

Array = np.ndarray[Any, Any]

_EDGE = 0.005
_LEAST_RHO = 1e-4
_MOST_RHO = 0.95


def log_likelihood(rates: Rates, study: StudyResults, effects: DesignEffects) -> Array:
    """(N,) log likelihood [nats] of one study at the rates of N points; results that it lacks add nothing."""
    total = np.zeros(len(rates))
    for metric, hits, out_of in (("sr", "successes", "trials"), ("adoption", "adopted", "asked")):
        for place in range(len(CONDITIONS)):
            trials = float(getattr(study, out_of)[0, place])
            if trials > 0.0:
                share = getattr(rates, metric)[:, place]
                doubt = (effects.spread * getattr(rates, f"{metric}_se")[:, place]) ** 2
                phi = total_design_effect(share, trials, getattr(effects, metric)[place], doubt)
                total += log_beta_binomial(float(getattr(study, hits)[0, place]), trials, share, phi)
    return total + _ratios(rates, study, effects)


def total_design_effect(share: Array, trials: float, phi: Array | float, doubt: Array) -> Array:
    """(N,) design effects, including the emulator's ``doubt``, a variance of ``share``."""
    safe = np.clip(share, _EDGE * 4.0, 1.0 - _EDGE * 4.0)
    whole: Array = phi + doubt * trials / (safe * (1.0 - safe))
    return whole


def log_beta_binomial(hits: float, trials: float, share: Array, phi: Array) -> Array:
    """(N,) log probability of a beta-binomial count with mean ``share`` and ``phi`` times the binomial variance."""
    from scipy.special import betaln, gammaln

    a, b = beta_shape(share, trials, phi)
    ways = gammaln(trials + 1.0) - gammaln(hits + 1.0) - gammaln(trials - hits + 1.0)
    chance: Array = ways + betaln(hits + a, trials - hits + b) - betaln(a, b)
    return chance


def beta_shape(share: Array, trials: float, phi: Array) -> tuple[Array, Array]:
    """The two counts of the beta distribution from which a beta-binomial count draws its probability."""
    safe = np.clip(share, _EDGE, 1.0 - _EDGE)
    rho = np.clip((phi - 1.0) / max(trials - 1.0, 1.0), _LEAST_RHO, _MOST_RHO)
    return safe * (1.0 - rho) / rho, (1.0 - safe) * (1.0 - rho) / rho


def ratio_variance(rates: Rates, successes: Array, effects: DesignEffects) -> Array:
    """(N, 3) variance of the ratio of a group with these numbers of ``successes`` (3,)."""
    noise = effects.ratio * rates.ratio_sd**2 / np.maximum(successes, 1.0)
    found: Array = noise + (effects.spread * rates.ratio_se) ** 2
    return found


def _ratios(rates: Rates, study: StudyResults, effects: DesignEffects) -> Array:
    known = np.flatnonzero(np.isfinite(study.ratio[0]))
    if not len(known):
        return np.zeros(len(rates))
    sd = np.sqrt(ratio_variance(rates, study.successes[0], effects))[:, known]
    z = (study.ratio[0, known] - rates.ratio[:, known]) / sd
    correlation = effects.correlation[np.ix_(known, known)]
    _, size = np.linalg.slogdet(correlation)
    square = np.einsum("ni,ij,nj->n", z, np.linalg.inv(correlation), z)
    found: Array = -0.5 * (square + size + len(known) * np.log(2.0 * np.pi)) - np.log(sd).sum(axis=1)
    return found


def draw_studies(rates: Rates, design: StudyResults, effects: DesignEffects, seed: int = 0) -> StudyResults:
    """A simulated study for each of N points: counts are beta-binomial, ratios normal.

    Of ``design`` (S = 1) only the numbers of trials are used; the noise of the conditions is independent.
    """
    shape = (len(rates), len(CONDITIONS))
    counts = {name: np.zeros(shape) for name in ("successes", "adopted")}
    for name, out_of, metric in (("successes", "trials", "sr"), ("adopted", "asked", "adoption")):
        for column, condition in enumerate(CONDITIONS):
            trials = int(getattr(design, out_of)[0, column])
            rng = np.random.Generator(np.random.Philox(seeds.derive(seed, "predictive", name, condition)))
            share, error = getattr(rates, metric)[:, column], getattr(rates, f"{metric}_se")[:, column]
            if trials:
                phi = total_design_effect(
                    share, trials, getattr(effects, metric)[column], (effects.spread * error) ** 2
                )
                chances = rng.beta(*beta_shape(share, trials, phi))
                counts[name][:, column] = rng.binomial(trials, chances)
    return StudyResults(
        **counts,
        trials=np.broadcast_to(design.trials[:1], shape).copy(),
        asked=np.broadcast_to(design.asked[:1], shape).copy(),
        ratio=_draw_ratios(rates, counts["successes"], effects, seed),
    )


def _draw_ratios(rates: Rates, successes: Array, effects: DesignEffects, seed: int) -> Array:
    rng = np.random.Generator(np.random.Philox(seeds.derive(seed, "predictive", "ratio")))
    noise = rng.standard_normal(successes.shape) @ np.linalg.cholesky(effects.correlation).T
    sd = np.sqrt(ratio_variance(rates, successes, effects))
    return np.where(successes > 0.0, np.clip(rates.ratio + sd * noise, 0.0, 1.0), np.nan)


def compare_figures(
    predictions: dict[str, Array], published: StudyResults, quantiles: tuple[float, float, float]
) -> tuple[HeldOutFigure, ...]:
    """Every figure that the published study reports, with three quantiles of ``predictions``: low, median and high.

    Predictions are fractions by figure, of any number of studies, emulated or simulated; NaN is left out.
    """
    return tuple(
        HeldOutFigure(figure=name, published=float(value[0]), band=band(np.nanquantile(predictions[name], quantiles)))
        for name, value in published.figures().items()
        if np.isfinite(value[0])
    )
