"""How fast people walk, turn, start, handle and read: log-normal distributions with an effect per person."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from msgspec import Struct

from hthor.calibration.from_logs.models.mixed_effects import Array, Fit, Term, fit_mixed_model
from hthor.humans.population.parameters import Parameters

SPREAD, NOISE, LEARN = "spread", "noise", "learn"
_SPREAD_SD = 1.5
_LEAST_NOISE = 0.01
"""No measurement is more precise than 1 %."""


class Sample(Struct, frozen=True, kw_only=True):
    """Positive numbers ``y`` (N,), the person of each, and the ``index`` (N,) of its trial.

    ``censored`` (N,) is 0 for a measured number, 1 where only a lower, -1 where only an upper bound is known.
    """

    y: Array
    person: Array
    index: Array
    censored: Array

    @property
    def people(self) -> int:
        """How many people there are."""
        return len(np.unique(self.person))


def make_sample(rows: Sequence[tuple[float, int, int, int]]) -> Sample:
    """From rows of number, person, index and censoring; people are renumbered from 0."""
    table = np.array(rows, dtype=float).reshape(-1, 4)
    table = table[np.isfinite(table[:, 0]) & (table[:, 0] > 0.0)]
    person = np.unique(table[:, 1], return_inverse=True)[1].astype(int)
    return Sample(y=table[:, 0], person=person, index=table[:, 2], censored=table[:, 3])


def spread_term(effect: float) -> Term:
    """The logarithm of the standard deviation between people, with a wide prior around that of the published people."""
    centre = math.log(Parameters().sigma * effect)
    return Term(name=SPREAD, start=centre, mean=centre, sd=_SPREAD_SD)


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
    """Fit median, spread between people, noise and, where it is free, practice.

    Args:
        middle: the logarithm of the median, in the first trial.
        effect: the spread between people in units of ``sigma``, 0 when there is none.
        noise: a guess of the standard deviation of one number's logarithm. noise_sd: how rough that guess is, as the
            standard deviation of its own logarithm.
        practice: 1 when numbers grow with practice, -1 when they shrink, 0 when neither.
        learn: how much: a number, or a `Term` to find.
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
