"""How noisy studies are (design effects), and how precise an emulator is.

Trials are clustered by people and tasks, so a study's count varies more than a binomial count. This effect and the
emulator's own error are estimated from simulated studies that the emulator was not trained on: an error's variance is

    phi * p (1 - p) / n  +  spread^2 * se^2

with a design effect phi for each figure, and one common factor ``spread`` for the ensemble's disagreement se.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from msgspec import Struct

from hthor.calibration.emulator.emulator import Rates
from hthor.calibration.inference.summary_statistics import StudyResults
from hthor.calibration.targets import CONDITIONS

Array = np.ndarray[Any, Any]

METRICS = ("sr", "ratio", "adoption")
NAMES = tuple(
    f"{metric} {condition}"
    for metric in METRICS
    for condition in CONDITIONS
    if (metric, condition) != ("adoption", CONDITIONS[0])
)
"""The eight quantities in the likelihood."""
_PLACES = tuple((name.split()[0], CONDITIONS.index(name.split()[1])) for name in NAMES)
FOLDS = 5
"""Parts of the studies; the design effects for a part are estimated from the other parts."""
_EDGE = 0.02
_USUAL, _SPREAD, _WIDTH = 1.6, 1.0, 0.7
"""Weak prior of phi and of the spread factor, and its sd in logarithms; it matters only with few studies."""
_LEAST, _MOST = 0.25, 8.0
_MOST_SPREAD = 4.0


class DesignEffects(Struct, frozen=True, kw_only=True, eq=False):
    """Design effects (3,) of each metric by condition; 1 is the noise of independent trials or successes.

    ``spread`` multiplies the ensemble's disagreement; ``correlation`` (3, 3) is between conditions, of the ratios.
    """

    sr: Array
    ratio: Array
    adoption: Array
    spread: float
    correlation: Array

    def figures(self) -> dict[str, float]:
        """Design effects and the spread factor, by name."""
        return {**dict(zip(NAMES, self.by_name().tolist(), strict=True)), "spread": self.spread}

    def by_name(self) -> Array:
        """(8,) design effects in the order of `NAMES`."""
        return np.array([getattr(self, metric)[place] for metric, place in _PLACES])


class EmulatorQuality(Struct, frozen=True, kw_only=True):
    """How well an emulator predicts ``studies`` studies that neither it nor the design effects have seen.

    ``z_sd`` is the sd of standardised errors over all figures, ``by_figure`` the sd for each figure.
    """

    z_sd: float
    by_figure: dict[str, float]
    studies: int


class _Errors(Struct, frozen=True, eq=False):
    """Arrays (S, 8) in the order of `NAMES`: error, variance of independent trials, squared disagreement."""

    error: Array
    base: Array
    doubt: Array

    def take(self, rows: Array) -> _Errors:
        return _Errors(self.error[rows], self.base[rows], self.doubt[rows])


def estimate_effects(rates: Rates, studies: StudyResults) -> DesignEffects:
    """The most probable design effects and spread, for normal errors and a weak prior.

    ``rates`` are predicted at the points of the ``studies``.

    Raises:
        ValueError: with fewer than ten studies.
    """
    if len(studies) < 10:
        raise ValueError(f"design effects need at least 10 simulated studies, got {len(studies)}")
    return _effects(_errors(rates, studies))


def cross_validated_effects(rates: Rates, studies: StudyResults) -> list[tuple[Array, DesignEffects]]:
    """Parts of the studies, as row numbers, each part with the effects estimated from the other parts."""
    errors, fold = _errors(rates, studies), np.arange(len(studies)) % FOLDS
    return [(np.flatnonzero(fold == out), _effects(errors.take(fold != out))) for out in range(FOLDS)]


def emulator_quality(rates: Rates, studies: StudyResults) -> EmulatorQuality:
    """The emulator's errors, standardised by effects that were estimated from other studies."""
    errors = _errors(rates, studies)
    z = np.full(errors.error.shape, np.nan)
    for rows, effects in cross_validated_effects(rates, studies):
        part = errors.take(rows)
        z[rows] = part.error / np.sqrt(effects.by_name() * part.base + effects.spread**2 * part.doubt)
    return EmulatorQuality(
        z_sd=float(np.sqrt(np.nanmean(z**2))),
        by_figure=dict(zip(NAMES, np.nanstd(z, axis=0).tolist(), strict=True)),
        studies=len(studies),
    )


