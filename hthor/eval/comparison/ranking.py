"""Ranks of agents, with intervals of the ranks and ties.

All agents have played the same trials. An agent's rank is one more than the number of agents that are significantly
better, as `hthor compare` finds it: paired, over tasks and people, adjusted by Holm for all pairs at once.
"""

import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.eval.results import paired_difference
from hthor.eval.statistics import intervals
from hthor.eval.statistics.variance_components import MeanSpread

STREAM = "ranking"
"""The name of the bootstrap's stream of random numbers."""
DRAWS = 2000
"""Samples of the bootstrap."""
_AT_ONCE = 250
_STEPS = 1e6
"""Values are counted in millionths: sums of integers are the same on every machine."""


class Rank(Struct, frozen=True, kw_only=True):
    """An agent's place: 1 is the best.

    Attributes:
        rank: one more than the number of agents that are significantly better, and never less than the rank of an agent
            with a higher mean.
        interval: the ranks that are not excluded at 95 %, for new tasks and new people.
        ties: indices of the agents that do not differ significantly from this agent, in ascending order.
    """

    rank: int
    interval: tuple[int, int]
    ties: tuple[int, ...]


def rank_agents(outcomes: np.ndarray, tasks: np.ndarray, people: np.ndarray) -> tuple[Rank, ...]:
    """The rank of each agent.

    The interval begins at 1 plus the number of agents that are surely better, and ends at the number of agents minus
    those that are surely worse: this agent's differences from all others are judged simultaneously at 95 %. The level
    that this needs is estimated from samples of tasks and people, the same for all agents ("pigeonhole" bootstrap of
    the largest deviation); the intervals then follow the same formula as everywhere else.

    Args:
        outcomes: (A, N), shares from 0 to 1, such as successes. tasks, people: (N,) indices from 0.
    """
    count = len(outcomes)
    versus = [paired_difference.difference_spread(outcomes - one, tasks, people, share=True) for one in outcomes]
    better = (adjusted_p_values(versus) < 1.0 - intervals.LEVEL) & (np.array([found.mean for found in versus]) > 0.0)
    told = better | better.T  # better[a, b]: agent b is better than agent a
    plain = 1 + better.sum(axis=1)
    totals = np.rint(outcomes * 1e6).sum(axis=1)  # integers, so that equal means compare as equal
    low, high = _excluded(versus, outcomes, tasks, people)
    found = []
    for one in range(count):
        rank = int(plain[totals >= totals[one]].max())
        ends = (min(rank, 1 + int(low[one])), max(rank, count - int(high[one])))
        ties = tuple(other for other in range(count) if other != one and not told[one, other])
        found.append(Rank(rank=rank, interval=ends, ties=ties))
    return tuple(found)


def adjusted_p_values(versus: Sequence[MeanSpread]) -> np.ndarray:
    """Holm-adjusted p-values of the agents' differences, (A, A); ``versus``: the spreads of all agents minus each."""
    pairs = list(itertools.combinations(range(len(versus)), 2))
    variances = [paired_difference.null_variance(found, share=True) for found in versus]
    p = paired_difference.holm_adjusted(
        [
            paired_difference.p_value(
                float(versus[one].mean[other]), float(variances[one][other]), float(versus[one].freedom[other])
            )
            for one, other in pairs
        ]
    )
    held = np.ones((len(versus), len(versus)))
    for (one, other), value in zip(pairs, p, strict=True):
        held[one, other] = held[other, one] = value
    return held


def _excluded(
    versus: Sequence[MeanSpread], outcomes: np.ndarray, tasks: np.ndarray, people: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """For each agent, how many others are surely better and how many surely worse, all judged simultaneously."""
    count = len(outcomes)
    drawn = bootstrap_means(outcomes, tasks, people, name=STREAM)
    off = drawn - outcomes.mean(axis=1)[:, None]
    better, worse = np.zeros(count, dtype=int), np.zeros(count, dtype=int)
    for one in range(count):
        gaps = off[one] - off  # errors of each sample's differences
        sd = np.sqrt((gaps**2).mean(axis=1))
        moving = sd > 1e-9
        largest = (np.abs(gaps[moving]) / sd[moving, None]).max(axis=0) if moving.any() else np.zeros(1)
        far = max(float(np.quantile(largest, intervals.LEVEL)), intervals.NORMAL)
        level = 1.0 - math.erfc(far / math.sqrt(2.0)) / 2.0
        least, most = paired_difference.interval_ends(versus[one], share=True, level=level)
        others = np.arange(count) != one
        better[one] = int((others & (least > 0.0)).sum())
        worse[one] = int((others & (most < 0.0)).sum())
    return better, worse


def bootstrap_means(
    values: np.ndarray, tasks: np.ndarray, people: np.ndarray, *, name: str, draws: int = DRAWS
) -> np.ndarray:
    """Means of each row over each sample of the two-way "pigeonhole" bootstrap, (..., at most ``draws``).

    Tasks and participants are resampled independently; all rows get the same samples, so that pairing is kept. Where
    every task was done once, the spread of the means contains the noise of single trials three times; correlations
    between rows are right nevertheless.

    Args:
        values: (..., N) float64, in millionths at the finest. tasks, people: (N,) indices from 0.
        name: the name of the stream of random numbers; equal names give equal samples.
    """
    whole = np.rint(values * _STEPS)
    found = []
    for weights in _weights(tasks, people, name, draws):
        total = weights.sum(axis=1)
        held = total > 0.0  # with few tasks and people, a sample may contain no trial
        found.append(whole @ weights[held].T / total[held] / _STEPS)
    drawn: np.ndarray = np.concatenate(found, axis=-1)
    return drawn if drawn.shape[-1] else values.mean(axis=-1, keepdims=True)


def _weights(tasks: np.ndarray, people: np.ndarray, name: str, draws: int) -> Iterator[np.ndarray]:
    """How often each trial is in each sample, (some, N) at a time."""
    chance = np.random.Generator(np.random.Philox(key=seeds.derive(0, "bootstrap", name)))
    for begin in range(0, draws, _AT_ONCE):
        some = min(_AT_ONCE, draws - begin)
        of_task = _counts(chance, int(tasks.max()) + 1, some)
        of_person = _counts(chance, int(people.max()) + 1, some)
        yield of_task[:, tasks] * of_person[:, people]


def _counts(chance: np.random.Generator, sort: int, draws: int) -> np.ndarray:
    """How often each of ``sort`` items is drawn, (draws, sort)."""
    drawn = chance.integers(0, sort, (draws, sort)) + sort * np.arange(draws)[:, None]
    return np.bincount(drawn.ravel(), minlength=draws * sort).reshape(draws, sort).astype(np.float64)
