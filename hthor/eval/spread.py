"""How far a mean may be from the truth when trials share tasks and people; knows nothing of what is averaged.

A trial's value is taken as the sum of a mean, what its task adds, what its person adds, and the rest. The variances of
the three are worked out from sums of squares by their expectations (Henderson's first method), for any design: everyone
does everything, every task is done once, or anything between.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from msgspec import Struct

_TINY = 1e-300


class Spread(Struct, frozen=True, kw_only=True):
    """Means over trials, one for each row of values, the variances of these means, and their degrees of freedom.

    Each is an array of the rows' shape. The variance is never below that of independent trials.
    """

    mean: np.ndarray
    variance: np.ndarray
    freedom: np.ndarray


def codes(names: Sequence[object]) -> np.ndarray:
    """Each name's index among the distinct names in order of first appearance."""
    index: dict[object, int] = {}
    return np.array([index.setdefault(name, len(index)) for name in names], dtype=np.int64)


def two_way(values: np.ndarray, tasks: np.ndarray, people: np.ndarray) -> Spread:
    """The spread of a mean for new tasks and new people of the same populations.

    Where the variance between tasks or between people comes out negative, it is none, and the largest of what remains
    is taken. The degrees of freedom are Satterthwaite's.

    Args:
        values: (..., N) float64. tasks: (N,) indices from 0. people: (N,) indices from 0.
    """
    count = values.shape[-1]
    mean = values.mean(axis=-1)
    if count < 2:
        return Spread(mean=mean, variance=np.full_like(mean, np.inf), freedom=np.ones_like(mean))
    rest = values - mean[..., None]
    squares = {
        "e": (rest**2).sum(axis=-1),
        "t": (_sums(rest, tasks) ** 2).sum(axis=-1),
        "p": (_sums(rest, people) ** 2).sum(axis=-1),
    }
    sizes = {"e": np.ones(count), "t": _sizes(tasks), "p": _sizes(people)}
    held = {name: _variance(name, squares, sizes) for name in ("e", "et", "ep", "etp")}
    variance = np.maximum.reduce(list(held.values()))
    groups = {"e": count, "et": int(tasks.max()) + 1, "ep": int(people.max()) + 1}
    noise = sum(held[model] ** 2 / max(1, number - 1) for model, number in groups.items())
    freedom = np.clip(variance**2 / np.maximum(noise, _TINY), 1.0, count - 1.0)
    for model in ("ep", "et", "e"):  # where one of them says it all, what it rests on
        freedom = np.where(variance <= held[model] * (1.0 + 1e-9), max(1.0, groups[model] - 1.0), freedom)
    return Spread(mean=mean, variance=variance, freedom=freedom)


def _variance(model: str, squares: dict[str, np.ndarray], sizes: dict[str, np.ndarray]) -> np.ndarray:
    """Variance of the mean, in a model in which only these of tasks, people and the rest vary."""
    count = len(sizes["e"])
    expected = np.array([[_trace(one, other, sizes) for other in model] for one in model])
    wanted = np.array([sizes[one].sum() for one in model]) / count**2
    weights = np.linalg.pinv(expected.T) @ wanted  # where two of them are the same, as where every task is done once
    found: np.ndarray = sum(weight * squares[one] for weight, one in zip(weights.tolist(), model, strict=True))
    return found


def _trace(one: str, other: str, sizes: dict[str, np.ndarray]) -> float:
    """How much of the variance of ``other`` is in the squares of ``one``; ``sizes`` are of each trial's group."""
    count = len(sizes["e"])
    same = sizes[one].sum() if one == other else float(count)
    crossed = float((sizes[one] * sizes[other]).sum())
    return float(same - 2.0 * crossed / count + sizes[one].sum() * sizes[other].sum() / count**2)


def _sizes(groups: np.ndarray) -> np.ndarray:
    """For each trial, how many trials there are in its group."""
    sizes: np.ndarray = np.bincount(groups).astype(np.float64)[groups]
    return sizes


def _sums(values: np.ndarray, groups: np.ndarray) -> np.ndarray:
    """Sums within groups, (..., G)."""
    order = np.argsort(groups, kind="stable")
    starts = np.searchsorted(groups[order], np.arange(int(groups.max()) + 1))
    sums: np.ndarray = np.add.reduceat(values[..., order], starts, axis=-1)
    return sums
