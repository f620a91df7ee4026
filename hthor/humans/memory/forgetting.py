"""How a person forgets where things were that are out of view.

Whether something is still known after a time out of view follows an exponential law, as do the searches that `Memory`
forgets: the chance that it is falls to 1/e in ``tau_seen`` seconds. That is the simplest law in which memory leaks, and
coarser than the power law of ACT-R; the published numbers cannot tell them apart. Forgotten are the objects that
matter, and the furniture that something must be brought to; the layout of a house, its rooms, doorways and what stands
where to be searched, is learnt fast and kept (Li, Aivar, Tong and Hayhoe 2018).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from hthor.humans.core.trial_context import Subject
from hthor.humans.memory.object_memory import Known, Things
from hthor.humans.memory.spatial_memory import Memory, Place
from hthor.humans.memory.subgoals import todo

_EVERY_S = 1.5


class Forgetting:
    """Tells what is forgotten by now.

    What is forgotten lasts a span that chance names for the thing and for how often it came into view: the same in
    whatever order things are asked about.
    """

    def __init__(self, me: Subject, things: Things, memory: Memory) -> None:
        self.me, self.things, self.memory = me, things, memory
        self._homes = frozenset(home for job in todo(me.task) for home in job.destinations)
        self._tau = me.traits.tau_seen / me.tick_s
        self._every = round(_EVERY_S / me.tick_s)
        self._checked = 0
        self._spans: dict[tuple[str, int], float] = {}

    def objects(self, about: Known) -> Iterable[Known]:
        """Objects forgotten just now; never the one that the person is ``about`` nor what is in hand."""
        holding = self.me.now.holding
        return [
            known
            for known in self.things.known.values()
            if known.seen is not None
            and known.at >= 0
            and known is not about
            and known.id != holding
            and self._gone(known.id, known.at, known.views)
        ]

    def places(self) -> Iterator[Place]:
        """Furniture to bring something to that is forgotten just now; never where the person is heading."""
        for place in self.memory.places.values():
            wanted = place.recalled and (place.kind in self._homes or place.id in self._homes)
            if wanted and place.id != self.memory.heading and self._gone(place.id, place.at, place.views):
                yield place

    def due(self) -> bool:
        """Whether it is time to look again; every second or two is enough."""
        if self.me.now.tick - self._checked < self._every:
            return False
        self._checked = self.me.now.tick
        return True

    def _gone(self, name: str, at: int, views: int) -> bool:
        span = self._spans.get((name, views))
        if span is None:
            span = self._spans[name, views] = -self._tau * math.log(self.me.draw("forget", name, views))
        return self.me.now.tick - at > span
