"""Where people chose to search: a conditional logit of the value of each option.

The value of an option is (w knowledge + (1 - w) uniform) exp(-exposure) / seconds^kappa, and it is chosen with a chance
that follows value^beta; beta differs from person to person.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from msgspec import Struct

from hthor.calibration.from_logs.models.mixed_effects import Array, Fit, fit_mixed_model
from hthor.calibration.from_logs.models.priors import Belief, from_scale
from hthor.calibration.from_logs.models.timing_models import spread_term
from hthor.humans.population.parameter_registry import parameter
from hthor.humans.population.parameters import Parameters
from hthor.humans.search.option_choice import DOORWAY_S, SETTLE_S

_LEAST = 1e-12


class Choice(Struct, frozen=True, kw_only=True):
    """One choice: rows [knowledge, uniform, metres, exposure, closed, is_door] of the options, and which was chosen.

    ``pace`` [m/s] is how fast this person walked.
    """

    options: Sequence[Sequence[float]]
    chosen: int
    pace: float


def fit_choices(choices: Sequence[Choice], person: Array, beliefs: Mapping[str, Belief]) -> Fit:
    """Fit ``beta``, ``kappa`` and ``w_prior``, with the spread of ``beta`` between people.

    Args:
        person: (N,) int, the person of each choice.
        beliefs: of these three, and of ``t_dwell`` and ``t_manip``, which are not fitted.
    """
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
        picked: Array = utility[rows, chosen] - total
        return picked

    terms = [beliefs[name].term() for name in ("beta", "kappa", "w_prior")]
    return fit_mixed_model(likelihood, terms, person, spread_term(parameter("beta").effect))


def default_pace() -> float:
    """Walking speed of a person whose own is not known [m/s]."""
    return Parameters().v_pace
