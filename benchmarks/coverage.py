"""How often 95 % intervals hold the truth, by simulation: `python -m benchmarks.coverage`; plays no trials.

A trial succeeds when a level, what its task adds, what its person adds and its own noise (sd 1) sum to more than 0.
Two robots share task and person; each has its own noise, or partly the same.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from statistics import NormalDist

import numpy as np

from benchmarks import bounded
from hthor.eval.results import paired_difference
from hthor.eval.statistics import intervals, variance_components

NORMAL = NormalDist()
RATES = (0.5, 0.75, 0.95)
SPREADS = ((1.0, 0.4), (1.0, 0.0), (0.3, 0.8))
"""How much tasks differ, and people."""
SHARED = 0.6
"""Correlation of both robots' noise at the same occasion."""


def designs() -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Which task and which person each trial has."""
    return {
        "30 tasks x 6 people, all": crossed(30, 6),
        "30 tasks x 18 people, all": crossed(30, 18),
        "60 tasks once, 6 people": (np.arange(60), np.arange(60) // 10),
        "600 tasks once, 60 people": (np.arange(600), np.arange(600) // 10),
        "2000 tasks once, 200 people": (np.arange(2000), np.arange(2000) // 10),
        "30 tasks, 18 people, ten each": dealt(30, 18),
        "60 tasks, 60 people, ten each": dealt(60, 60),
    }


def crossed(tasks: int, people: int) -> tuple[np.ndarray, np.ndarray]:
    """Everyone does everything."""
    return np.repeat(np.arange(tasks), people), np.tile(np.arange(people), tasks)


def dealt(tasks: int, people: int) -> tuple[np.ndarray, np.ndarray]:
    """Everyone does ten; when the tasks are used up they are mixed anew."""
    chance = np.random.default_rng(1)
    decks = [chance.permutation(tasks) for _ in range(-(-people * 10 // tasks))]
    return np.concatenate(decks)[: people * 10], np.arange(people * 10) // 10


def outcomes(
    tasks: np.ndarray, people: np.ndarray, rate: float, task_sd: float, person_sd: float, repeats: int
) -> Iterator[np.ndarray]:
    """Successes (repeats, trials) of two robots of the same true rate."""
    chance = np.random.default_rng(11)
    level = NORMAL.inv_cdf(rate) * math.sqrt(task_sd**2 + person_sd**2 + 1.0)
    of_task = task_sd * chance.normal(size=(repeats, int(tasks.max()) + 1))[:, tasks]
    of_person = person_sd * chance.normal(size=(repeats, int(people.max()) + 1))[:, people]
    common = chance.normal(size=(repeats, len(tasks)))
    for _ in range(2):
        own = math.sqrt(SHARED) * common + math.sqrt(1.0 - SHARED) * chance.normal(size=common.shape)
        yield (level + of_task + of_person + own > 0.0).astype(float)


def pigeonhole(values: np.ndarray, tasks: np.ndarray, people: np.ndarray, rate: float) -> float:
    """Share of data sets whose bootstrap interval holds the rate."""
    chance, held, draws = np.random.default_rng(2), 0, 300
    kinds, persons = int(tasks.max()) + 1, int(people.max()) + 1
    for row in values:
        weights = chance.multinomial(kinds, np.full(kinds, 1 / kinds), draws)[:, tasks].astype(float)
        weights *= chance.multinomial(persons, np.full(persons, 1 / persons), draws)[:, people]
        sums = weights.sum(axis=1)
        means = (weights @ row)[sums > 0] / sums[sums > 0]
        low, high = np.quantile(means, [0.025, 0.975])
        held += low <= rate <= high
    return held / len(values)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=2000, help="data sets a row")
    parser.add_argument("--bootstrap", type=int, default=200, help="of which the bootstrap is tried on so many")
    parser.add_argument("--bounded", action="store_true", help="of times, ratings and weighted successes instead")
    wanted = parser.parse_args()
    if wanted.bounded:
        for line in bounded.table(wanted.repeats):
            print(line, flush=True)
        return
    print(f"{'design':30} rate  sd task/person   rate held  width | difference held | bootstrap held")
    for name, (tasks, people) in designs().items():
        repeats = min(wanted.repeats, 2_000_000 // len(tasks))
        for rate in RATES:
            for task_sd, person_sd in SPREADS:
                one, other = outcomes(tasks, people, rate, task_sd, person_sd, repeats)
                found = variance_components.two_way_spread(one, tasks, people)
                low, high = intervals.confidence_interval(found, len(tasks), intervals.SHARE)
                least, most = paired_difference.interval_ends(
                    paired_difference.difference_spread(one - other, tasks, people, share=True), share=True
                )
                held = 100.0 * np.mean((low <= rate) & (rate <= high))
                equal = 100.0 * np.mean((least <= 0.0) & (most >= 0.0))
                old = 100.0 * pigeonhole(one[: wanted.bootstrap], tasks, people, rate) if wanted.bootstrap else math.nan
                print(
                    f"{name:30} {rate:.2f}  {task_sd:.1f}/{person_sd:.1f}         {held:6.1f}  "
                    f"{np.mean(high - low):7.3f} |  {equal:6.1f}         |  {old:6.1f}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
