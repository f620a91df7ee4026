"""What studies of the published design to expect of populations, with all their noise."""

from typing import Any

import numpy as np

from hthor import seeds
from hthor.calibration.emulator.emulator import Rates
from hthor.calibration.evidence import HeldOutFigure, band
from hthor.calibration.inference import likelihood
from hthor.calibration.inference.design_effects import DesignEffects
from hthor.calibration.inference.summary_statistics import StudyResults
from hthor.calibration.targets import CONDITIONS

Array = np.ndarray[Any, Any]


def draw_studies(rates: Rates, design: StudyResults, effects: DesignEffects, seed: int = 0) -> StudyResults:
    """A simulated study for each of N points: counts are beta-binomial, ratios normal.

    Args:
        design: a study (S = 1) of which only the numbers of trials are used: ``trials`` and ``asked``.
        seed: of the noise; each condition's is its own.
    """
    shape = (len(rates), len(CONDITIONS))
    counts = {name: np.zeros(shape) for name in ("successes", "adopted")}
    for name, out_of, metric in (("successes", "trials", "sr"), ("adopted", "asked", "adoption")):
        for column, condition in enumerate(CONDITIONS):
            trials = int(getattr(design, out_of)[0, column])
            rng = np.random.Generator(np.random.Philox(seeds.derive(seed, "predictive", name, condition)))
            share, error = getattr(rates, metric)[:, column], getattr(rates, f"{metric}_se")[:, column]
            if trials:
                phi = likelihood.total_design_effect(
                    share, trials, getattr(effects, metric)[column], (effects.spread * error) ** 2
                )
                chances = rng.beta(*likelihood.beta_shape(share, trials, phi))
                counts[name][:, column] = rng.binomial(trials, chances)
    return StudyResults(
        **counts,
        trials=np.broadcast_to(design.trials[:1], shape).copy(),
        asked=np.broadcast_to(design.asked[:1], shape).copy(),
        ratio=_ratios(rates, counts["successes"], effects, seed),
    )


def _ratios(rates: Rates, successes: Array, effects: DesignEffects, seed: int) -> Array:
    rng = np.random.Generator(np.random.Philox(seeds.derive(seed, "predictive", "ratio")))
    noise = rng.standard_normal(successes.shape) @ np.linalg.cholesky(effects.correlation).T
    sd = np.sqrt(likelihood.ratio_variance(rates, successes, effects))
    return np.where(successes > 0.0, np.clip(rates.ratio + sd * noise, 0.0, 1.0), np.nan)


def compare_figures(
    predictions: dict[str, Array], published: StudyResults, quantiles: tuple[float, float, float]
) -> tuple[HeldOutFigure, ...]:
    """Every figure that the published study reports, with an interval of predictions.

    Args:
        predictions: fractions by figure, of any number of studies, emulated or simulated; NaN where there is none.
        quantiles: low, median and high end of the interval.
    """
    return tuple(
        HeldOutFigure(figure=name, published=float(value[0]), band=band(np.nanquantile(predictions[name], quantiles)))
        for name, value in published.figures().items()
        if np.isfinite(value[0])
    )
