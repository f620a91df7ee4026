"""Where people expect things: the scene priors of the six targets.

Each of the 65 triplets (target, relation, reference) has two parts: the ``frequency`` with which the target is seen so
in 195 hand-made AI2-THOR scenes, which stands for what people know, and the ``similarity`` of the two names to a BERT-
family encoder, which stands for what texts know. `weighed` makes weights of them. ``table.json`` ships computed;
`hthor.catalog.priors.making` computes it.
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
"""Of the weight: what the frequency gives; the similarity gives the rest."""
LEAST_FREQUENCY = 0.01
"""What was hardly ever seen may still happen: the frequency counts as at least this."""
TEMPERATURE = 0.15
"""Of the softmax over a target's similarities."""
DIGITS = 3
"""Behind the point of every number in the table: the parts are rounded first, then the weights made of them."""


class Source(Struct, frozen=True, kw_only=True):
    """Where each part of one triplet's weight comes from, in words."""

    frequency: str
    similarity: str


class Triplet(Struct, frozen=True, kw_only=True):
    """One scene prior.

    ``optional`` says that not every house has the reference. ``frequency`` is ``seen`` / ``of``: of all objects of the
    target's type, those in this relation. ``similarity`` is a cosine, in [-1, 1]. The weights of a target's triplets
    add up to 1 up to rounding; `weights` gives them exactly.
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
        """(target, relation, reference), of which there is one triplet."""
        return self.target, self.relation, self.reference


class Origin(Struct, frozen=True, kw_only=True):
    """What a part of all weights was computed from: the package, one file of it and that file's hash."""

    part: Literal["frequency", "similarity"]
    package: str
    version: str
    file: str
    sha256: str
    licence: str
    content: str


class Table(Struct, frozen=True, kw_only=True):
    """The triplets, by target, and what they come from."""

    origins: tuple[Origin, ...]
    triplets: tuple[Triplet, ...]


@cache
def table() -> Table:
    """The table that ships."""
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
    """The weights that follow from the two parts of one target's triplets; they add up to 1.

    Three quarters of each weight are the frequency's share of all frequencies, each at least `LEAST_FREQUENCY`; the
    rest is the softmax of similarity / `TEMPERATURE`.
    """
    seen = [max(frequency, LEAST_FREQUENCY) for frequency in frequencies]
    like = [math.exp(similarity / TEMPERATURE) for similarity in similarities]
    often, alike = sum(seen), sum(like)
    return [SEEN_SHARE * a / often + (1.0 - SEEN_SHARE) * b / alike for a, b in zip(seen, like, strict=True)]
