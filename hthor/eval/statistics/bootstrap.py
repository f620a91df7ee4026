"""The two-way "pigeonhole" bootstrap: tasks and participants are resampled independently.

For what has no formula, such as a rank. All rows of values meet the same samples, so that pairing is kept.
"""

from collections.abc import Iterator

import numpy as np

from hthor import seeds

DRAWS = 2000
"""Samples."""
_AT_ONCE = 250
_STEPS = 1e6
"""Values are counted in millionths: sums of whole numbers are the same on every machine."""


def bootstrap_means(
    values: np.ndarray, tasks: np.ndarray, people: np.ndarray, *, name: str, draws: int = DRAWS
) -> np.ndarray:
    """Means of each row over each sample, (..., at most ``draws``).

    Where every task was done once, their spread takes the noise of single trials for three times what it is. How the
    rows' means hang together they show all the same.

    Args:
        values: (..., N) float64, in millionths at the finest. tasks, people: (N,) indices from 0.
        name: of the chance stream; equal names give equal samples.
    """
    whole = np.rint(values * _STEPS)
    found = []
    for weights in _weights(tasks, people, name, draws):
        total = weights.sum(axis=1)
        held = total > 0.0  # a sample can miss every trial where few tasks met few people
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
    """How often each of ``sort`` things is drawn, (draws, sort)."""
    drawn = chance.integers(0, sort, (draws, sort)) + sort * np.arange(draws)[:, None]
    counts: np.ndarray = np.bincount(drawn.ravel(), minlength=draws * sort).reshape(draws, sort).astype(np.float64)
    return counts
