"""What a person notices of what is in view; knows nothing of what they do about it.

Noticing is a matter of rates: while a thing is in view its rate of being noticed is gathered, glimpse by glimpse, and
it is noticed once a threshold is reached that chance set for this thing in this trial. That is the same law as an
independent chance at each glimpse, but no glimpse can shift the luck of another.
"""

from __future__ import annotations

import math

from hthor import seeds
from hthor.geometry import wrap
from hthor.humans.beliefs import holders
from hthor.humans.memory import Memory, Place
from hthor.humans.parameters import Parameters
from hthor.humans.things import Known, Things
from hthor.types import Detection, Observation, Vec3

GLIMPSE_TICKS = 3
"""People fixate about three times a second."""
_LONGEST_S = 0.6
_LARGE_M = 0.5


class Eyes:
    """Turns detections into what the person knows.

    ``things`` are the objects that matter, ``subject`` the one that the person is about. ``attention`` is what is being
    searched: a place, a spot, or nothing in particular.
    """

    def __init__(self, traits: Parameters, root: int, things: Things, memory: Memory, tick_s: float) -> None:
        self.traits, self.root, self.things, self.memory, self.tick_s = traits, root, things, memory, tick_s
        self.subject: Known = next(iter(things.known.values()))
        self.attention: Place | Vec3 | None = None
        self.at = -1
        self._holders = frozenset(holders())
        self._gathered: dict[str, float] = {}
        self._threshold: dict[str, float] = {}

    def look(self, now: Observation) -> None:
        """Take in one glimpse."""
        tick, pose, wanted, kinds = now.tick, now.pose, self.things.known, self._holders
        seconds = min(_LONGEST_S, (tick - self.at) * self.tick_s) if self.at >= 0 else self.tick_s
        self.at = tick
        for seen in now.detections:
            family = seen.family
            if family == "furniture":
                if seen.kind in kinds:
                    self._furniture(seen, now, seconds)
            elif family == "doorway":
                self.memory.keep_doorway(seen, (pose.x, pose.y), now.room)
            elif seen.id in wanted:
                self._object(wanted[seen.id], seen, now, seconds)

    def lose(self, known: Known) -> None:
        """An object is not where it was; it must be noticed anew."""
        self.things.lose(known)
        self._gathered.pop(known.id, None)
        self._threshold.pop(known.id, None)

    def _object(self, known: Known, seen: Detection, now: Observation, seconds: float) -> None:
        if known.seen is None:
            if max(seen.size) > _LARGE_M:
                rate = self._rate_of_large(seen)
            else:
                rate = self._rate(seen, now) * (self.traits.focus if self._attended(seen) else 1.0)
            if not self._notice(known.id, rate * seconds, known.lost):
                return
        self.things.see(known, seen, now.tick, (now.pose.x, now.pose.y))

    def _furniture(self, seen: Detection, now: Observation, seconds: float) -> None:
        memory = self.memory
        place = memory.places.get(seen.id)
        if place is None:
            if not self._notice(seen.id, self._rate_of_large(seen) * seconds, 0):
                return
            place = memory.keep_place(seen)
        elif seen.state:
            memory.keep_place(seen)
        if place.state != "closed":
            memory.expose(place, self._rate(seen, now) * seconds, now.tick)

    def _rate_of_large(self, seen: Detection) -> float:
        """Rate [1/s] of recognising furniture and what is as large."""
        return self.traits.lam_furniture / (1.0 + (seen.distance / self.traits.d_furniture) ** 2)

    def _rate(self, seen: Detection, now: Observation) -> float:
        """Rate [1/s] of noticing the target were it there."""
        traits, pose, (x, y, _) = self.traits, now.pose, seen.position
        ecc = wrap(math.atan2(y - pose.y, x - pose.x) - pose.yaw)
        near = 1.0 + (traits.a50 * seen.distance / 0.1) ** 2
        return traits.lam0 / near * math.exp(-0.5 * (ecc / traits.ecc_sd) ** 2)

    def _attended(self, seen: Detection) -> bool:
        spot = self.attention
        if isinstance(spot, Place):
            return seen.support == spot.id or spot.covers(seen.position)
        return spot is not None and math.dist(spot[:2], seen.position[:2]) < 1.0

    def _notice(self, name: str, amount: float, again: int) -> bool:
        threshold = self._threshold.get(name)
        if threshold is None:
            threshold = -math.log(seeds.draw(self.root, "notice", name, again))
            self._threshold[name] = threshold
        gathered = self._gathered.get(name, 0.0) + amount
        self._gathered[name] = gathered
        return gathered >= threshold
