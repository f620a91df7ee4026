"""How far a mean may be from the truth when trials share tasks and people.

A trial's value is modelled as the sum of a mean, a part of its task, a part of its person, and a rest. The variances of
the three are estimated from sums of squares by their expectations (Henderson's first method), for any design: everyone
does everything, every task is done once, or anything between.
"""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct

_TINY = 1e-300
_UNEVEN = 2.7
"""Factor of `_uneven`, found by simulation: 2.6 to 3 makes no difference; 2 would be right for normal sums."""
_LEAST = 0.8
"""Lowest variance, as a share of that of independent trials, where trials of a task or person correlate negatively."""


class MeanSpread(Struct, frozen=True, kw_only=True):
    """Means over trials, one for each row of values, the variances of these means, and their degrees of freedom.

    Each is an array of the rows' shape. ``single`` is the variance of single values. ``uneven`` is degrees of freedom
    estimated from the squared sums of tasks and of people: few where a few tasks or people make up most of the
    variance.
    """

    mean: np.ndarray
    variance: np.ndarray
    freedom: np.ndarray
    uneven: np.ndarray
    single: np.ndarray


def group_codes(names: Sequence[object]) -> np.ndarray:
    """Each name's index among the distinct names in order of first appearance."""
    index: dict[object, int] = {}
    return np.array([index.setdefault(name, len(index)) for name in names], dtype=np.int64)


def two_way_spread(
    values: np.ndarray, tasks: np.ndarray, people: np.ndarray, *, differences: bool = False
) -> MeanSpread:
    """The spread of a mean for new tasks and new people of the same populations.

    The largest variance of the models with and without tasks and people is taken, so that a negative estimate counts as
    0. The degrees of freedom are Satterthwaite's.

    Args:
        values: (..., N) float64. tasks: (N,) indices from 0. people: (N,) indices from 0.
        differences: whether values are differences of two robots. Tasks and people often add nothing to these, and the
            largest of several estimates of 0 is too large: all three variances are used as estimated.
    """
    count = values.shape[-1]
    mean = values.mean(axis=-1)
    if count < 2:
        one = np.ones_like(mean)
        return MeanSpread(mean=mean, variance=np.full_like(mean, np.inf), freedom=one, uneven=one, single=one)
    rest = values - mean[..., None]
    by = {"e": rest**2, "t": _sums(rest, tasks) ** 2, "p": _sums(rest, people) ** 2}
    squares = {name: found.sum(axis=-1) for name, found in by.items()}
    sizes = {"e": np.ones(count), "t": _sizes(tasks), "p": _sizes(people)}
    held = {name: _variance(name, squares, sizes) for name in ("e", "et", "ep", "etp")}
    some = [held["e"], held["etp"]] if differences else list(held.values())
    variance = np.maximum.reduce(some)
    freedom = _freedom(variance, held, {"e": count, "et": by["t"].shape[-1], "ep": by["p"].shape[-1]})
    return MeanSpread(
        mean=mean,
        variance=np.maximum(held["etp"], _LEAST * held["e"]) if differences else variance,
        freedom=freedom,
        uneven=np.minimum(_uneven(by["t"], count), _uneven(by["p"], count)),
        single=squares["e"] / count,
    )


def _freedom(variance: np.ndarray, held: dict[str, np.ndarray], groups: dict[str, int]) -> np.ndarray:
    """Satterthwaite's degrees of freedom of a sum of variances, which are estimated from so many groups each."""
    noise = sum(held[model] ** 2 / max(1, number - 1) for model, number in groups.items())
    freedom = np.clip(variance**2 / np.maximum(noise, _TINY), 1.0, groups["e"] - 1.0)
    for model in ("ep", "et", "e"):  # where one model gives all of it, that model's groups
        freedom = np.where(variance <= held[model] * (1.0 + 1e-9), max(1.0, groups[model] - 1.0), freedom)
    return freedom


def _uneven(squares: np.ndarray, count: int) -> np.ndarray:
    """Degrees of freedom of the mean of squares, (..., G), fewer for unequal squares; infinite for single trials."""
    total, groups = squares.sum(axis=-1), squares.shape[-1]
    if groups == count:
        return np.full_like(total, np.inf)
    apart = (squares**2).sum(axis=-1) - total**2 / groups
    told = (total > _TINY) & (apart > 1e-12 * total**2)
    return np.where(told, _UNEVEN * total**2 / np.where(told, apart, 1.0), np.inf)


def _variance(model: str, squares: dict[str, np.ndarray], sizes: dict[str, np.ndarray]) -> np.ndarray:
    """Variance of the mean in a model with only these parts: "t" for tasks, "p" for people, "e" for the rest."""
    count = len(sizes["e"])
    expected = np.array([[_trace(one, other, sizes) for other in model] for one in model])
    wanted = np.array([sizes[one].sum() for one in model]) / count**2
    weights = np.linalg.pinv(expected.T) @ wanted  # pinv: parts are equal if every task is done once
    found: np.ndarray = sum(weight * squares[one] for weight, one in zip(weights.tolist(), model, strict=True))
    return found


def _trace(one: str, other: str, sizes: dict[str, np.ndarray]) -> float:
    """How often the variance of ``other`` is expected in the squares of ``one``; ``sizes``: of each trial's group."""
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
    return np.add.reduceat(values[..., order], starts, axis=-1)
