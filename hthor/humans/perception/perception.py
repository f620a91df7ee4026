"""Which of the things in view a participant notices.

While a thing is in view its detection rate (`hthor.humans.perception.detection_rate`) is added up, glimpse by glimpse;
it is noticed once the sum reaches a random threshold of this thing in this trial. This is the same law as an
independent chance at each glimpse, but no glimpse changes the random numbers of another.

For furniture in view, the rate at which the target would be noticed in its middle, alone and in full view, is added up
as well: the sum is the exposure, a measure of how thoroughly the furniture was searched.
"""

import math

from hthor.humans.core.thoughts import Forgot, HumanThought, Noticed
from hthor.humans.core.trial_context import HumanContext
from hthor.humans.memory.location_priors import receptacle_kinds
from hthor.humans.memory.object_memory import Forgetting, KnownObject, ObjectMemory
from hthor.humans.memory.spatial_memory import KnownPlace, SpatialMemory
from hthor.humans.perception.detection_rate import Head, PlaceDetection, apparent_size, detection_rate, expected_size
from hthor.humans.perception.exposure_log import ExposureLog, Glimpse
from hthor.types import Detection, Observation, Vec3

GLIMPSE_TICKS = 3
"""[ticks] Time from one glimpse to the next. Our choice, after about three fixations a second."""
_LONGEST_S = 0.6
"""[s] Longest time that one glimpse counts for, for example after a long motion. Our choice."""
_LARGE_M = 0.5
"""[m] Things longer than this are recognised like furniture. Our choice."""
_NEAR_M = 1.0
"""[m] Distance from a point being searched within which things are attended to. Our choice."""


class Eyes:
    """Turns detections into knowledge; ``current`` is the object of the current subgoal, which is not forgotten.

    ``attention`` is what is being searched: a place, a point [m], or nothing in particular.
    """

    def __init__(self, human: HumanContext, objects: ObjectMemory, memory: SpatialMemory) -> None:
        self.human, self.traits, self.objects, self.memory = human, human.traits, objects, memory
        self.current: KnownObject = next(iter(objects.known.values()))
        self.attention: KnownPlace | Vec3 | None = None
        self.at = -1
        self._before = -1
        self._place_detection = PlaceDetection(
            human.traits, sum(map(expected_size, objects.known)) / len(objects.known)
        )
        self._forgetting, self._exposures = Forgetting(human, objects, memory), ExposureLog(human)
        self._holders = frozenset(receptacle_kinds())
        self._gathered: dict[str, float] = {}
        self._threshold: dict[str, float] = {}

    def look(self, now: Observation) -> None:
        """Process one glimpse."""
        tick, pose, wanted, kinds = now.tick, now.pose, self.objects.known, self._holders
        tick_s = self.human.tick_s
        seconds = min(_LONGEST_S, (tick - self.at) * tick_s) if self.at >= 0 else tick_s
        self._before, self.at = self.at, tick
        head = Head(pose, self.human.body.eye)
        for seen in now.detections:
            family = seen.family
            if family == "furniture":
                if seen.kind in kinds:
                    self._furniture(seen, head, seconds)
            elif family == "doorway":
                self.memory.keep_doorway(seen, (pose.x, pose.y), now.room)
            elif seen.id in wanted:
                self._object(wanted[seen.id], seen, head, seconds)
        if self._forgetting.is_due():
            self._forget()

    def lose(self, known: KnownObject) -> None:
        """Note that an object was forgotten or is not where it was; it must be noticed again."""
        self.objects.lose(known)
        self._reset(known.id)

    def end(self) -> None:
        """At the end of the trial, add the objects never noticed to the journal."""
        self._exposures.end()

    def _object(self, known: KnownObject, seen: Detection, head: Head, seconds: float) -> None:
        now = self.human.now
        if known.seen is None:
            if not self._notices(known, seen, head, seconds):
                return
            self._exposures.close(known.id, noticed=True)
            self._publish(Noticed(tick=self.at, seat=self.human.seat, object=seen.id, position=seen.position))
        if known.at != self._before:
            known.views += 1
        self.objects.see(known, seen, now.tick, (now.pose.x, now.pose.y))

    def _notices(self, known: KnownObject, seen: Detection, head: Head, seconds: float) -> bool:
        if max(seen.size) > _LARGE_M:
            return self._gather(known.id, self._rate_of_large(seen) * seconds, known.lost)
        (far, ecc), sighting = head.to(seen.position), self.human.now.senses.sighting(seen.id)
        share, beside = sighting.share, sighting.beside
        angle, attended = apparent_size(seen.size) / far, self._attended(seen)
        self._exposures.add(known.id, Glimpse(seconds, angle, ecc, share, beside, attended))
        faster = self.traits.focus if attended else 1.0
        return self._gather(
            known.id, faster * detection_rate(self.traits, angle, ecc, share, beside) * seconds, known.lost
        )

    def _furniture(self, seen: Detection, head: Head, seconds: float) -> None:
        memory, place, tick = self.memory, self.memory.places.get(seen.id), self.at
        if place is None or not place.recalled:
            if not self._gather(seen.id, self._rate_of_large(seen) * seconds, 0 if place is None else place.lost):
                return
            place = memory.keep_place(seen)
            self._publish(Noticed(tick=self.at, seat=self.human.seat, object=seen.id, position=seen.position))
        elif seen.state:
            memory.keep_place(seen)
        if place.at != self._before:
            place.views += 1
        place.at = tick
        if place.state != "closed":
            memory.expose(place, self._place_detection.rate(head, seen.position) * seconds, tick)

    def _rate_of_large(self, seen: Detection) -> float:
        """Rate [1/s] of recognising furniture and other large things."""
        return self.traits.lam_furniture / (1.0 + (seen.distance / self.traits.d_furniture) ** 2)

    def _attended(self, seen: Detection) -> bool:
        spot = self.attention
        if isinstance(spot, KnownPlace):
            return seen.support == spot.id or spot.covers(seen.position)
        return spot is not None and math.dist(spot[:2], seen.position[:2]) < _NEAR_M

    def _gather(self, name: str, amount: float, again: int) -> bool:
        """Add to a thing's sum; True when the thing, lost ``again`` times so far, is noticed."""
        threshold = self._threshold.get(name)
        if threshold is None:
            threshold = -math.log(self.human.draw("notice", name, again))
            self._threshold[name] = threshold
        gathered = self._gathered.get(name, 0.0) + amount
        self._gathered[name] = gathered
        return gathered >= threshold

    def _forget(self) -> None:
        for known in self._forgetting.forgotten_objects(self.current):
            where = None if known.seen is None else known.seen.position
            self._publish(Forgot(tick=self.at, seat=self.human.seat, object=known.id, position=where))
            self.lose(known)
        for place in self._forgetting.forgotten_places():
            self._publish(Forgot(tick=self.at, seat=self.human.seat, object=place.id))
            self.memory.lose(place)
            self._reset(place.id)

    def _reset(self, name: str) -> None:
        self._gathered.pop(name, None)
        self._threshold.pop(name, None)

    def _publish(self, thought: HumanThought) -> None:
        if self.human.listener is not None:
            self.human.listener(thought)
