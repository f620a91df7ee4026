"""What a participant knows of the objects of the task: where each was noticed last."""

import math
from collections.abc import Iterable

from msgspec import Struct

from hthor.types import HUMAN, Detection, Vec2

_MOVED_M = 0.02
"""[m] An object seen this far from where it was has been moved. Our choice."""


class KnownObject(Struct, kw_only=True):
    """One object: ``seen`` is how it was noticed last, at tick ``at`` and from ``spot`` [m]; None while not known.

    ``views`` counts how often it came into view, ``lost`` how often it was forgotten or not where it had been seen.
    """

    id: str
    seen: Detection | None = None
    at: int = -1
    spot: Vec2 = (0.0, 0.0)
    lost: int = 0
    views: int = 0

    @property
    def taken(self) -> bool:
        """Whether a robot was seen with it."""
        return self.seen is not None and self.seen.held_by not in ("", HUMAN)

    @property
    def lies(self) -> Detection | None:
        """The object as last seen, None when it is not known or a robot has it."""
        return None if self.taken else self.seen


class ObjectMemory:
    """All objects of the task. ``changes`` counts how often the knowledge of one of them changed."""

    def __init__(self, ids: Iterable[str]) -> None:
        self.known = {id: KnownObject(id=id) for id in ids}
        self.changes = 0

    def see(self, known: KnownObject, seen: Detection, tick: int, spot: Vec2) -> None:
        """An object that is known, or was noticed just now, is in view."""
        before = known.seen
        if before is not seen and (before is None or _differs(before, seen)):
            self.changes += 1
        known.seen, known.at, known.spot = seen, tick, spot

    def lose(self, known: KnownObject) -> None:
        """The object is forgotten, or not where it was; it must be noticed again."""
        known.lost += 1
        known.seen = None
        self.changes += 1


def _differs(a: Detection, b: Detection) -> bool:
    if a.support != b.support or a.held_by != b.held_by:
        return True
    return math.dist(a.position, b.position) > _MOVED_M
