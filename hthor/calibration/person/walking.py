"""How one person walks, turns and starts, measured from their stick and their path."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import mean, median
from typing import NamedTuple

import numpy as np

from hthor import rules
from hthor.calibration.from_logs.estimate import CAPPED
from hthor.calibration.from_logs.trial_features import Trial, TrialFeatures
from hthor.calibration.person.measure import Measure, lowest, middle, typical, unknown
from hthor.humans.population.parameters import Parameters
from hthor.types import HUMAN
from hthor.types.events import Inputs

_LEAST_TRIALS, _LEAST_WAYS = 3, 5
_ERROR = 0.02
"""Relative error that all speeds of a log have in common, as its poses are 0.2 s apart. Our choice."""
_START_SHARE = 0.9
_STEPS = 6


class Practice(NamedTuple):
    """The gain by which people become faster in a session: the population's mean, and how far its draws are from it."""

    mean: float
    sd: float

    def factor(self, index: int) -> float:
        """How many times faster than in the first trial people are in this trial of a session."""
        return 1.0 + self.mean * _practised(index)

    def error(self, indices: Sequence[int]) -> float:
        """The relative error of `factor` that these trials have in common."""
        return mean(self.sd * _practised(index) / self.factor(index) for index in indices)


def _practised(index: int) -> float:
    return 1.0 - math.exp(-index / Parameters().n_learn)


def walking(features: Sequence[TrialFeatures], practice: Practice) -> list[Measure]:
    """The parameters of walking."""
    return [
        _pace(features, practice),
        _turning(features),
        _guided(features),
        _start(features),
    ]


def _pace(trials: Sequence[TrialFeatures], practice: Practice) -> Measure:
    name, how = "v_pace", "how far the stick was pushed under way, without reading or following a map"
    walks = [(one.walk, one.index) for one in trials if one.walk is not None and not math.isnan(one.walk.pace)]
    if len(walks) < _LEAST_TRIALS:
        return unknown(name, "m/s", f"there were {len(walks)} trials with a long enough walk; it takes {_LEAST_TRIALS}")
    full = walks[0][0].full
    if median(walk.pace for walk, _ in walks) >= CAPPED * full:
        # practice takes slower people there later, so the earliest trial at full stick says the most
        first = min(index for walk, index in walks if walk.pace >= CAPPED * full)
        least = lowest(CAPPED * full / practice.factor(first), error=math.hypot(_ERROR, practice.error([first])))
        words = f"{how}; keys and a stick that is pushed all the way go no faster"
        return _at_least(least, name=name, unit="m/s", n=len(walks), how=words)
    error = math.hypot(_ERROR, practice.error([index for _, index in walks]))
    value, low, high = typical([walk.pace / practice.factor(index) for walk, index in walks], error=error)
    return Measure(name=name, unit="m/s", value=value, low=low, high=high, n=len(walks), how=how)


def _turning(trials: Sequence[TrialFeatures]) -> Measure:
    name, how = "omega", "the speed of turns of more than 45 degrees"
    turns = [(turn, one.walk.fastest) for one in trials if one.walk is not None for turn in one.walk.turns]
    if len(turns) < _LEAST_TRIALS:
        return unknown(name, "rad/s", f"there were {len(turns)} large turns; it takes {_LEAST_TRIALS}")
    rates = [rate for rate, _ in turns]
    fastest = turns[0][1]
    if median(rates) >= CAPPED * fastest:
        words = f"{how}; the body turns no faster"
        return _at_least(lowest(CAPPED * fastest, error=_ERROR), name=name, unit="rad/s", n=len(turns), how=words)
    value, low, high = typical(rates, error=_ERROR)
    return Measure(name=name, unit="rad/s", value=value, low=low, high=high, n=len(turns), how=how)


def _at_least(least: float, *, name: str, unit: str, n: int, how: str) -> Measure:
    """A bound: the least speed with which a person would look like this one."""
    return Measure(name=name, unit=unit, value=least, low=least, high=math.inf, bound="at least", n=n, how=how)


def _guided(trials: Sequence[TrialFeatures]) -> Measure:
    name, how = "k_map", "the pace after a confirmed message, compared with the pace elsewhere"
    ratios = [ratio for one in trials if one.walk is not None for ratio in one.walk.guided]
    if len(ratios) < _LEAST_WAYS:
        words = f"walking at full speed, or fewer than {_LEAST_WAYS} ways after a confirmed message, show no slowing"
        return unknown(name, "", words)
    value, low, high = middle(ratios, error=_ERROR)
    return Measure(name=name, unit="", value=value, low=low, high=high, n=len(ratios), how=how)


def _start(trials: Sequence[TrialFeatures]) -> Measure:
    starts = [one.walk.start for one in trials if one.walk is not None and one.walk.start > 0.0]
    if len(starts) < _LEAST_TRIALS:
        return unknown("t_on", "s", f"there were {len(starts)} trials with a move; it takes {_LEAST_TRIALS}")
    value, low, high = typical(starts, error=rules.TICK_S / median(starts))
    return Measure(name="t_on", unit="s", value=value, low=low, high=high, n=len(starts), how="the first move or turn")


def look_round(trials: Sequence[Trial]) -> Measure:
    """By how much the person had turned when they took their first step."""
    turned = []
    for one in trials:
        path = np.array(one.record.paths[HUMAN], dtype=float) / 1000.0
        gone = np.flatnonzero(np.hypot(path[:, 0] - path[0, 0], path[:, 1] - path[0, 1]) > 0.05)
        if len(gone):
            turns = np.angle(np.exp(1j * np.diff(path[: gone[0] + 1, 2])))
            turned.append(float(np.abs(turns).sum()))
    if len(turned) < _LEAST_TRIALS:
        return unknown("look_round", "rad", f"there were {len(turned)} trials with a step; it takes {_LEAST_TRIALS}")
    order = sorted(turned)
    return Measure(
        name="look_round",
        unit="rad",
        value=median(turned),
        low=order[len(order) // 5],
        high=order[-1 - len(order) // 5],
        n=len(turned),
        how="the angle turned before the first step of a trial; the interval is that of the middle trials",
    )


def starting(trials: Sequence[Trial]) -> Measure:
    """[s] From standing to nine tenths of the speed then reached, from the set-points of people at pages."""
    rises = [
        rise for one in trials for entry in one.record.journal if isinstance(entry, Inputs) for rise in rises_of(entry)
    ]
    if len(rises) < _LEAST_TRIALS:
        return unknown("rise_s", "s", "only people at pages have a stick that is read sixty times a second")
    middle, order = median(rises), sorted(rises)
    return Measure(
        name="rise_s",
        unit="s",
        value=middle,
        low=order[len(order) // 20],
        high=order[-1 - len(order) // 20],
        n=len(rises),
        how="from the first push of the stick to nine tenths of the speed; the interval has nine of ten starts",
    )


def rises_of(entry: Inputs) -> list[float]:
    """How long [s] each start from standing took in one trial."""
    rows = np.array(entry.runs, dtype=float).reshape(-1, 6)
    at = (rows[:, 0] + rows[:, 1] / _STEPS) * rules.TICK_S
    speed = np.hypot(rows[:, 2], rows[:, 3])
    found, k = [], 0
    while k < len(rows):
        if speed[k] == 0.0 or (k and speed[k - 1] > 0.0):
            k += 1
            continue
        end = next((n for n in range(k, len(rows)) if speed[n] == 0.0), len(rows))
        reached = next(n for n in range(k, end) if speed[n] >= _START_SHARE * speed[k:end].max())
        found.append(float(at[reached] - at[k]))
        k = end
    return found
