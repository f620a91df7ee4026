"""Whether robots keep their order over all populations that fit, and what could turn it."""

from __future__ import annotations

from typing import Any

import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.calibration.emulator.emulator import Emulator, Rates
from hthor.calibration.inference.design_effects import Effects
from hthor.calibration.inference.posterior import Posterior
from hthor.calibration.simulation import trial_table as tables
from hthor.calibration.simulation.trial_table import CONDITIONS, Table
from hthor.errors import MissingExtra

Array = np.ndarray[Any, Any]

PAIRS = (("oracle", "frontier"), ("frontier", "none"))
"""Better robot, worse robot."""
METRICS = ("sr", "twsr")
TRIALS = 600
"""Trials with each robot that an order is judged on."""
_MEASUREMENTS = 256
ENDS = (0.1, 0.9)
"""Quantiles of a parameter's prior between which it is moved."""


class Gap(Struct, frozen=True, kw_only=True, eq=False):
    """The gap between two robots over D draws of the posterior.

    ``gaps`` (D,) are fractions, ``noise`` (D,) the sd of a gap that is measured on so many trials; ``chances`` (D,)
    that such a measurement has the order right.
    """

    metric: str
    better: str
    worse: str
    gaps: Array
    noise: Array
    chances: Array

    @property
    def name(self) -> str:
        """Such as "sr oracle>frontier"."""
        return f"{self.metric} {self.better}>{self.worse}"


class Ranking(Struct, frozen=True, kw_only=True, eq=False):
    """How sure the order is.

    Attributes:
        pairs: each pair and metric.
        holds: share of the draws in which every expected gap is positive; by metric, and "both".
        measured: mean over the draws of the chance that the order comes out right when each robot is measured on
            ``trials`` trials, whose noise is that of people and tasks.
        sure: share of the draws in which that chance is at least 1/2.
    """

    trials: int
    draws: int
    pairs: tuple[Gap, ...]
    holds: dict[str, float]
    measured: dict[str, float]
    sure: dict[str, float]


class Swing(Struct, frozen=True, kw_only=True):
    """What one parameter does to a gap when it alone goes from a low to a high quantile of its prior.

    ``low`` and ``high`` are the mean gaps at either end over the posterior, ``ordered`` the smaller share of draws, of
    the two ends, in which the gap is positive.
    """

    name: str
    metric: str
    better: str
    worse: str
    low: float
    high: float
    ordered: float


def robots(
    rates: Rates, effects: Effects, trials: int = TRIALS, correlation: dict[str, float] | None = None, seed: int = 0
) -> Ranking:
    """Judge the order oracle > frontier > none.

    Args:
        rates: what to expect at the D draws of a posterior.
        effects: design effects; they say how much a rate measured on so many trials varies.
        correlation: by metric, of the same people's trials with two robots, see `paired`; 0 when they are others.
        seed: of the noise that measurements are drawn with.
    """
    shared = {metric: min(1.0, max(0.0, value)) for metric, value in (correlation or {}).items()}
    pairs = tuple(
        _gap(rates, effects, trials, metric, pair, shared.get(metric, 0.0)) for metric in METRICS for pair in PAIRS
    )
    by_metric = {metric: [gap for gap in pairs if gap.metric == metric] for metric in METRICS} | {"both": list(pairs)}
    chance = _measured(rates, effects, trials, shared, seed)
    return Ranking(
        trials=trials,
        draws=len(rates),
        pairs=pairs,
        holds={name: float(np.all([g.gaps > 0.0 for g in gaps], axis=0).mean()) for name, gaps in by_metric.items()},
        measured={name: float(values.mean()) for name, values in chance.items()},
        sure={name: float((values >= 0.5).mean()) for name, values in chance.items()},
    )


def paired(table: Table, least: Array) -> dict[str, float]:
    """Correlation of the same trial's outcome with two robots, by metric: same point, person and task.

    Pairs of trials in different conditions are looked for; 0 where there are none.

    Args:
        least: T* [s] by task.
    """
    outcome = {"sr": table.met.astype(float), "twsr": tables.twsr(table, least)}
    key = np.column_stack([table.study, table.point, table.participant, table.task])
    _, same = np.unique(key, axis=0, return_inverse=True)
    found = {}
    for metric, values in outcome.items():
        sides = np.full((same.max() + 1, len(CONDITIONS)), np.nan)
        sides[same, table.condition] = values
        both = [sides[:, [CONDITIONS.index(better), CONDITIONS.index(worse)]] for better, worse in PAIRS]
        held = np.concatenate([pair[np.isfinite(pair).all(axis=1)] for pair in both])
        varied = len(held) > 2 and held.std(axis=0).min() > 0.0
        found[metric] = float(np.corrcoef(held.T)[0, 1]) if varied else 0.0
    return found


