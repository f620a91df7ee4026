"""Whether robots keep their order over all populations that fit, and which parameters could change it."""

from typing import Any

import numpy as np

from hthor import seeds
from hthor.calibration.emulator.emulator import Emulator, Rates
from hthor.calibration.evidence import ParameterSwing, RobotRanking
from hthor.calibration.inference.design_effects import DesignEffects
from hthor.calibration.inference.posterior import Posterior
from hthor.calibration.targets import CONDITIONS

Array = np.ndarray[Any, Any]

PAIRS = (("oracle", "frontier"), ("frontier", "none"))
"""Pairs of a better and a worse robot."""
METRICS = ("sr", "twsr")
TRIALS = 600
"""Trials with each robot from which an order is judged. Our choice."""
ENDS = (0.1, 0.9)
"""Quantiles of its prior between which a parameter is moved."""
_MEASUREMENTS = 256


def rank_robots(
    rates: Rates, effects: DesignEffects, trials: int = TRIALS, seed: int = 0, suite: str = ""
) -> RobotRanking:
    """Judge the order oracle > frontier > none, each robot measured on ``trials`` trials with different people.

    ``rates`` are predicted at the D draws of a posterior; ``effects`` say how much a rate measured on trials varies.
    """
    chances = {name: float(row.mean()) for name, row in _order_probability(rates, effects, trials, seed).items()}
    ordered: dict[str, list[Array]] = {
        metric: [_gap(rates, metric, *pair) > 0.0 for pair in PAIRS] for metric in METRICS
    }
    ordered["both"] = [holds for metric in METRICS for holds in ordered[metric]]
    return RobotRanking(
        suite=suite,
        draws=len(rates),
        trials=trials,
        sr=chances["sr"],
        twsr=chances["twsr"],
        both=chances["both"],
        expected={name: float(np.all(ordered[name], axis=0).mean()) for name in sorted(ordered)},
        pairs={
            f"{metric} {better}>{worse}": float(
                _positive_probability(rates, effects, trials, metric, better, worse).mean()
            )
            for metric in METRICS
            for better, worse in PAIRS
        },
    )


def parameter_swings(emulator: Emulator, posterior: Posterior) -> tuple[ParameterSwing, ...]:
    """How each parameter changes each gap in SR, while the others stay as they are in the posterior."""
    swings = []
    for column, name in enumerate(posterior.names):
        ends = []
        for end in ENDS:
            points = posterior.points.copy()
            points[:, column] = end
            ends.append(emulator.rates(points))
        for better, worse in PAIRS:
            low, high = (_gap(rates, "sr", better, worse) for rates in ends)
            swings.append(
                ParameterSwing(
                    name=name,
                    better=better,
                    worse=worse,
                    low=float(low.mean()),
                    high=float(high.mean()),
                    ordered=float(min((low > 0.0).mean(), (high > 0.0).mean())),
                )
            )
    return tuple(swings)


def _order_probability(rates: Rates, effects: DesignEffects, trials: int, seed: int) -> dict[str, Array]:
    """(D,) probability that all measured gaps are positive, by metric, and "both".

    SR and TWSR of one robot rise and fall together: a trial's covariance of the two is TWSR (1 - SR).
    """
    rng = np.random.Generator(np.random.Philox(seeds.derive(seed, "ranking")))
    rng.standard_normal((2, _MEASUREMENTS))  # skip the noise that robots measured on the same people would share
    seen = []
    for number in range(len(CONDITIONS)):
        own = rng.standard_normal((2, _MEASUREMENTS))
        sr, twsr = (np.sqrt(_variance(rates, effects, trials, metric, number)) for metric in METRICS)
        covariance = effects.sr[number] * rates.twsr[:, number] * (1.0 - rates.sr[:, number]) / trials
        correlation = np.clip(covariance / np.maximum(sr * twsr, 1e-12), -1.0, 1.0)
        second = correlation[:, None] * own[0] + np.sqrt(1.0 - correlation**2)[:, None] * own[1]
        noise = sr[:, None] * own[0], twsr[:, None] * second
        seen.append((rates.sr[:, number, None] + noise[0], rates.twsr[:, number, None] + noise[1]))
    right: list[Array] = []
    for k in range(len(METRICS)):
        gaps = [seen[CONDITIONS.index(better)][k] - seen[CONDITIONS.index(worse)][k] for better, worse in PAIRS]
        right.append(np.all([gap > 0.0 for gap in gaps], axis=0))
    by_metric = dict(zip(METRICS, right, strict=True)) | {"both": right[0] & right[1]}
    return {name: holds.mean(axis=1) for name, holds in by_metric.items()}


def _positive_probability(
    rates: Rates, effects: DesignEffects, trials: int, metric: str, better: str, worse: str
) -> Array:
    """(D,) probability that a gap is positive when it is measured on ``trials`` trials with each robot."""
    from scipy.special import ndtr

    first, second = (_variance(rates, effects, trials, metric, CONDITIONS.index(name)) for name in (better, worse))
    chances: Array = ndtr(_gap(rates, metric, better, worse) / np.sqrt(np.maximum(first + second, 1e-12)))
    return chances


def _gap(rates: Rates, metric: str, better: str, worse: str) -> Array:
    values: Array = getattr(rates, metric)
    gap: Array = values[:, CONDITIONS.index(better)] - values[:, CONDITIONS.index(worse)]
    return gap


def _variance(rates: Rates, effects: DesignEffects, trials: int, metric: str, condition: int) -> Array:
    """(D,) variance of a rate that is measured on ``trials`` trials."""
    sr, ratio = rates.sr[:, condition], rates.ratio[:, condition]
    square = ratio**2 + rates.ratio_sd[:, condition] ** 2
    single = sr * (1.0 - sr) if metric == "sr" else sr * square - (sr * ratio) ** 2
    variance: Array = effects.sr[condition] * single / trials
    return variance
