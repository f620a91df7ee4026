"""Collects estimates of parameters and of the spread between people, one estimator after the other."""

import math
from collections.abc import Sequence

import msgspec
import numpy as np

from hthor.calibration.from_logs import estimate
from hthor.calibration.from_logs.estimate import Estimate
from hthor.calibration.from_logs.models import timing_models
from hthor.calibration.from_logs.models.mixed_effects import Array, Fit
from hthor.calibration.from_logs.models.priors import Belief
from hthor.calibration.from_logs.models.timing_models import SPREAD, Sample
from hthor.calibration.from_logs.trial_features import TrialFeatures
from hthor.humans.population.parameter_registry import parameter

_CAPPED = 0.985
"""Measurements this near to what the device allows are lower bounds: the person might be faster without it."""
_LEAST_SE = 1e-3


class EstimateCollector:
    """The trials, the prior belief about each parameter, and the ``estimates`` so far.

    ``spreads`` are logarithms of ``sigma`` with their standard errors, one from each model with random effects.
    """

    def __init__(self, trials: Sequence[TrialFeatures], beliefs: dict[str, Belief]) -> None:
        self.trials, self.beliefs = trials, beliefs
        self.estimates: dict[str, Estimate] = {}
        self.spreads: list[tuple[float, float]] = []
        self.people = len({one.person for one in trials})

    def add(self, names: Sequence[str], fit: Fit, n: int, method: str) -> None:
        """Keep these terms of a fitted model as estimates."""
        for name in names:
            self.estimates[name] = estimate.estimate_from_fit(self.beliefs[name], fit, n, method)

    def spread(self, name: str, fit: Fit) -> None:
        """Note the spread between people in this parameter, as one measurement of ``sigma``."""
        log, se = fit.value[SPREAD], fit.se[SPREAD]
        self.spreads.append((log - math.log(parameter(name).effect), se))
        if name in self.estimates:
            self.estimates[name] = msgspec.structs.replace(self.estimates[name], between=(math.exp(log), se))

    def capped(self, rows: Sequence[tuple[float, TrialFeatures, float]]) -> Sample:
        """A sample of (value, trial, most that the device allows); values near that are lower bounds."""
        return timing_models.make_sample(
            [(y, one.person, one.index, int(y >= _CAPPED * most)) for y, one, most in rows]
        )

    def median(self, name: str, values: Sequence[float], method: str, *, least: float) -> None:
        """Estimate a number that is the same for everybody by its median, as some measurements are plainly wrong.

        Args:
            least: the least error that such a measurement can have, in the parameter's unit, however many there are.
        """
        finite = np.array([value for value in values if math.isfinite(value) and value > 0.0])
        if len(finite):
            middle = float(np.median(finite))
            deviation = 1.4826 * float(np.median(np.abs(finite - middle))) if len(finite) > 1 else middle
            error = math.hypot(1.2533 * deviation / math.sqrt(len(finite)), least)
            self._combine(name, middle, error, len(finite), method)

    def rate(self, name: str, total: float, count: int, method: str, *, least: float) -> None:
        """Estimate the mean time from one event to the next, of events at random times; ``least`` is relative."""
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
        self.estimates[name] = estimate.make_estimate(belief, mean, (weight + before) ** -0.5, n, method)


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
