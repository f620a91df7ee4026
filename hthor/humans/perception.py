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
from hthor.types import HUMAN, Detection, Observation, Vec2, Vec3

GLIMPSE_TICKS = 3
"""People fixate about three times a second."""
_LONGEST_S = 0.6


class Eyes:
    """Turns detections into what the person knows.

    ``target`` is where the target was noticed last, at tick ``seen_at`` and from ``seen_from``; None while it is not
    known. ``attention`` is what is being searched: a place, a spot, or nothing in particular.
    """

    def __init__(self, traits: Parameters, root: int, target: str, memory: Memory, tick_s: float) -> None:
        self.traits, self.root, self.wanted, self.memory, self.tick_s = traits, root, target, memory, tick_s
        self.target: Detection | None = None
        self.attention: Place | Vec3 | None = None
        self.at = -1
        self.seen_at = -1
        self.seen_from: Vec2 = (0.0, 0.0)
        self._holders = frozenset(holders())
        self._gathered: dict[str, float] = {}
        self._threshold: dict[str, float] = {}
        self._lost = 0

    def due(self, tick: int) -> bool:
        """Whether it is time for another glimpse."""
        return self.at < 0 or tick - self.at >= GLIMPSE_TICKS

    def look(self, now: Observation) -> None:
        """Take in one glimpse."""
        seconds = min(_LONGEST_S, (now.tick - self.at) * self.tick_s) if self.at >= 0 else self.tick_s
        self.at = now.tick
        for seen in now.detections:
            if seen.family == "furniture":
                if seen.kind in self._holders:
                    self._furniture(seen, now, seconds)
            elif seen.family == "doorway":
                self.memory.keep_doorway(seen, (now.pose.x, now.pose.y), now.room)
            elif seen.id == self.wanted and seen.held_by in ("", HUMAN):
                self._target(seen, now, seconds)

    def lose(self) -> None:
        """The target is not where it was; it must be noticed anew."""
        self._lost += 1
        self.target = None
        self._gathered.pop(self.wanted, None)
        self._threshold.pop(self.wanted, None)

    def _target(self, seen: Detection, now: Observation, seconds: float) -> None:
        if self.target is None:
            rate = self._rate(seen, now) * (self.traits.focus if self._attended(seen) else 1.0)
            if not self._notice(self.wanted, rate * seconds, self._lost):
                return
        self.target, self.seen_at, self.seen_from = seen, now.tick, (now.pose.x, now.pose.y)

    def _furniture(self, seen: Detection, now: Observation, seconds: float) -> None:
        traits, known = self.traits, seen.id in self.memory.places
        if not known:
            rate = traits.lam_furniture / (1.0 + (seen.distance / traits.d_furniture) ** 2)
            if not self._notice(seen.id, rate * seconds, 0):
                return
        place = self.memory.keep_place(seen)
        if place.state != "closed":
            self.memory.expose(place, self._rate(seen, now) * seconds, now.tick)

    def _rate(self, seen: Detection, now: Observation) -> float:
        """Rate [1/s] of noticing the target were it there."""
        traits, pose = self.traits, now.pose
        ecc = wrap(math.atan2(seen.position[1] - pose.y, seen.position[0] - pose.x) - pose.yaw)
        near = 1.0 + (seen.distance / traits.d50) ** 2
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
