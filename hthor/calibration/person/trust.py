"""One person's trust in the robots, from the ratings after the trials."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from hthor import rules, seeds
from hthor.calibration.from_logs.models import trust_model
from hthor.calibration.from_logs.trial_features import TrialFeatures
from hthor.calibration.person.measure import Measure, unknown, weighted
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.population import Population

_DRAWS, _GRID = 400, 79
_NO_RATINGS = "there was no rating: it is asked after trials with a robot"


def trust(trials: Sequence[TrialFeatures], population: Population) -> list[Measure]:
    """Trust at first, by the model of trust and the population's weights of experience, and the ratings themselves."""
    rated = [one.experience.rating for one in trials if one.experience.rating]
    if not rated:
        reason = [("mu0", ""), ("first_rating", ""), ("last_rating", "")]
        return [unknown(name, unit, _NO_RATINGS) for name, unit in reason]
    first = _at_first(trials, population)
    return [first, _rating("first_rating", rated[0], "the first"), _rating("last_rating", rated[-1], "the last")]


def _rating(name: str, value: int, which: str) -> Measure:
    return Measure(name=name, unit="", value=value, low=value, high=value, n=1, how=f"{which} rating, from 1 to 7")


def _at_first(trials: Sequence[TrialFeatures], population: Population) -> Measure:
    """The mean trust before the first trial under which the ratings are likely, for draws of the other parameters."""
    data = trust_model.make_trust_data([[one.experience for one in trials]], np.zeros(1, dtype=int))
    ratings, rated = data.rating[0], data.rating[0] > 0.0
    grid = np.linspace(0.5 / _GRID, 1.0 - 0.5 / _GRID, _GRID)
    noise = math.hypot(Parameters().sd_report, 1.0 / math.sqrt(12.0)) / (rules.TRUST_MAX - rules.TRUST_MIN)
    logs = []
    for k in range(_DRAWS):
        mean = population.parameters(population.pick(seeds.derive(0, "trust"), k))
        values = {name: math.log(getattr(mean, name)) for name in ("n0", "w_s", "w_f", "tau_s")}
        repeated = trust_model.repeat_session(data, len(grid))
        _, after = trust_model.mean_trust(repeated, {**values, "mu0": 0.0}, np.log(grid / (1.0 - grid)))
        share = (ratings - rules.TRUST_MIN) / (rules.TRUST_MAX - rules.TRUST_MIN)
        z = (share - after)[:, rated] / noise
        logs.append((-0.5 * z * z).sum(axis=1))
    value, low, high = weighted(grid, np.logaddexp.reduce(logs, axis=0))
    how = "ratings after each trial, and what the robot did in it; other parameters of trust as in the population"
    return Measure(name="mu0", unit="", value=value, low=low, high=high, n=int(rated.sum()), how=how)
