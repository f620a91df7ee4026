"""What a participant knows about the objects of the task, and how things out of view are forgotten.

The probability that a thing is still remembered falls to 1/e in ``tau_seen`` seconds; `SpatialMemory` forgets searches
in the same way. An exponential is the simplest law, coarser than ACT-R's power law; the published numbers cannot tell
them apart. People forget the objects of the task, and the furniture that is a destination. The layout (rooms, doorways,
where furniture stands) is learnt fast and kept (Li, Aivar, Tong and Hayhoe 2018).
"""

import math
from collections.abc import Iterable, Iterator

from msgspec import Struct

from hthor.humans.core.trial_context import HumanContext
from hthor.humans.memory.spatial_memory import KnownPlace, SpatialMemory
from hthor.types import HUMAN, Detection, Vec2

_MOVED_M = 0.02
"""[m] An object seen farther than this from its last position has been moved. Our choice."""
_EVERY_S = 1.5
"""[s] How often the model checks what was forgotten. Our choice: every second or two is enough."""


class KnownObject(Struct, kw_only=True):
    """One object: ``seen`` is its last detection, at tick ``at`` and from ``spot`` [m]; None while it is not known.

    ``views`` counts how often it came into view, ``lost`` how often it was forgotten or was not where it had been seen.
    ``owner`` is the participant's own seat.
    """

    id: str
    seen: Detection | None = None
    at: int = -1
    spot: Vec2 = (0.0, 0.0)
    lost: int = 0
    views: int = 0
    owner: str = HUMAN

    @property
    def taken(self) -> bool:
        """Whether somebody else was seen holding it."""
        return self.seen is not None and self.seen.held_by not in ("", self.owner)

    @property
    def lies(self) -> Detection | None:
        """The object as last seen, None when it is not known or somebody else has it."""
        return None if self.taken else self.seen


class ObjectMemory:
    """All objects of the task, as the participant at the seat ``owner`` knows them.

    ``changes`` counts changes of what is known about them.
    """

    def __init__(self, ids: Iterable[str], owner: str = HUMAN) -> None:
        self.known = {id: KnownObject(id=id, owner=owner) for id in ids}
        self.changes = 0

    def see(self, known: KnownObject, seen: Detection, tick: int, spot: Vec2) -> None:
        """Update an object in view that is known, or was noticed just now, from its detection ``seen``."""
        before = known.seen
        if before is not seen and (before is None or _differs(before, seen)):
            self.changes += 1
        known.seen, known.at, known.spot = seen, tick, spot

    def lose(self, known: KnownObject) -> None:
        """Note that an object was forgotten or is not where it was; it must be noticed again."""
        known.lost += 1
        known.seen = None
        self.changes += 1


def _differs(a: Detection, b: Detection) -> bool:
    if a.support != b.support or a.held_by != b.held_by:
        return True
    return math.dist(a.position, b.position) > _MOVED_M


class Forgetting:
    """Decides which objects and places are forgotten by now.

    A memory lasts for a random span, drawn by the thing's name and how often it came into view, so that the order of
    the checks makes no difference.
    """

    def __init__(self, human: HumanContext, objects: ObjectMemory, memory: SpatialMemory) -> None:
        self.human, self.objects, self.memory = human, objects, memory
        self._destinations = frozenset(name for job in human.task.todo for name in job.destinations)
        self._tau = human.traits.tau_seen / human.tick_s
        self._every = round(_EVERY_S / human.tick_s)
        self._checked = 0
        self._spans: dict[tuple[str, int], float] = {}

    def forgotten_objects(self, current: KnownObject) -> Iterable[KnownObject]:
        """Objects forgotten just now; never the ``current`` object or the object in hand."""
        holding = self.human.now.holding
        return [
            known
            for known in self.objects.known.values()
            if known.seen is not None
            and known.at >= 0
            and known is not current
            and known.id != holding
            and self._is_gone(known.id, known.at, known.views)
        ]

    def forgotten_places(self) -> Iterator[KnownPlace]:
        """Destinations forgotten just now; never the one that the participant is heading for."""
        for place in self.memory.places.values():
            wanted = place.recalled and (place.kind in self._destinations or place.id in self._destinations)
            if wanted and place.id != self.memory.heading and self._is_gone(place.id, place.at, place.views):
                yield place

    def is_due(self) -> bool:
        """Whether it is time to check again."""
        if self.human.now.tick - self._checked < self._every:
            return False
        self._checked = self.human.now.tick
        return True

    def _is_gone(self, name: str, at: int, views: int) -> bool:
        span = self._spans.get((name, views))
        if span is None:
            span = self._spans[name, views] = -self._tau * math.log(self.human.draw("forget", name, views))
        return self.human.now.tick - at > span
