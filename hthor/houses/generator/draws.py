"""Random draws by name for one part of a house."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor import seeds

T = TypeVar("T")
_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


class Dice(Struct, frozen=True):
    """A root of draws. A draw depends only on the root and its names, never on earlier draws."""

    root: int

    def of(self, *names: seeds.Name) -> Dice:
        """Separate dice for the part of these dice's purpose with these names."""
        return Dice(seeds.derive(self.root, *names))

    def unit(self, *names: seeds.Name) -> float:
        """A number in (0, 1)."""
        return seeds.draw(self.root, *names)

    def chance(self, probability: float, *names: seeds.Name) -> bool:
        """True with this probability."""
        return self.unit(*names) < probability

    def between(self, low: float, high: float, *names: seeds.Name) -> float:
        """A number in (low, high)."""
        return low + (high - low) * self.unit(*names)

    def whole(self, low: int, high: int, *names: seeds.Name) -> int:
        """A whole number from ``low`` to ``high``, both included."""
        return low + min(int(self.unit(*names) * (high - low + 1)), high - low)

    def pick(self, options: Sequence[T], *names: seeds.Name) -> T:
        """One of the options, all equally likely."""
        return options[self.whole(0, len(options) - 1, *names)]

    def weighted(self, options: Sequence[T], weights: Sequence[float], *names: seeds.Name) -> T:
        """One of the options, by weight."""
        return options[seeds.choice(weights, self.root, *names)]

    def order(self, options: Sequence[T], *names: seeds.Name) -> list[T]:
        """The options in random order."""
        return [options[index] for index in seeds.shuffled(len(options), self.root, *names)]

    def beta(self, a: float, b: float, *names: seeds.Name) -> float:
        """A number of the beta distribution, by Jöhnk's rejection."""
        for attempt in range(1000):
            x = math.exp(math.log(self.unit(*names, "x", attempt)) / a)
            y = math.exp(math.log(self.unit(*names, "y", attempt)) / b)
            if 0.0 < x + y <= 1.0:
                return x / (x + y)
        return a / (a + b)

    def scatter(self, count: int, *names: seeds.Name) -> NDArray[np.float64]:
        """(count,) numbers in [0, 1), evenly spread: multiples of the golden section, shifted by one draw."""
        turned: NDArray[np.float64] = (self.unit(*names) + _GOLDEN * np.arange(count, dtype=np.float64)) % 1.0
        return turned
