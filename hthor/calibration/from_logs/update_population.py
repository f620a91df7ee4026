"""Updates a population with estimates from logs.

Measured parameters are replaced: each draw gets new values of those parameters, from their estimates and errors. The
other parameters are resampled by importance weights: draws far from the estimates count less. Only measured parameters
that are correlated with others are used for the weights: for independent draws, weighting would add only noise.
Estimates are often more precise than the distances between draws, so their errors are widened for the weights, by the
least amount that leaves enough draws.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.calibration.from_logs.estimate import Estimate
from hthor.calibration.from_logs.estimate_all import READING
from hthor.calibration.from_logs.models.priors import Belief, Beliefs, from_scale, to_scale

_WIDENINGS = tuple(0.05 * 1.2**k for k in range(30))
_LEAST_SHARE, _LEAST_DRAWS = 0.1, 50.0
_REACH = 3.0
_EVIDENT = 4.0
"""A correlation counts when it is this many times the usual correlation of independent draws."""


class Updated(Struct, frozen=True, kw_only=True):
    """New draws (D, P) in the parameters' units, all of equal weight.

    ``effective`` is the effective number of old draws; ``widening`` is the amount by which errors were widened, in
    standard deviations of the old draws; ``direct`` are the parameters that the logs measured.
    """

    draws: Any
    effective: float
    widening: float
    direct: tuple[str, ...]


def update_draws(
    names: Sequence[str], draws: Any, weights: Any, beliefs: Beliefs, estimates: Sequence[Estimate], seed: int
) -> Updated:
    """Update the draws (D, P) of a population; ``names`` are their columns, ``weights`` (D,) add up to 1.

    ``beliefs`` come from these draws, see `hthor.calibration.from_logs.models.priors.population_beliefs`.
    """
    used = {one.name: one for one in estimates if one.used and one.name in names}
    scaled = {name: to_scale(draws[:, names.index(name)], beliefs[name].scale) for name in used}
    others = [to_scale(draws[:, names.index(name)], beliefs[name].scale) for name in names if name not in used]
    correlated = {
        name: values for name, values in scaled.items() if _is_correlated(values, others, np.asarray(weights))
    }
    weight, effective, widening = _weights(correlated, used, beliefs, np.asarray(weights))
    new_draws = np.array(draws)[_resample(weight, seeds.draw(seed, "pick"), len(draws))]
    for name in used:
        new_draws[:, names.index(name)] = _draw_values(used[name], beliefs[name], len(new_draws), seed)
    _replace_reading_times(new_draws, names, estimates, beliefs, seed)
    return Updated(draws=new_draws, effective=effective, widening=widening, direct=tuple(used))


def _is_correlated(values: Any, others: Sequence[Any], weights: Any) -> bool:
    """Whether any of the ``others`` is correlated with these values, beyond chance."""
    chance = _EVIDENT * math.sqrt(float((weights**2).sum()))
    return any(abs(_correlation(values, other, weights)) > chance for other in others)


def _correlation(a: Any, b: Any, weights: Any) -> float:
    x, y = (values - float((weights * values).sum()) for values in (a, b))
    scale = math.sqrt(float((weights * x * x).sum()) * float((weights * y * y).sum()))
    return float((weights * x * y).sum()) / scale if scale > 0.0 else 0.0


def _weights(
    scaled: dict[str, Any], used: dict[str, Estimate], beliefs: Beliefs, before: Any
) -> tuple[Any, float, float]:
    """Importance weights, their effective number of draws, and the widening of the errors that they needed."""
    least = max(_LEAST_DRAWS, _LEAST_SHARE / (before**2).sum())
    weight, effective, widening = before, 1.0 / float((before**2).sum()), 0.0
    if not scaled:
        return weight, effective, widening
    for widening in _WIDENINGS:
        log = np.log(np.maximum(before, 1e-300))
        for name, values in scaled.items():
            at, error = _from_logs_alone(used[name], beliefs[name])
            spread = math.hypot(error, widening * beliefs[name].sd)
            log = log - 0.5 * ((values - at) / spread) ** 2
        weight = np.exp(log - log.max())
        weight = weight / weight.sum()
        effective = 1.0 / float((weight**2).sum())
        if effective >= least:
            break
    return weight, effective, widening


def _from_logs_alone(estimate: Estimate, belief: Belief) -> tuple[float, float]:
    """Value and error of the estimate from the logs alone, without the prior belief."""
    precision = max(estimate.se**-2 - belief.sd**-2, (_REACH * belief.sd) ** -2)
    at = (estimate.at * estimate.se**-2 - belief.mean * belief.sd**-2) / precision
    near = _REACH * belief.sd
    return min(max(at, belief.mean - near), belief.mean + near), precision**-0.5


def _resample(weight: Any, start: float, count: int) -> Any:
    """Row numbers, each as often as its weight requires: systematic resampling."""
    marks = (np.arange(count) + start) / count
    return np.minimum(np.searchsorted(np.cumsum(weight), marks), count - 1)


def _draw_values(estimate: Estimate, belief: Belief, count: int, seed: int) -> Any:
    """Random values around the estimate by its error, within the bounds of the prior."""
    normal = np.array([seeds.normal(seed, estimate.name, k) for k in range(count)])
    return np.clip(from_scale(estimate.at + estimate.se * normal, belief.scale), belief.low, belief.high)


def _replace_reading_times(
    new_draws: Any, names: Sequence[str], estimates: Sequence[Estimate], beliefs: Beliefs, seed: int
) -> None:
    """Draw the sum of noticing and reading time and split it in proportion: it is known better than its parts."""
    total_estimate = next((one for one in estimates if one.name == READING and one.used), None)
    if total_estimate is None or "t_notice" not in names or "t_read" not in names:
        return
    normal = np.array([seeds.normal(seed, READING, k) for k in range(len(new_draws))])
    total = np.exp(total_estimate.at + total_estimate.se * normal)
    notice, read = names.index("t_notice"), names.index("t_read")
    part = new_draws[:, notice] / (new_draws[:, notice] + new_draws[:, read])
    for column, share in ((notice, part), (read, 1.0 - part)):
        belief = beliefs[names[column]]
        new_draws[:, column] = np.clip(total * share, belief.low, belief.high)
