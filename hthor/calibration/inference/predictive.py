"""What studies to expect of populations, with all their noise."""

from __future__ import annotations

from typing import Any

import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.calibration.emulator.emulator import Rates
from hthor.calibration.inference import likelihood
from hthor.calibration.inference.design_effects import Effects
from hthor.calibration.inference.summary_statistics import FIGURES, Observed
from hthor.calibration.simulation.trial_table import CONDITIONS

Array = np.ndarray[Any, Any]

CLOSE = {"sr": 0.04, "twsr": 0.04, "adoption": 0.07}
"""How far the median of a figure may be from the published one."""


class Row(Struct, frozen=True, kw_only=True):
    """A published figure and what is foretold of it, all fractions.

    ``low`` and ``high`` bound the 90 % interval, ``low80`` and ``high80`` the 80 % one; ``percentile`` is where the
    observed figure lies among the foretold ones. ``inside``: within 90 %; ``close``: the median is near enough.
    """

    name: str
    observed: float
    median: float
    low: float
    high: float
    low80: float
    high80: float
    percentile: float
    inside: bool
    inside80: bool
    close: bool


def draw(rates: Rates, design: Observed, effects: Effects, seed: int = 0) -> Observed:
    """A simulated study for each of N points: counts are beta-binomial, ratios normal.

    Args:
        design: a study (S = 1) of which only the numbers of trials are used: ``trials`` and ``asked``.
        seed: of the noise; each condition's is its own.
    """
    shape = (len(rates), len(CONDITIONS))
    found = {name: np.zeros(shape) for name in ("successes", "adopted")}
    for name, out_of, metric in (("successes", "trials", "sr"), ("adopted", "asked", "adoption")):
        for place, condition in enumerate(CONDITIONS):
            trials = int(getattr(design, out_of)[0, place])
            chance = np.random.Generator(np.random.Philox(seeds.derive(seed, "predictive", name, condition)))
            share, doubt = getattr(rates, metric)[:, place], getattr(rates, f"{metric}_se")[:, place]
            phi = getattr(effects, metric)[place]
            if trials:
                whole = likelihood.clustering(share, trials, phi, (effects.spread * doubt) ** 2)
                found[name][:, place] = chance.binomial(trials, chance.beta(*likelihood.shape(share, trials, whole)))
    return Observed(
        **found,
        trials=np.broadcast_to(design.trials[:1], shape).copy(),
        asked=np.broadcast_to(design.asked[:1], shape).copy(),
        ratio=_ratios(rates, found["successes"], effects, seed),
    )


def _ratios(rates: Rates, successes: Array, effects: Effects, seed: int) -> Array:
    chance = np.random.Generator(np.random.Philox(seeds.derive(seed, "predictive", "ratio")))
    noise = chance.standard_normal(successes.shape) @ np.linalg.cholesky(effects.correlation).T
    sd = np.sqrt(likelihood.ratio_variance(rates, successes, effects))
    return np.where(successes > 0.0, np.clip(rates.ratio + sd * noise, 0.0, 1.0), np.nan)


def compare(figures: dict[str, Array], observed: Observed) -> tuple[Row, ...]:
    """The published figures beside foretold ones, for every figure that the study tells.

    Args:
        figures: foretold fractions by figure, of any number of studies: emulated (`draw(...).figures()`) or simulated.
    """
    seen = {name: float(values[0]) for name, values in observed.figures().items()}
    return tuple(_row(name, seen[name], figures[name]) for name in FIGURES if np.isfinite(seen[name]))


def _row(name: str, observed: float, draws: Array) -> Row:
    held = draws[np.isfinite(draws)]
    low, low80, median, high80, high = np.quantile(held, (0.05, 0.1, 0.5, 0.9, 0.95)).tolist()
    return Row(
        name=name,
        observed=observed,
        median=median,
        low=low,
        high=high,
        low80=low80,
        high80=high80,
        percentile=float(np.mean(held < observed) + 0.5 * np.mean(held == observed)),
        inside=low <= observed <= high,
        inside80=low80 <= observed <= high80,
        close=abs(median - observed) <= CLOSE[name.split()[0]],
    )
