"""What a person notices of what is in view.

Noticing is a matter of rates, see `hthor.humans.perception.detection_rate`: while a thing is in view its rate of
being noticed is gathered, glimpse by glimpse, and it is noticed once a threshold is reached that chance set for
this thing in this trial. That is the same law as an independent chance at each glimpse, but no glimpse can shift
the luck of another.

How fast the target would be noticed on a piece of furniture in view, were it there, is gathered as well: so thoroughly
was it searched. For want of knowing where on it, people reckon as if the target lay in its middle, alone and in full
view.
"""

from __future__ import annotations

import math

from hthor.humans.core.trial_context import Subject
from hthor.humans.memory.forgetting import Forgetting
from hthor.humans.memory.location_priors import holders
from hthor.humans.memory.object_memory import Known, Things
from hthor.humans.memory.spatial_memory import Memory, Place
from hthor.humans.perception.detection_rate import Head, Outlook, expected, extent, rate
from hthor.humans.perception.exposure_log import Exposures, Glimpse
from hthor.types import HUMAN, Detection, Event, Observation, Vec3

GLIMPSE_TICKS = 3
"""People fixate about three times a second."""
_LONGEST_S = 0.6
_LARGE_M = 0.5
_NEAR_M = 1.0


class Eyes:
    """Turns detections into what the person knows.

    ``things`` are the objects that matter, ``subject`` the one that the person is about. ``attention`` is what is being
    searched: a place, a spot, or nothing in particular.
    """

    def __init__(self, me: Subject, things: Things, memory: Memory) -> None:
        self.me, self.traits, self.things, self.memory = me, me.traits, things, memory
        self.subject: Known = next(iter(things.known.values()))
        self.attention: Place | Vec3 | None = None
        self.at = -1
        self._before = -1
        self._outlook = Outlook(me.traits, sum(map(expected, things.known)) / len(things.known))
        self._forgetting, self._exposures = Forgetting(me, things, memory), Exposures(me)
        self._holders = frozenset(holders())
        self._gathered: dict[str, float] = {}
        self._threshold: dict[str, float] = {}

    def look(self, now: Observation) -> None:
        """Take in one glimpse."""
        tick, pose, wanted, kinds = now.tick, now.pose, self.things.known, self._holders
        tick_s = self.me.tick_s
        seconds = min(_LONGEST_S, (tick - self.at) * tick_s) if self.at >= 0 else tick_s
        self._before, self.at = self.at, tick
        head = Head(pose, self.me.body.eye)
        for seen in now.detections:
            family = seen.family
            if family == "furniture":
                if seen.kind in kinds:
                    self._furniture(seen, head, seconds)
            elif family == "doorway":
                self.memory.keep_doorway(seen, (pose.x, pose.y), now.room)
            elif seen.id in wanted:
                self._object(wanted[seen.id], seen, head, seconds)
        if self._forgetting.due():
            self._forget()

    def lose(self, known: Known) -> None:
        """An object is not where it was, or that is forgotten; it must be noticed anew."""
        self.things.lose(known)
        self._unlearn(known.id)

    def end(self) -> None:
        """The trial is over: the journal gets what was never noticed."""
        self._exposures.end()

    def _object(self, known: Known, seen: Detection, head: Head, seconds: float) -> None:
        now = self.me.now
        if known.seen is None:
            if not self._notices(known, seen, head, seconds):
                return
            self._exposures.close(known.id, noticed=True)
            self._tell("noticed", seen.id, seen)
        if known.at != self._before:
            known.views += 1
        self.things.see(known, seen, now.tick, (now.pose.x, now.pose.y))

    def _notices(self, known: Known, seen: Detection, head: Head, seconds: float) -> bool:
        if max(seen.size) > _LARGE_M:
            return self._gather(known.id, self._rate_of_large(seen) * seconds, known.lost)
        (far, ecc), (share, beside) = head.to(seen.position), self._sighting(seen.id)
        angle, attended = extent(seen.size) / far, self._attended(seen)
        self._exposures.add(known.id, Glimpse(seconds, angle, ecc, share, beside, attended))
        faster = self.traits.focus if attended else 1.0
        return self._gather(known.id, faster * rate(self.traits, angle, ecc, share, beside) * seconds, known.lost)

    def _sighting(self, id: str) -> tuple[float, int]:
        sighting = self.me.now.senses.sighting(id)
        return sighting.share, sighting.beside

    def _furniture(self, seen: Detection, head: Head, seconds: float) -> None:
        memory, place, tick = self.memory, self.memory.places.get(seen.id), self.at
        if place is None or not place.recalled:
            if not self._gather(seen.id, self._rate_of_large(seen) * seconds, 0 if place is None else place.lost):
                return
            place = memory.keep_place(seen)
            self._tell("noticed", seen.id, seen)
        elif seen.state:
            memory.keep_place(seen)
        if place.at != self._before:
            place.views += 1
        place.at = tick
        if place.state != "closed":
            memory.expose(place, self._outlook.rate(head, seen.position) * seconds, tick)

    def _rate_of_large(self, seen: Detection) -> float:
        """Rate [1/s] of recognising furniture and what is as large."""
        return self.traits.lam_furniture / (1.0 + (seen.distance / self.traits.d_furniture) ** 2)

    def _attended(self, seen: Detection) -> bool:
        spot = self.attention
        if isinstance(spot, Place):
            return seen.support == spot.id or spot.covers(seen.position)
        return spot is not None and math.dist(spot[:2], seen.position[:2]) < _NEAR_M

    def _gather(self, name: str, amount: float, again: int) -> bool:
        """Whether a thing is noticed, for the time ``again`` plus one."""
        threshold = self._threshold.get(name)
        if threshold is None:
            threshold = -math.log(self.me.draw("notice", name, again))
            self._threshold[name] = threshold
        gathered = self._gathered.get(name, 0.0) + amount
        self._gathered[name] = gathered
        return gathered >= threshold

    def _forget(self) -> None:
        for known in self._forgetting.objects(self.subject):
            self._tell("forgot", known.id, known.seen)
            self.lose(known)
        for place in self._forgetting.places():
            self._tell("forgot", place.id)
            self.memory.lose(place)
            self._unlearn(place.id)

    def _unlearn(self, name: str) -> None:
        self._gathered.pop(name, None)
        self._threshold.pop(name, None)

    def _tell(self, what: str, name: str, seen: Detection | None = None) -> None:
        """Tell whoever looks into the mind."""
        if self.me.think is not None:
            data = {"object": name} if seen is None else {"object": name, "position": list(seen.position)}
            self.me.think(Event(tick=self.at, seat=HUMAN, kind=what, data=data))