def sensitivity(emulator: Emulator, found: Posterior, metric: str = "sr") -> tuple[Swing, ...]:
    """What each parameter does to each gap, the others staying as they are in the posterior."""
    swings = []
    for place, name in enumerate(found.names):
        ends = []
        for end in ENDS:
            points = found.points.copy()
            points[:, place] = end
            ends.append(emulator.rates(points))
        swings += [_swing(name, metric, better, worse, ends) for better, worse in PAIRS]
    return tuple(swings)


def _measured(rates: Rates, effects: Effects, trials: int, shared: dict[str, float], seed: int) -> dict[str, Array]:
    """(D,) chance that all gaps come out positive when measured, by metric, and "both".

    SR and TWSR of one robot rise and fall together: a trial's covariance of the two is TWSR (1 - SR).
    """
    chance = np.random.Generator(np.random.Philox(seeds.derive(seed, "ranking")))
    common = chance.standard_normal((2, _MEASUREMENTS))
    seen = []
    for place in range(len(CONDITIONS)):
        own = chance.standard_normal((2, _MEASUREMENTS))
        mixed = [
            np.sqrt(shared.get(metric, 0.0)) * common[k] + np.sqrt(1.0 - shared.get(metric, 0.0)) * own[k]
            for k, metric in enumerate(METRICS)
        ]
        sr, twsr = (np.sqrt(_noise(rates, effects, trials, metric, place)) for metric in METRICS)
        together = effects.sr[place] * rates.twsr[:, place] * (1.0 - rates.sr[:, place]) / trials
        alike = np.clip(together / np.maximum(sr * twsr, 1e-12), -1.0, 1.0)
        second = alike[:, None] * mixed[0] + np.sqrt(1.0 - alike**2)[:, None] * mixed[1]
        noise = sr[:, None] * mixed[0], twsr[:, None] * second
        seen.append((rates.sr[:, place, None] + noise[0], rates.twsr[:, place, None] + noise[1]))
    right: list[Array] = []
    for k in range(len(METRICS)):
        gaps = [seen[CONDITIONS.index(better)][k] - seen[CONDITIONS.index(worse)][k] for better, worse in PAIRS]
        right.append(np.all([gap > 0.0 for gap in gaps], axis=0))
    by_metric = dict(zip(METRICS, right, strict=True)) | {"both": right[0] & right[1]}
    return {name: held.mean(axis=1) for name, held in by_metric.items()}


def _swing(name: str, metric: str, better: str, worse: str, ends: list[Rates]) -> Swing:
    gaps = [_difference(rates, metric, better, worse) for rates in ends]
    return Swing(
        name=name,
        metric=metric,
        better=better,
        worse=worse,
        low=float(gaps[0].mean()),
        high=float(gaps[1].mean()),
        ordered=float(min((gap > 0.0).mean() for gap in gaps)),
    )


def _gap(rates: Rates, effects: Effects, trials: int, metric: str, pair: tuple[str, str], correlation: float) -> Gap:
    gaps = _difference(rates, metric, *pair)
    first, second = (_noise(rates, effects, trials, metric, CONDITIONS.index(name)) for name in pair)
    noise = np.sqrt(np.maximum(first + second - 2.0 * correlation * np.sqrt(first * second), 1e-12))
    return Gap(metric=metric, better=pair[0], worse=pair[1], gaps=gaps, noise=noise, chances=_normal(gaps / noise))


def _difference(rates: Rates, metric: str, better: str, worse: str) -> Array:
    values: Array = getattr(rates, metric)
    difference: Array = values[:, CONDITIONS.index(better)] - values[:, CONDITIONS.index(worse)]
    return difference


def _noise(rates: Rates, effects: Effects, trials: int, metric: str, place: int) -> Array:
    """(D,) variance of a rate that is measured on so many trials."""
    sr, ratio = rates.sr[:, place], rates.ratio[:, place]
    square = ratio**2 + rates.ratio_sd[:, place] ** 2
    single = sr * (1.0 - sr) if metric == "sr" else sr * square - (sr * ratio) ** 2
    found: Array = effects.sr[place] * single / trials
    return found


def _normal(z: Array) -> Array:
    try:
        from scipy.special import ndtr
    except ImportError:
        raise MissingExtra("calibration", "calibration") from None
    chance: Array = ndtr(z)
    return chance