def share_variance(share: Array, trials: Array | float, phi: Array, doubt: Array) -> Array:
    """Variance of an observed share: from clustered trials, plus ``doubt``, the emulator's scaled variance."""
    safe = np.clip(share, _EDGE, 1.0 - _EDGE)
    variance: Array = phi * safe * (1.0 - safe) / np.maximum(trials, 1.0) + doubt
    return variance


def _errors(rates: Rates, studies: StudyResults) -> _Errors:
    with np.errstate(invalid="ignore", divide="ignore"):
        seen = {
            "sr": studies.successes / studies.trials,
            "adoption": studies.adopted / studies.asked,
            "ratio": studies.ratio,
        }
    base = {
        "sr": share_variance(rates.sr, studies.trials, np.ones(3), np.zeros(3)),
        "adoption": share_variance(rates.adoption, studies.asked, np.ones(3), np.zeros(3)),
        "ratio": rates.ratio_sd**2 / np.maximum(studies.successes, 1.0),
    }
    columns = [
        (
            seen[metric][:, place] - getattr(rates, metric)[:, place],
            base[metric][:, place],
            getattr(rates, f"{metric}_se")[:, place] ** 2,
        )
        for metric, place in _PLACES
    ]
    return _Errors(*(np.stack(parts, axis=1) for parts in zip(*columns, strict=True)))


def _effects(errors: _Errors) -> DesignEffects:
    from scipy.optimize import minimize

    usual = np.log([_USUAL] * len(NAMES) + [_SPREAD])
    known = np.isfinite(errors.error)
    square = np.where(known, errors.error, 0.0) ** 2

    def negative_log_posterior(logs: Array) -> tuple[float, Array]:
        phi, spread = np.exp(logs[:-1]), np.exp(2.0 * logs[-1])
        var = phi * errors.base + spread * errors.doubt
        slope = np.where(known, (1.0 - square / var) / var, 0.0)
        off = (logs - usual) / _WIDTH
        total = 0.5 * float(np.sum(np.where(known, np.log(var) + square / var, 0.0)) + off @ off)
        by_phi = 0.5 * (slope * phi * errors.base).sum(axis=0)
        return total, np.append(by_phi, (slope * spread * errors.doubt).sum()) + off / _WIDTH

    bounds = [(np.log(_LEAST), np.log(_MOST))] * len(NAMES) + [(np.log(0.05), np.log(_MOST_SPREAD))]
    best = minimize(negative_log_posterior, usual, jac=True, method="L-BFGS-B", bounds=bounds)
    phi, spread = np.exp(best.x[:-1]), float(np.exp(best.x[-1]))
    z = errors.error / np.sqrt(phi * errors.base + spread**2 * errors.doubt)
    by_name = dict(zip(NAMES, phi, strict=True))
    by_metric = {m: np.array([by_name.get(f"{m} {condition}", 1.0) for condition in CONDITIONS]) for m in METRICS}
    return DesignEffects(**by_metric, spread=spread, correlation=_correlation(z[:, 3:6]))


def _correlation(z: Array) -> Array:
    """(3, 3) correlation, shrunk a little towards zero, so that it can be inverted for any sample."""
    whole = z[np.isfinite(z).all(axis=1)]
    found = np.corrcoef(whole.T) if len(whole) > 2 else np.eye(len(CONDITIONS))
    mixed: Array = 0.97 * found + 0.03 * np.eye(len(CONDITIONS))
    return mixed
