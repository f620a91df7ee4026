"""Where people chose to search, and how fast they notice what they search for.

Choices are a conditional logit: the value of an option is (w knowledge + (1 - w) uniform) exp(-exposure) /
seconds^kappa, and it is chosen with a chance that follows value^beta; ``beta`` differs from person to person.

The rate of noticing is lam0 share exp(-(ecc / ecc_sd)^2 / 2 - clutter beside) / (1 + (a50 / angle)^2), more if the
person is searching at that spot; a glimpse notices an object with probability 1 - exp(-rate seconds), whose
complementary log-log is linear in most of these terms. ``lam0`` differs from person to person.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from msgspec import Struct

from hthor.calibration.from_logs.models.mixed_effects import Array, Fit
from hthor.calibration.from_logs.models.priors import Belief, fit_ability, from_scale
from hthor.humans.population.parameters import Parameters
from hthor.humans.search.option_choice import DOORWAY_S, SETTLE_S

CHOICE_TERMS, DETECTION_TERMS = ("beta", "kappa", "w_prior"), ("lam0", "a50", "clutter")
_LEAST_RAD, _LEAST = 1e-3, 1e-12


class Choice(Struct, frozen=True, kw_only=True):
    """One choice of a person with this ``pace`` [m/s]; ``chosen`` is the index of the chosen one of the ``options``.

    The rows of ``options`` are [knowledge, uniform, metres, exposure, closed, is_door].
    """

    options: Sequence[Sequence[float]]
    chosen: int
    pace: float


def fit_choices(choices: Sequence[Choice], person: Array, beliefs: Mapping[str, Belief]) -> Fit:
    """Fit `CHOICE_TERMS` to the choices of each ``person`` (N,); ``t_dwell`` and ``t_manip`` are the believed ones."""
    width = max(len(choice.options) for choice in choices)
    table = np.zeros((len(choices), width, 6))
    there = np.zeros((len(choices), width), dtype=bool)
    for row, choice in enumerate(choices):
        table[row, : len(choice.options)] = choice.options
        there[row, : len(choice.options)] = True
    knowledge, uniform, metres, exposure, closed, door = np.moveaxis(table, 2, 0)
    pace = np.array([choice.pace for choice in choices])[:, None]
    dwell, manip = beliefs["t_dwell"].middle, beliefs["t_manip"].middle
    place_s = metres / pace + dwell + SETTLE_S + manip * closed
    log_seconds = np.log(np.where(door > 0.0, metres / pace + DOORWAY_S, place_s))
    rows, chosen = np.arange(len(choices)), np.array([choice.chosen for choice in choices])
    w_scale = beliefs["w_prior"].scale

    def likelihood(values: dict[str, float], effects: Array) -> Array:
        w = from_scale(values["w_prior"], w_scale)
        value = np.log(np.maximum(w * knowledge + (1.0 - w) * uniform, _LEAST)) - exposure
        utility = np.exp(values["beta"] + effects)[:, None] * (value - values["kappa"] * log_seconds)
        utility = np.where(there, utility, -np.inf)
        top = utility.max(axis=1)
        total = top + np.log(np.exp(utility - top[:, None]).sum(axis=1))
        return utility[rows, chosen] - total

    return fit_ability(likelihood, CHOICE_TERMS, person, beliefs)


class Exposure(Struct, frozen=True, kw_only=True):
    """The glimpses at one object until it was ``noticed``, in the last row, or until the trial ended.

    ``rows`` are [seconds, angle, ecc, share, beside, attended], see `hthor.humans.perception.exposure_log`.
    """

    rows: Sequence[Sequence[float]]
    noticed: bool


def fit_detection(exposures: Sequence[Exposure], person: Array, beliefs: Mapping[str, Belief]) -> Fit:
    """Fit `DETECTION_TERMS` to the exposures of each ``person`` (N,)."""
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
        return np.where(noticed, np.log(np.maximum(-np.expm1(-final), _LEAST)), -final) - before

    return fit_ability(likelihood, DETECTION_TERMS, person, beliefs)
