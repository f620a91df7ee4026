"""How a participant forgets where things are that are out of view.

The probability that something is still remembered falls to 1/e in ``tau_seen`` seconds, as searches do in
`SpatialMemory`. An exponential is the simplest law, coarser than ACT-R's power law; the published numbers cannot tell
them apart. The objects of the task are forgotten, and the furniture that something must be brought to. The layout
(rooms, doorways, where furniture stands) is learnt fast and kept (Li, Aivar, Tong and Hayhoe 2018).
"""

import math
from collections.abc import Iterable, Iterator

from hthor.humans.core.trial_context import HumanContext
from hthor.humans.memory.object_memory import KnownObject, ObjectMemory
from hthor.humans.memory.spatial_memory import KnownPlace, SpatialMemory

_EVERY_S = 1.5
"""[s] How often the model checks what was forgotten. Our choice: every second or two is enough."""


class Forgetting:
    """Says what is forgotten by now.

    Each memory lasts for a random span, drawn by the thing's name and how often it came into view, so that the order of
    questions makes no difference.
    """

    def __init__(self, human: HumanContext, objects: ObjectMemory, memory: SpatialMemory) -> None:
        self.human, self.objects, self.memory = human, objects, memory
        self._destinations = frozenset(name for job in human.task.todo for name in job.destinations)
        self._tau = human.traits.tau_seen / human.tick_s
        self._every = round(_EVERY_S / human.tick_s)
        self._checked = 0
        self._spans: dict[tuple[str, int], float] = {}

    def forgotten_objects(self, current: KnownObject) -> Iterable[KnownObject]:
        """Objects forgotten just now; never the ``current`` one, nor what is in hand."""
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
