"""The kinds that a house must have, may have and must not have."""

from collections.abc import Iterable

from msgspec import Struct

from hthor import catalog
from hthor.catalog import priors
from hthor.errors import HthorError, UnknownName
from hthor.houses.generator.draws import Dice

ALWAYS = (*catalog.RECEPTACLES, "sink", "chair")
OPTIONAL = tuple(sorted({row.reference for row in priors.triplets() if row.optional}))
"""The references of the scene priors that not every house has."""
_SHARE = {
    "pillow": 0.9,
    "television": 0.85,
    "laptop": 0.75,
    "armchair": 0.65,
    "shelf": 0.7,
    "bowl": 0.7,
    "plate": 0.7,
    "dresser": 0.8,
    "coffee_machine": 0.6,
    "bread": 0.5,
    "egg": 0.5,
}


class Requirements(Struct, frozen=True):
    """``must`` are the optional kinds that the house has; it has no others."""

    must: frozenset[str]

    def allows(self, kind: str) -> bool:
        """Whether the house may have things of this kind."""
        return kind in self.must or (kind not in OPTIONAL and kind not in catalog.TARGETS)


def draw_requirements(needs: Iterable[str] | None, dice: Dice) -> Requirements:
    """The given requirements, or random requirements when none are given.

    Raises:
        UnknownName: when a need is not an optional kind.
    """
    if needs is None:
        return Requirements(frozenset(kind for kind in OPTIONAL if dice.chance(_SHARE.get(kind, 0.6), kind)))
    given = frozenset(needs)
    if isinstance(needs, str):
        raise HthorError(f"needs must be several kinds, got the text {needs!r}; give a set such as {{'pillow'}}")
    for kind in sorted(given):
        if kind not in OPTIONAL:
            raise UnknownName("optional kind", kind, OPTIONAL, f"Every house has {', '.join(ALWAYS)} anyway.")
    return Requirements(given)
