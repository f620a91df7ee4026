"""Where people expect things: the scene priors of the six targets; knows nothing of any one house.

Each of the 65 triplets (target, relation, reference) carries the ``frequency`` with which 195 hand-made AI2-THOR scenes
show it (object metadata of the procthor package, Apache-2.0), the ``similarity`` of the two names' MiniLM sentence
embeddings (cosine), and a ``weight``: three quarters of the frequency (at least 0.01) plus a quarter of
softmax(similarity / 0.15), over the target's triplets. Two things are *near* each other within 1 m.
"""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import Literal

import msgspec
from msgspec import Struct

from hthor.catalog.targets import KINDS
from hthor.errors import UnknownName


class Triplet(Struct, frozen=True, kw_only=True):
    """One scene prior. ``optional`` says that not every house has the reference; the weight has no unit."""

    target: str
    relation: Literal["on", "in", "near"]
    reference: str
    optional: bool
    frequency: float
    similarity: float
    weight: float


@cache
def triplets() -> tuple[Triplet, ...]:
    """All 65 triplets, by target."""
    data = resources.files("hthor.catalog").joinpath("priors.json").read_bytes()
    return msgspec.json.decode(data, type=tuple[Triplet, ...])


def weights(target: str) -> dict[tuple[str, str], float]:
    """Weight of each (relation, reference) of a target; they add up to 1.

    Raises:
        UnknownName: when ``target`` is none of the six.
    """
    rows = [row for row in triplets() if row.target == target]
    if not rows:
        raise UnknownName("target", target, [kind.name for kind in KINDS])
    total = sum(row.weight for row in rows)
    return {(row.relation, row.reference): row.weight / total for row in rows}
