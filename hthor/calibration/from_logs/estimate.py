"""Parameters and the spread between people, estimated from logs: value, error, amount of data, method."""

import math
from collections.abc import Sequence

import msgspec
import numpy as np
from msgspec import Struct

from hthor.calibration.from_logs.models import timing_models
from hthor.calibration.from_logs.models.mixed_effects import Array, Fit
from hthor.calibration.from_logs.models.priors import SPREAD, Belief, Scale, from_scale, to_scale
from hthor.calibration.from_logs.models.timing_models import Sample
from hthor.calibration.from_logs.trial_features import TrialFeatures
from hthor.humans.population.parameter_registry import parameter

_Z90 = 1.6449
_LEAST_SHARE = 0.25
"""Share of the data in `NEEDS` below which an estimate is not used."""

NEEDS: dict[str, tuple[int, str]] = {
    "v_pace": (12, "trials with a walk"),
    "learn": (60, "trials with a walk"),
    "omega": (36, "turns"),
    "t_on": (12, "trials"),
    "stop_every": (40, "stops"),
    "stop_s": (40, "stops"),
    "k_map": (20, "guided walks"),
    "map_hidden": (40, "followed messages"),
    "t_manip": (30, "attempts"),
    "p_fail": (30, "attempts"),
    "t_notice": (15, "messages"),
    "t_read": (15, "messages"),
    "reading": (15, "messages"),
    "a0": (100, "messages"),
    "a_trust": (100, "messages"),
    "a_gain": (100, "messages"),
    "a_load": (100, "messages"),
    "a_again": (100, "messages"),
    "beta": (300, "choices"),
    "kappa": (300, "choices"),
    "w_prior": (300, "choices"),
    "lam0": (60, "exposures"),
    "a50": (60, "exposures"),
    "clutter": (60, "exposures"),
    "mu0": (100, "ratings"),
    "n0": (100, "ratings"),
    "w_s": (100, "ratings"),
    "w_f": (100, "ratings"),
    "tau_s": (100, "ratings"),
    "sigma": (12, "people"),
}
"""Amount of data that each estimate needs for an error of about 15 %, by experience."""
CAPPED = 0.985
"""Share of the device's limit from which a measurement is a lower bound: without the limit it might be larger."""
_LEAST_SE = 1e-3


