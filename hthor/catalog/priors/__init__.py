"""The scene priors of the six targets: where people expect objects.

Each of the 65 triplets (target, relation, reference) has two parts: the ``frequency`` of this relation in 195 hand-made
AI2-THOR scenes, which represents people's knowledge, and the ``similarity`` of the two names for an encoder of the BERT
family, which represents the knowledge in texts. `weigh_triplets` computes weights from them. The result ships in
``table.json``; `hthor.catalog.priors.making` computes it.
"""

import math
from collections.abc import Sequence
from functools import cache
from importlib import resources
from typing import Literal

import msgspec
from msgspec import Struct

from hthor.errors import UnknownName

SEEN_SHARE = 0.75
"""The share of a weight that comes from the frequency; the rest comes from the similarity."""
LEAST_FREQUENCY = 0.01
"""The least value that a frequency counts as, because relations that were hardly ever seen may still occur."""
TEMPERATURE = 0.15
"""The temperature of the softmax over a target's similarities."""
DIGITS = 3
"""Decimals of every number in the table; weights are computed from the rounded parts and then rounded."""


class Source(Struct, frozen=True, kw_only=True):
    """The source of each part of one triplet's weight, in words."""

    frequency: str
    similarity: str


class Triplet(Struct, frozen=True, kw_only=True):
    """One scene prior.

    ``optional`` says that not every house has the reference. ``frequency`` is ``seen`` / ``of``: the share of the
    target type's objects that are in this relation. ``similarity`` is a cosine, in [-1, 1]. The weights of a target's
    triplets add up to 1 up to rounding; `weights` returns them exactly.
    """

    target: str
    relation: Literal["on", "in", "near"]
    reference: str
    optional: bool
    seen: int
    of: int
    frequency: float
    similarity: float
    weight: float
    source: Source

    @property
    def key(self) -> tuple[str, str, str]:
        """(target, relation, reference), which identifies the triplet."""
        return self.target, self.relation, self.reference


class Origin(Struct, frozen=True, kw_only=True):
    """The source of one part of all weights: a package, one file of it and the file's hash."""

    part: Literal["frequency", "similarity"]
    package: str
    version: str
    file: str
    sha256: str
    licence: str
    content: str


class Table(Struct, frozen=True, kw_only=True):
    """The triplets, by target, and their sources."""

    origins: tuple[Origin, ...]
    triplets: tuple[Triplet, ...]


@cache
def table() -> Table:
    """The table that ships with hthor."""
    return msgspec.json.decode(resources.files(__name__).joinpath("table.json").read_bytes(), type=Table)


def triplets() -> tuple[Triplet, ...]:
    """All 65 triplets, by target."""
    return table().triplets


def targets() -> tuple[str, ...]:
    """The six targets, in the table's order."""
    return tuple(dict.fromkeys(row.target for row in triplets()))


def triplets_of(target: str) -> tuple[Triplet, ...]:
    """The triplets of one target.

    Raises:
        UnknownName: when ``target`` is not one of the six.
    """
    rows = tuple(row for row in triplets() if row.target == target)
    if not rows:
        raise UnknownName("target", target, targets())
    return rows


def weights(target: str) -> dict[tuple[str, str], float]:
    """Weight of each (relation, reference) of a target; they add up to 1.

    Raises:
        UnknownName: when ``target`` is not one of the six.
    """
    rows = triplets_of(target)
    total = sum(row.weight for row in rows)
    return {(row.relation, row.reference): row.weight / total for row in rows}


def weigh_triplets(frequencies: Sequence[float], similarities: Sequence[float]) -> list[float]:
    """The weights of one target's triplets, computed from their two parts; they add up to 1.

    `SEEN_SHARE` of each weight is the frequency's share of all frequencies, each at least `LEAST_FREQUENCY`; the rest
    is the softmax of similarity / `TEMPERATURE`.
    """
    seen = [max(frequency, LEAST_FREQUENCY) for frequency in frequencies]
    like = [math.exp(similarity / TEMPERATURE) for similarity in similarities]
    often, alike = sum(seen), sum(like)
    return [SEEN_SHARE * a / often + (1.0 - SEEN_SHARE) * b / alike for a, b in zip(seen, like, strict=True)]
