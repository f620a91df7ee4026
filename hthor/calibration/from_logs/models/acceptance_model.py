"""Which messages people accept: a logistic regression with an intercept for each person."""

from collections.abc import Mapping, Sequence

import numpy as np

from hthor.calibration.from_logs.features.messages import Offer
from hthor.calibration.from_logs.models.mixed_effects import Array, Fit, fit_mixed_model
from hthor.calibration.from_logs.models.priors import Belief
from hthor.calibration.from_logs.models.timing_models import spread_term
from hthor.humans.population.parameter_registry import parameter
from hthor.humans.population.parameters import Parameters

TERMS = ("a0", "a_trust", "a_gain", "a_load", "a_again")


def fit_acceptance(offers: Sequence[Offer], trust: Array, person: Array, beliefs: Mapping[str, Belief]) -> Fit:
    """Fit the terms of the logit of accepting, with the spread of ``a0`` between people.

    People sometimes press the wrong button (``p_slip``), so neither answer is ever certain.

    Args:
        offers: (N) messages about the task that were read.
        trust: (N,) mean trust at the time, 0 to 1, from the ratings.
        person: (N,) int, the person of each.
    """
    gain, load, again = (np.array([getattr(one, name) for one in offers]) for name in ("gain", "load", "again"))
    confirmed, slip = np.array([one.confirmed for one in offers]), Parameters().p_slip

    def likelihood(values: dict[str, float], effects: Array) -> Array:
        logit = values["a0"] + effects + values["a_trust"] * (trust - 0.5) + values["a_gain"] * np.log1p(gain)
        logit = logit - values["a_load"] * load - values["a_again"] * again
        share = slip + (1.0 - 2.0 * slip) / (1.0 + np.exp(-logit))
        return np.log(np.where(confirmed, share, 1.0 - share))

    return fit_mixed_model(
        likelihood, [beliefs[name].term() for name in TERMS], person, spread_term(parameter("a0").effect)
    )
