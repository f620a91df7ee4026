"""Data on where each target belongs by common sense: belongs, acceptable or out of place.

``judgement.json`` has a row for each target and each kind of thing that can support it. The verdict follows from the
row's ``share``: the kind's share of the target's "in" and "on" relations in the scene priors, or, if the priors do not
name the kind, its share of the target's places in 195 hand-made AI2-THOR scenes. If the share is `BELONGS` or more, the
target belongs there; if it is `ACCEPTABLE` or more, the place is acceptable; otherwise the target is out of place, like
a book in the fridge. Food in the sink is acceptable, because people wash it.
"""

from functools import cache
from importlib import resources
from typing import Literal

import msgspec
from msgspec import Struct

from hthor.errors import UnknownName

Verdict = Literal["belongs", "acceptable", "out"]

BELONGS, ACCEPTABLE = 0.1, 0.03
"""Least shares of the two better verdicts: one place in 10, and one place in 33."""


class CommonsensePlace(Struct, frozen=True, kw_only=True):
    """One judgement. ``basis`` names the source of ``share``; it is "none" for a kind that neither source has: the
    target does not belong there, but tidying tasks do not put it there either. ``source`` names the row or the count.
    """

    target: str
    kind: str
    verdict: Verdict
    share: float
    basis: Literal["prior", "scenes", "none"]
    source: str


class _File(Struct, frozen=True):
    rows: tuple[CommonsensePlace, ...]


@cache
def all_places() -> tuple[CommonsensePlace, ...]:
    """All judgements, ordered by target."""
    data = resources.files(__package__).joinpath("judgement.json").read_bytes()
    return msgspec.json.decode(data, type=_File).rows


@cache
def places_of(target: str) -> dict[str, CommonsensePlace]:
    """The judgements of a target by the kind of thing that it lies on or in.

    Raises:
        UnknownName: when the file has no row for ``target``.
    """
    found = {row.kind: row for row in all_places() if row.target == target}
    if not found:
        raise UnknownName("target", target, sorted({row.target for row in all_places()}))
    return found


def usual_places(target: str) -> tuple[str, ...]:
    """The kinds of things on or in which the target may lie, the likeliest first."""
    good = [row for row in places_of(target).values() if row.verdict != "out"]
    return tuple(row.kind for row in sorted(good, key=lambda row: (-row.share, row.kind)))


def is_misplaced(target: str, kind: str) -> bool:
    """Whether one of the sources shows that the target is out of place on or in a thing of this kind."""
    row = places_of(target).get(kind)
    return row is not None and row.verdict == "out" and row.basis != "none"
