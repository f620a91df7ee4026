"""How often intervals of times, ratings and weighted successes hold the truth: `benchmarks.coverage --bounded`.

What people with a robot take is drawn as the sum of a level, what the task adds, what the person adds and noise (sd 1),
which is then made a time of at most 90 s, a time-weighted success or a rating from 1 to 7. Beside the interval that
hthor gives stands the mean with some standard errors, which can leave what is possible. Plays no trials.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from msgspec import Struct

from hthor.eval.metrics import registry
from hthor.eval.results import paired_difference
from hthor.eval.statistics import intervals, variance_components

LIMIT_S, GOOD_S = 90.0, 33.0
TASK_SD, PERSON_SD = 0.7, 0.5
SHARED = 0.6
"""Correlation of both robots' noise at the same occasion."""
_TRUTH = 400_000
"""Draws that the true mean is taken from."""


class Sort(Struct, frozen=True):
    """A metric: its name, how a latent value becomes one, and the levels that are tried."""

    metric: str
    value: Callable[[np.ndarray], np.ndarray]
    levels: tuple[float, ...]


def time_s(latent: np.ndarray) -> np.ndarray:
    """Seconds until the goal, the limit where that is not reached."""
    spent: np.ndarray = np.minimum(LIMIT_S, np.exp(4.0 + 0.5 * latent))
    return spent


def twsr(latent: np.ndarray) -> np.ndarray:
    """Success weighted by time."""
    spent = time_s(latent)
    return np.where(spent < LIMIT_S, GOOD_S / np.maximum(GOOD_S, spent), 0.0)


def trust(latent: np.ndarray) -> np.ndarray:
    """A rating from 1 to 7."""
    return np.clip(np.rint(4.0 + 1.2 * latent), 1.0, 7.0)


def count(latent: np.ndarray) -> np.ndarray:
    """How often something seldom happened."""
    return np.floor(np.exp(latent) / 2.0)


SORTS = (
    Sort("time_s", time_s, (-1.0, 0.5, 2.0)),
    Sort("twsr", twsr, (-1.0, 0.5, 2.0)),
    Sort("trust", trust, (-1.5, 0.0, 2.5)),
    Sort("sent", count, (-1.0, 0.5, 1.5)),
)


def designs() -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Which task and which person each trial has."""
    once = {people: (np.arange(10 * people), np.arange(10 * people) // 10) for people in (2, 3, 6, 18, 60)}
    return {f"{10 * people} tasks once, {people} people": design for people, design in once.items()}


def latent(tasks: np.ndarray, people: np.ndarray, level: float, repeats: int) -> Iterator[np.ndarray]:
    """Latent values (repeats, trials) of two equal robots."""
    chance = np.random.default_rng(17)
    of_task = TASK_SD * chance.normal(size=(repeats, int(tasks.max()) + 1))[:, tasks]
    of_person = PERSON_SD * chance.normal(size=(repeats, int(people.max()) + 1))[:, people]
    common = chance.normal(size=(repeats, len(tasks)))
    for _ in range(2):
        own = np.sqrt(SHARED) * common + np.sqrt(1.0 - SHARED) * chance.normal(size=common.shape)
        yield level + of_task + of_person + own


def truth(sort: Sort, level: float) -> float:
    """The mean over all tasks and people."""
    wide = np.sqrt(TASK_SD**2 + PERSON_SD**2 + 1.0)
    return float(sort.value(level + wide * np.random.default_rng(5).normal(size=_TRUTH)).mean())


def table(repeats: int) -> Iterator[str]:
    """Per cent of so many data sets whose interval holds the truth, mean width, and per cent that leave the bounds."""
    yield f"{'':36} | {'hthor':22} | {'mean ± t·se':22} | {'difference: hthor':22} | mean ± t·se"
    yield f"{'metric, true mean, design':36}" + " |  held   width  beyond " * 4
    for sort in SORTS:
        for level in sort.levels:
            for name, (tasks, people) in designs().items():
                yield _row(sort, level, name, tasks, people, repeats)


def _row(sort: Sort, level: float, name: str, tasks: np.ndarray, people: np.ndarray, repeats: int) -> str:
    one, other = (sort.value(values) for values in latent(tasks, people, level, repeats))
    metric = registry.get(sort.metric)
    mean, within, share = truth(sort, level), metric.range(LIMIT_S), metric.is_share
    found = variance_components.two_way_spread(one, tasks, people)
    apart = paired_difference.difference_spread(one - other, tasks, people, share=share)
    room = metric.width(LIMIT_S)
    plain, gap = (_plain(held) for held in (found, apart))
    told = [f"{sort.metric:7} {mean:5.2f} {name:23}"]
    for ends, true, most in (
        (intervals.confidence_interval(found, len(tasks), within), mean, within),
        (plain, mean, within),
        (paired_difference.interval_ends(apart, share=share, room=room), 0.0, (-room, room)),
        (gap, 0.0, (-room, room)),
    ):
        low, high = ends
        held = 100.0 * np.mean((low <= true) & (true <= high))
        beyond = 100.0 * np.mean((low < most[0] - 1e-9) | (high > most[1] + 1e-9))
        told.append(f"{held:5.1f}  {np.mean(high - low):6.2f}  {beyond:6.1f} ")
    return " | ".join(told)


def _plain(found: variance_components.MeanSpread) -> tuple[np.ndarray, np.ndarray]:
    """The mean and some standard errors."""
    half = intervals.student_quantile(found.freedom, (1.0 + intervals.LEVEL) / 2.0) * np.sqrt(found.variance)
    return found.mean - half, found.mean + half
