"""Random draws by name: a draw depends on what it is for, never on how many draws came before; there is no state.

Two robots therefore meet the same person with the same luck: a message that changes the person's path does not change
the outcome of any other draw.
"""

import hashlib
import operator
from collections.abc import Sequence
from statistics import NormalDist

from hthor.errors import HthorError

LARGEST = 2**63 - 1
"""The largest seed that a user can give."""

_normal = NormalDist()

Name = str | int


def check_seed(seed: object) -> int:
    """The seed that a user gave; the roots that hthor derives need no check.

    Raises:
        HthorError: when it is not a whole number from 0 to `LARGEST`.
    """
    try:
        number = operator.index(seed)  # type: ignore[arg-type]
    except TypeError:
        number = -1
    if isinstance(seed, bool) or not 0 <= number <= LARGEST:
        given = repr(seed) if not isinstance(seed, int) or abs(number) <= LARGEST else "a larger number"
        raise HthorError(f"a seed must be a whole number from 0 to {LARGEST}, got {given:.40}")
    return number


def _bits(root: int, names: tuple[Name, ...]) -> int:
    digest = hashlib.blake2b(repr(names).encode(), key=root.to_bytes(16, "little", signed=True), digest_size=8).digest()
    return int.from_bytes(digest, "little")


def draw(root: int, *names: Name) -> float:
    """A uniform number in the open interval (0, 1), fixed by ``root`` and ``names``."""
    return ((_bits(root, names) >> 12) + 0.5) / (1 << 52)


def normal(root: int, *names: Name) -> float:
    """A standard normal number, fixed by ``root`` and ``names``."""
    return _normal.inv_cdf(draw(root, *names))


def derive(root: int, *names: Name) -> int:
    """A seed for further draws, 63 bits."""
    return _bits(root, names) >> 1


def choice(weights: Sequence[float], root: int, *names: Name) -> int:
    """An index with probability proportional to its weight.

    Raises:
        ValueError: when the weights are empty, negative or all zero.
    """
    total = float(sum(weights))
    if not total > 0.0 or min(weights) < 0.0:
        raise ValueError(f"weights must be non-negative with a positive sum, got {list(weights)}")
    mark = draw(root, *names) * total
    for index, weight in enumerate(weights):
        mark -= weight
        if mark < 0.0:
            return index
    return max(index for index, weight in enumerate(weights) if weight > 0.0)


def shuffled(count: int, root: int, *names: Name) -> list[int]:
    """``range(count)`` in an order fixed by ``root`` and ``names``."""
    return sorted(range(count), key=lambda index: _bits(root, (*names, index)))
