"""How fast people walk, turn, start, handle and read: log-normal distributions with an effect per person.

The time from a message to its answer is noticing and then reading; their sum is treated as log-normal with its own mean
and variance (Fenton and Wilkinson). A message without an answer was either not handled yet, or never gets one.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from msgspec import Struct

from hthor.calibration.from_logs.features.messages import Reading
from hthor.calibration.from_logs.models.mixed_effects import Array, Fit, Term, fit_mixed_model
from hthor.calibration.from_logs.models.priors import Belief, fit_ability, spread_term
from hthor.humans.communication.message_reading import LEAST_WORDS, REFERENCE_WORDS, REREADING_SHARE
from hthor.humans.population.parameters import Parameters

NOISE, LEARN = "noise", "learn"
READING_TERMS = ("t_read", "t_notice")
_LEAST_NOISE = 0.01
"""Least relative error of a measurement."""
_LOST = Term(name="lost", start=-2.0, mean=-2.0, sd=1.0)
"""Logit of the share of messages that never get an answer."""


class Sample(Struct, frozen=True, kw_only=True):
    """Positive numbers ``y`` (N,), the person of each, and the ``index`` (N,) of its trial.

    ``censored`` (N,) is 0 for a measured number, 1 for a lower bound, -1 for an upper bound of it.
    """

    y: Array
    person: Array
    index: Array
    censored: Array


def make_sample(rows: Sequence[tuple[float, int, int, int]]) -> Sample:
    """From rows of number, person, index and censoring; people are renumbered from 0."""
    table = np.array(rows, dtype=float).reshape(-1, 4)
    table = table[np.isfinite(table[:, 0]) & (table[:, 0] > 0.0)]
    person = np.unique(table[:, 1], return_inverse=True)[1].astype(int)
    return Sample(y=table[:, 0], person=person, index=table[:, 2], censored=table[:, 3])


def fit_log_normal(
    data: Sample,
    middle: Term,
    effect: float,
    *,
    noise: float,
    noise_sd: float = 1.5,
    practice: int = 0,
    learn: Any = 0.0,
) -> Fit:
    """Fit median, spread between people, noise and, if it is free, practice.

    Args:
        middle: the logarithm of the median, in the first trial.
        effect: the spread between people in units of ``sigma``, 0 without spread.
        noise: a guess of the sd of a number's logarithm. noise_sd: the sd of the logarithm of this guess.
        practice: 1 when numbers grow with practice, -1 when they shrink, 0 when they do not change.
        learn: the size of the change by practice: a number, or a `Term` to fit.
    """
    from scipy.special import log_ndtr

    y, gain = np.log(data.y), 1.0 - np.exp(-data.index / Parameters().n_learn)
    is_free = isinstance(learn, Term)

    def likelihood(values: dict[str, float], effects: Array) -> Array:
        lift = np.log1p(np.maximum((values[LEARN] if is_free else learn) * gain, -0.9))
        sd = math.hypot(math.exp(values[NOISE]), _LEAST_NOISE)
        z = (y - values[middle.name] - effects - practice * lift) / sd
        seen = -0.5 * z * z - math.log(sd)
        return np.where(data.censored == 0, seen, log_ndtr(np.where(data.censored > 0, -z, z)))

    terms = [middle, Term(name=NOISE, start=math.log(noise), mean=math.log(noise), sd=noise_sd)]
    if is_free:
        terms.append(learn)
    return fit_mixed_model(likelihood, terms, data.person, spread_term(effect) if effect else None)


def fit_noticing(rows: Sequence[tuple[float, int, int, int]], belief: Belief) -> Fit:
    """Fit ``t_notice`` to the seconds until walking people slowed down; ``rows`` as in `make_sample`."""
    return fit_log_normal(make_sample(rows), belief.term(), 0.0, noise=Parameters().read_sd, noise_sd=0.3)


def fit_reading(readings: Sequence[Reading], person: Array, beliefs: Mapping[str, Belief]) -> Fit:
    """Fit ``t_read``, with its spread between people, and ``t_notice`` to the readings of each ``person`` (N,).

    The belief about ``t_notice`` may already be an estimate from these logs.
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

    return fit_ability(likelihood, READING_TERMS, person, beliefs, _LOST)
