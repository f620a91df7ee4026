"""Where a participant expects an object now, by place: what they saw, were told, and know of houses in general."""

import math
from collections.abc import Mapping

from hthor.humans.memory.object_memory import KnownObject
from hthor.humans.search.option_choice import OptionChoice

FLOOR = "floor"
"""The place of an object that lies on no furniture."""


def seen_place(known: KnownObject) -> str:
    """The place of an object that is remembered: its furniture, `FLOOR`, or the seat of who holds it; else empty."""
    return "" if known.seen is None else known.seen.held_by or known.seen.support or FLOOR


def place_probabilities(search: OptionChoice, by_kind: Mapping[str, float], tick: int) -> dict[str, float]:
    """The probability of each known place, after what was searched in vain; the rest is for what was not seen yet.

    Args:
        search: the places and the exposure of each. by_kind: belief in each kind of furniture.
    """
    memory = search.memory
    beliefs = search.place_beliefs(bool(memory.unexplored_doorways()), by_kind)
    left = {id: share * math.exp(-memory.exposure(memory.places[id], tick)) for id, share in beliefs.items()}
    total = math.fsum(left.values()) + search.doorway_belief(beliefs)
    return {id: share / total for id, share in left.items()} if total > 0.0 else {}


def after_advice(beliefs: Mapping[str, float], place: str, trust: float) -> dict[str, float]:
    """The probabilities after advice that was accepted: ``trust`` (0 to 1) is given to its place, the rest as before.

    The share is our choice. An empty ``place`` is one that was not seen yet.
    """
    after = {id: (1.0 - trust) * share for id, share in beliefs.items()}
    return {**after, place: after.get(place, 0.0) + trust} if place else after
