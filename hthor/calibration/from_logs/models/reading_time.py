"""How long people take from a message to its answer: noticing, then reading.

Both are log-normal; their sum is treated as log-normal with its own mean and variance (Fenton and Wilkinson). A message
without an answer was either not handled yet, or will never get one.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from hthor.calibration.from_logs.features.messages import Reading
from hthor.calibration.from_logs.models.mixed_effects import Array, Fit, Term, fit_mixed_model
from hthor.calibration.from_logs.models.priors import Belief
from hthor.calibration.from_logs.models.timing_models import fit_log_normal, make_sample, spread_term
from hthor.humans.communication.message_reading import LEAST_WORDS, REFERENCE_WORDS, REREADING_SHARE
from hthor.humans.population.parameter_registry import parameter
from hthor.humans.population.parameters import Parameters

_LOST = Term(name="lost", start=-2.0, mean=-2.0, sd=1.0)
"""Logit of the share of messages that never get an answer."""


def fit_noticing(rows: Sequence[tuple[float, int, int, int]], belief: Belief) -> Fit:
    """Fit ``t_notice`` to the seconds until people who walked slowed down.

    Args:
        rows: as `hthor.calibration.from_logs.models.timing_models.make_sample` takes them.
    """
    return fit_log_normal(make_sample(rows), belief.term(), 0.0, noise=Parameters().read_sd, noise_sd=0.3)


def fit_reading(readings: Sequence[Reading], person: Array, beliefs: Mapping[str, Belief]) -> Fit:
    """Fit ``t_read`` and ``t_notice``, with the spread of ``t_read`` between people.

    Args:
        person: (N,) int, the person of each.
        beliefs: of both; that of ``t_notice`` may come from these logs already.
    """
    from scipy.special import log_ndtr

    y = np.log([one.seconds for one in readings])
    answered = np.array([one.answered for one in readings])
    length = np.array(
        [max(LEAST_WORDS, one.words) / REFERENCE_WORDS * (REREADING_SHARE if one.known else 1.0) for one in readings]
    )
    spread = Parameters().read_sd ** 2

    def likelihood(values: dict[str, float], effects: Array) -> Array:
        first, second = math.exp(values["t_notice"]), np.exp(values["t_read"] + effects) * length
        variance = np.log1p(math.expm1(spread) * (first**2 + second**2) / (first + second) ** 2)
        sd = np.sqrt(variance)
        z = (y - np.log(first + second) - 0.5 * (spread - variance)) / sd
        lost = 1.0 / (1.0 + math.exp(-values[_LOST.name]))
        found = math.log1p(-lost) - 0.5 * z * z - np.log(sd)
        waiting = np.logaddexp(math.log(lost), math.log1p(-lost) + log_ndtr(-z))
        return np.where(answered, found, waiting)

    terms = [beliefs["t_read"].term(), beliefs["t_notice"].term(), _LOST]
    return fit_mixed_model(likelihood, terms, person, spread_term(parameter("t_read").effect))
