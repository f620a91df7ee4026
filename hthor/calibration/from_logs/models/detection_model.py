"""How fast people notice what they search for: a regression of noticing on what was in view.

The rate of noticing is lam0 share exp(-(ecc / ecc_sd)^2 / 2 - clutter beside) / (1 + (a50 / angle)^2), more where the
person is searching at that spot; an object is noticed in a glimpse with 1 - exp(-rate seconds), whose logarithm of the
logarithm is linear in most of this. ``lam0`` differs from person to person.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from msgspec import Struct

from hthor.calibration.from_logs.models.mixed_effects import Array, Fit, fit_mixed_model
from hthor.calibration.from_logs.models.priors import Belief
from hthor.calibration.from_logs.models.timing_models import spread_term
from hthor.humans.population.parameter_registry import parameter
from hthor.humans.population.parameters import Parameters

_LEAST_RAD, _LEAST = 1e-3, 1e-12


class Exposure(Struct, frozen=True, kw_only=True):
    """What was in view of one object until it was ``noticed`` or the trial ended.

    ``rows`` are [seconds, angle, ecc, share, beside, attended], see `hthor.humans.perception.exposure_log`; the
    last is the glimpse that found it, when one did.
    """

    rows: Sequence[Sequence[float]]
    noticed: bool


def fit_detection(exposures: Sequence[Exposure], person: Array, beliefs: Mapping[str, Belief]) -> Fit:
    """Fit ``lam0``, ``a50`` and ``clutter``, with the spread of ``lam0`` between people.

    Args:
        person: (N,) int, the person of each.
    """
    counts = np.array([len(one.rows) for one in exposures])
    table = np.concatenate([np.array(one.rows, dtype=float) for one in exposures])
    owner, last = np.repeat(np.arange(len(exposures)), counts), np.cumsum(counts) - 1
    seconds, angle, ecc, share, beside, attended = table.T
    fixed = Parameters()
    known = seconds * share * np.exp(-0.5 * (ecc / fixed.ecc_sd) ** 2) * np.where(attended > 0.0, fixed.focus, 1.0)
    noticed = np.array([one.noticed for one in exposures])

    def likelihood(values: dict[str, float], effects: Array) -> Array:
        near = 1.0 + (max(values["a50"], _LEAST_RAD) / angle) ** 2
        amount = known / near * np.exp(values["lam0"] + effects[owner] - max(values["clutter"], 0.0) * beside)
        final = amount[last]
        before = np.bincount(owner, amount, len(exposures)) - final
        found: Array = np.where(noticed, np.log(np.maximum(-np.expm1(-final), _LEAST)), -final) - before
        return found

    terms = [beliefs[name].term() for name in ("lam0", "a50", "clutter")]
    return fit_mixed_model(likelihood, terms, person, spread_term(parameter("lam0").effect))
