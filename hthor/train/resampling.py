"""Means over episodes with intervals, by a bootstrap over houses and, where there are several, over checkpoints.

Episodes in one house resemble each other, and so do those of one checkpoint, so whole houses and whole checkpoints are
drawn again. All robots get the same draws of houses, which keeps their differences paired.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor import seeds
from hthor.eval.statistics.intervals import LEVEL

DRAWS = 10_000
_DIGITS = 6
_Floats = NDArray[np.float64]


class Rating(Struct, frozen=True, kw_only=True):
    """A mean and its 95 % interval; None where there was nothing to average."""

    mean: float | None
    ci95: tuple[float, float] | None


class Sums(NamedTuple):
    """A measure of what a robot did, added up by checkpoint and house.

    Attributes:
        total: (checkpoints, houses) its sums. episodes: (checkpoints, houses) how many numbers were added.
    """

    total: _Floats
    episodes: _Floats

    @property
    def mean(self) -> float:
        """The mean over all episodes."""
        return float(self.total.sum() / self.episodes.sum())


def add_up(values: _Floats, counted: NDArray[np.bool_], house: NDArray[np.int64]) -> Sums:
    """Sums of values (checkpoints, E) over the episodes that are ``counted`` (E,), by their houses (E,)."""
    houses = np.unique(house)
    of_house = (house[None, :] == houses[:, None]) & counted
    count = np.tile(of_house.sum(axis=1), (len(values), 1))
    return Sums(values @ of_house.T.astype(np.float64), count.astype(np.float64))


def rate(sums: Sums, name: str) -> Rating:
    """The mean of one robot; ``name`` is that of its checkpoints, see `difference`."""
    if not sums.episodes.any():
        return Rating(mean=None, ci95=None)
    return _rating(sums.mean, _drawn(sums, name))


def difference(one: Sums, other: Sums, names: Sequence[str]) -> Rating:
    """How much larger the mean of one robot is than another's.

    Args:
        names: those of their checkpoints. Robots of the same name get the same draws of checkpoints.
    """
    if not one.episodes.any():
        return Rating(mean=None, ci95=None)
    return _rating(one.mean - other.mean, _drawn(one, names[0]) - _drawn(other, names[1]))


def _drawn(sums: Sums, name: str) -> _Floats:
    """(DRAWS,) means of a robot in houses and with checkpoints that were drawn again."""
    checkpoints, houses = sums.total.shape
    of_house, of_checkpoint = _weights("houses", houses), _weights(f"checkpoints {name}", checkpoints)
    total = ((of_checkpoint @ sums.total) * of_house).sum(axis=1)
    count = ((of_checkpoint @ sums.episodes) * of_house).sum(axis=1)
    held = count > 0.0
    return np.where(held, total, np.nan) / np.where(held, count, 1.0)


def _weights(name: str, count: int) -> _Floats:
    """(DRAWS, count) how often each of so many is drawn."""
    chance = np.random.Generator(np.random.Philox(key=seeds.derive(0, "resampling", name)))
    return chance.multinomial(count, np.full(count, 1.0 / count), DRAWS).astype(np.float64)


def _rating(mean: float, drawn: _Floats) -> Rating:
    low, high = np.nanquantile(drawn, ((1.0 - LEVEL) / 2.0, (1.0 + LEVEL) / 2.0)).tolist()
    return Rating(mean=round(mean, _DIGITS), ci95=(round(low, _DIGITS), round(high, _DIGITS)))
