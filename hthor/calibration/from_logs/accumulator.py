"""Where estimates are gathered: trials in, estimates and spreads out."""

from __future__ import annotations

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
from hthor.calibration.from_logs.trial_features import Reduced
from hthor.humans.population.parameter_registry import parameter

_CAPPED = 0.985
"""Who comes so near to what the device allows might be faster without it."""
_LEAST_SE = 1e-3


class Desk:
    """The trials, what was believed of each parameter, and what was ``found``.

    ``spreads`` are logarithms of ``sigma`` with their standard errors, one from each model with effects.
    """

    def __init__(self, trials: Sequence[Reduced], beliefs: dict[str, Belief]) -> None:
        self.trials, self.beliefs = trials, beliefs
        self.found: dict[str, Estimate] = {}
        self.spreads: list[tuple[float, float]] = []
        self.people = len({one.person for one in trials})

    def keep(self, names: Sequence[str], fit: Fit, n: int, method: str) -> None:
        """These terms of a model are estimates."""
        for name in names:
            self.found[name] = estimate.of_fit(self.beliefs[name], fit, n, method)

    def spread(self, name: str, fit: Fit) -> None:
        """How much people differ in this parameter tells how much they differ in all."""
        log, se = fit.value[SPREAD], fit.se[SPREAD]
        self.spreads.append((log - math.log(parameter(name).effect), se))
        if name in self.found:
            self.found[name] = msgspec.structs.replace(self.found[name], between=(math.exp(log), se))

    def capped(self, rows: Sequence[tuple[float, Reduced, float]]) -> Sample:
        """Numbers of trials with the most that the device allows; those near that are lower bounds."""
        return timing_models.sample([(y, one.person, one.index, int(y >= _CAPPED * most)) for y, one, most in rows])

    def median(self, name: str, values: Sequence[float], method: str, *, least: float) -> None:
        """A number that is the same for everybody, where some measurements are wrong altogether.

        Args:
            least: how exact such a measurement can be at best, in the parameter's unit, however many there are.
        """
        held = np.array([value for value in values if math.isfinite(value) and value > 0.0])
        if len(held):
            middle = float(np.median(held))
            deviation = 1.4826 * float(np.median(np.abs(held - middle))) if len(held) > 1 else middle
            error = math.hypot(1.2533 * deviation / math.sqrt(len(held)), least)
            self._settle(name, middle, error, len(held), method)

    def rate(self, name: str, total: float, count: int, method: str, *, least: float) -> None:
        """The mean time from one event to the next, of events that come at random; ``least`` is relative."""
        if count and total > 0.0:
            every = total / count
            self._settle(name, every, every * math.hypot(count**-0.5, least), count, method)

    def share(self, name: str, hits: int, count: int, method: str) -> None:
        """The chance of a hit."""
        if count:
            share = (hits + 0.5) / (count + 1.0)
            self._settle(name, share, math.sqrt(share * (1.0 - share) / count), count, method)

    def between_people(self) -> None:
        """``sigma`` from all the spreads, each as good as it is exact."""
        if not self.spreads:
            return
        logs, errors = (np.array(part) for part in zip(*self.spreads, strict=True))
        weights = 1.0 / np.maximum(errors, 0.05) ** 2
        at, se = float((weights * logs).sum() / weights.sum()), float(weights.sum() ** -0.5)
        value = math.exp(at)
        self._settle("sigma", value, value * se, self.people, f"spreads of {len(logs)} mixed models")

    def _settle(self, name: str, value: float, se: float, n: int, method: str) -> None:
        """A value with its error in the parameter's own unit, brought together with what was believed before."""
        belief = self.beliefs[name]
        at, slope = _on(value, belief)
        error = max(abs(slope) * se, _LEAST_SE)
        weight, before = 1.0 / error**2, 1.0 / belief.sd**2
        mean = (weight * at + before * belief.mean) / (weight + before)
        self.found[name] = estimate.of(belief, mean, (weight + before) ** -0.5, n, method)


def numbers(people: Sequence[int]) -> Array:
    """People numbered anew, from 0."""
    return np.unique(np.array(people), return_inverse=True)[1].astype(int)


def _on(value: float, belief: Belief) -> tuple[float, float]:
    """The value on the belief's scale, and the scale's slope there."""
    if belief.scale == "log":
        return math.log(value), 1.0 / value
    if belief.scale == "logit":
        return math.log(value / (1.0 - value)), 1.0 / (value * (1.0 - value))
    return value, 1.0