class Estimate(Struct, frozen=True, kw_only=True):
    """A parameter's value in its own unit; ``at`` and ``se`` are that value and its standard error on ``scale``.

    ``low`` and ``high`` bound a 90 % interval, ``n`` counts the data, ``needed`` is the number that a reliable estimate
    needs. ``words`` says how reliable the estimate is. ``between`` is the standard deviation between people on the
    scale, with its relative standard error, None if no difference between people is modelled.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float
    scale: Scale
    at: float
    se: float
    n: int
    needed: int
    method: str
    words: str
    between: tuple[float, float] | None = None

    @property
    def used(self) -> bool:
        """Whether there were enough data to use it instead of the prior belief."""
        return self.n >= _LEAST_SHARE * self.needed


def make_estimate(belief: Belief, at: float, se: float, n: int, method: str) -> Estimate:
    """An estimate of a parameter with a prior belief; ``at`` and its standard error ``se`` are on its scale."""
    needed, what = NEEDS[belief.name]
    at = min(max(at, float(to_scale(belief.low, belief.scale))), float(to_scale(belief.high, belief.scale)))
    value, low, high = (
        min(max(float(from_scale(at + z * se, belief.scale)), belief.low), belief.high) for z in (0.0, -_Z90, _Z90)
    )
    return Estimate(
        name=belief.name,
        unit=belief.unit,
        value=value,
        low=low,
        high=high,
        scale=belief.scale,
        at=at,
        se=se,
        n=n,
        needed=needed,
        method=method,
        words=_words(n, needed, what, se, belief.sd),
    )


def _words(n: int, needed: int, what: str, se: float, prior_sd: float) -> str:
    if n < _LEAST_SHARE * needed:
        return f"too few data: {n} {what}, {needed} are wanted; left as it was"
    if n < needed:
        return f"few data: {n} of {needed} {what}"
    return "little learnt" if se > 0.8 * prior_sd else "estimated"


class EstimateCollector:
    """Collects ``estimates`` from trials and prior beliefs; ``spreads``: logarithms of ``sigma`` and their errors."""

    def __init__(self, trials: Sequence[TrialFeatures], beliefs: dict[str, Belief]) -> None:
        self.trials, self.beliefs = trials, beliefs
        self.estimates: dict[str, Estimate] = {}
        self.spreads: list[tuple[float, float]] = []
        self.people = len({one.person for one in trials})

    def add(self, names: Sequence[str], fit: Fit, n: int, method: str) -> None:
        """Keep these terms of a fitted model, and the spread of the first term as one measurement of ``sigma``."""
        for name in names:
            self.estimates[name] = make_estimate(self.beliefs[name], fit.value[name], fit.se[name], n, method)
        log, se, first = fit.value[SPREAD], fit.se[SPREAD], names[0]
        self.spreads.append((log - math.log(parameter(first).effect), se))
        self.estimates[first] = msgspec.structs.replace(self.estimates[first], between=(math.exp(log), se))

    def capped(self, rows: Sequence[tuple[float, TrialFeatures, float]]) -> Sample:
        """A sample of (value, trial, greatest value that the device allows); values near it are lower bounds."""
        return timing_models.make_sample([(y, one.person, one.index, int(y >= CAPPED * most)) for y, one, most in rows])

    def median(self, name: str, values: Sequence[float], method: str, *, least: float) -> None:
        """Estimate a number that is the same for everybody by the median, because some measurements are wrong.

        ``least`` is the least error of the estimate, in the parameter's unit, however many measurements there are.
        """
        finite = np.array([value for value in values if math.isfinite(value) and value > 0.0])
        if len(finite):
            middle = float(np.median(finite))
            deviation = 1.4826 * float(np.median(np.abs(finite - middle))) if len(finite) > 1 else middle
            error = math.hypot(1.2533 * deviation / math.sqrt(len(finite)), least)
            self._combine(name, middle, error, len(finite), method)

    def rate(self, name: str, total: float, count: int, method: str, *, least: float) -> None:
        """Estimate the mean time between events at random times; ``least`` is the least relative error."""
        if count and total > 0.0:
            every = total / count
            self._combine(name, every, every * math.hypot(count**-0.5, least), count, method)

    def share(self, name: str, hits: int, count: int, method: str) -> None:
        """Estimate the probability of a hit."""
        if count:
            share = (hits + 0.5) / (count + 1.0)
            self._combine(name, share, math.sqrt(share * (1.0 - share) / count), count, method)

    def between_people(self) -> None:
        """Estimate ``sigma`` from all the spreads, weighted by their precision."""
        if not self.spreads:
            return
        logs, errors = (np.array(part) for part in zip(*self.spreads, strict=True))
        weights = 1.0 / np.maximum(errors, 0.05) ** 2
        at, se = float((weights * logs).sum() / weights.sum()), float(weights.sum() ** -0.5)
        value = math.exp(at)
        self._combine("sigma", value, value * se, self.people, f"spreads of {len(logs)} mixed models")

    def _combine(self, name: str, value: float, se: float, n: int, method: str) -> None:
        """Combine a value and its error, in the parameter's own unit, with the prior belief."""
        belief = self.beliefs[name]
        at, slope = _on(value, belief)
        error = max(abs(slope) * se, _LEAST_SE)
        weight, before = 1.0 / error**2, 1.0 / belief.sd**2
        mean = (weight * at + before * belief.mean) / (weight + before)
        self.estimates[name] = make_estimate(belief, mean, (weight + before) ** -0.5, n, method)


def renumber(people: Sequence[int]) -> Array:
    """The people's numbers, replaced by consecutive ones from 0."""
    return np.unique(np.array(people), return_inverse=True)[1].astype(int)


def _on(value: float, belief: Belief) -> tuple[float, float]:
    """The value on the belief's scale, and the slope of the scale there."""
    if belief.scale == "log":
        return math.log(value), 1.0 / value
    if belief.scale == "logit":
        return math.log(value / (1.0 - value)), 1.0 / (value * (1.0 - value))
    return value, 1.0
