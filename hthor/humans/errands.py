"""What a person does in a trial, as deeds built from looking, walking and handling: search, fetch, deliver, follow.

Knows nothing of when to change from one to another.
"""

from __future__ import annotations

import math
from functools import partial

from hthor import catalog, rules
from hthor.geometry import to_house, to_local
from hthor.humans.approach import PATIENCE, REACH, Approach
from hthor.humans.beliefs import expectation
from hthor.humans.exploring import Exploring
from hthor.humans.hands import Hands
from hthor.humans.memory import Memory, Place
from hthor.humans.perception import Eyes
from hthor.humans.search import Search
from hthor.humans.subject import Deed, Subject
from hthor.humans.walking import Walker, never
from hthor.types import Detection, Pick, Vec2, Vec3
from hthor.types import Place as Put

_FOUND_M = 1.3
_EDGE_M = 0.12
_SLACK_M = 0.04
_BLINK_S = 0.4
_VIEWS = 3


class Errands:
    """Everything the person can set out to do."""

    def __init__(self, me: Subject, eyes: Eyes, memory: Memory, walker: Walker) -> None:
        self.me, self.eyes, self.memory, self.walker = me, eyes, memory, walker
        self.hands = Hands(me)
        self.exploring = Exploring(me, eyes, memory, walker, self.hands)
        self.approach = Approach(me, eyes, memory, walker)
        wanted = expectation(me.task.target, me.traits.w_prior)
        if me.task.destination in wanted:
            wanted = {**wanted, me.task.destination: wanted[me.task.destination] * me.traits.dest_factor}
        self._for_target = Search(me, memory, walker, wanted, "target")
        self._for_destination = Search(me, memory, walker, {}, "destination")

    def anew(self) -> None:
        """Forget what was tried: another errand begins."""
        self.approach.anew()
        self.eyes.attention = None

    def begin(self) -> Deed:
        """Take a moment, then look round."""
        yield from self.me.rest(self.me.traits.t_on)
        yield from self.exploring.look_round(self.me.traits.scan_first)
        return True

    def search(self) -> Deed:
        """Look for the target, one place or room after the other, for ever."""
        yield from self.exploring.look_for(self._for_target, never)
        return True

    def fetch(self) -> Deed:
        """Go to the target where it was noticed; take it in hand unless finding is all. False when that failed."""
        target = self.eyes.target
        if target is None:
            return False
        self.eyes.attention = target.position
        if self.me.task.relation == "find":
            arrived = yield from self.approach.to_object(
                target.position, target.support, self._sight_m(target.position), self._is_close
            )
        else:
            arrived = yield from self.approach.to_object(target.position, target.support, self.me.body.reach * REACH)
        if not arrived:
            self._despair()
            return False
        visible = yield from self._check(target)
        if not visible or self.me.task.relation == "find":
            return visible
        reason = yield from self.hands.do(Pick(object=target.id), f"pick {target.id}")
        return not reason

    def deliver(self) -> Deed:
        """Bring what is held to the destination, and look for one first when none is known."""
        yield from self.exploring.look_for(self._for_destination, lambda: self.knows(self.me.task.destination))
        place = self._destination()
        if place is None:
            return False
        if not (yield from self.approach.to_place(place)):
            return False
        if place.state == "closed" and (yield from self.exploring.open(place)):
            return False
        point = _resting_point(place, self.me.here, self.approach.tries - 1)
        yield from self.me.look_at(point)
        reason = yield from self.hands.do(Put(on=place.id, position=point), f"place {place.id}")
        return not reason

    def follow(self, position: Vec3) -> Deed:
        """Go where a robot says something is, and look there; True when all was done, whatever was found."""
        self.eyes.attention = position
        for _ in range(PATIENCE):
            place = self.memory.at(position)
            arrived = yield from self.approach.to_object(
                position, place.id if place else "", 1.0, partial(self._learnt, position, place)
            )
            if arrived and self.memory.at(position) is place:
                break
        place = self.memory.at(position)
        if place is not None and place.state == "closed":
            yield from self.exploring.open(place)
        for view in range(_VIEWS):  # a claim is worth another look, from where a door or a shelf hides less
            if view and place is not None:
                yield from self.approach.to_place(place)
            yield from self.me.look_at(position)
            yield from self.me.rest(self.me.traits.t_look)
        if place is not None:
            self.memory.expose(place, self.me.traits.e_done, self.me.now.tick)
        return True

    def knows(self, kind: str) -> bool:
        """Whether the person knows a place of this kind."""
        return any(place.kind == kind for place in self.memory.places.values())

    def _is_close(self) -> bool:
        target = self.eyes.target
        return target is not None and self.eyes.seen_at == self.me.now.tick and target.distance < _FOUND_M

    def _check(self, target: Detection) -> Deed:
        """Whether the target is in view from here; after several tries without, it is taken for gone."""
        yield from self.me.look_at(target.position)
        since = self.me.now.tick
        yield from self.me.rest(_BLINK_S)
        if self.eyes.seen_at >= since:
            return True
        self._despair()
        return False

    def _despair(self) -> None:
        """After several tries the target is taken for gone, or for a mistake."""
        if self.approach.tries > PATIENCE:
            self.anew()
            self.eyes.lose()

    def _sight_m(self, point: Vec3) -> float:
        """How far off [m] on the floor a point is near enough to the eye to count as found."""
        return math.sqrt(max(0.25, rules.FIND_RANGE_M**2 - (self.me.body.eye - point[2]) ** 2)) - _SLACK_M

    def _learnt(self, position: Vec3, before: Place | None) -> bool:
        """Whether the furniture at a position came into view on the way."""
        return before is None and self.memory.at(position) is not None

    def _destination(self) -> Place | None:
        """The nearest place known of the kind that the target shall go to; after several refusals, another one."""
        kind = self.me.task.destination
        known = [place for place in self.memory.places.values() if place.kind == kind]
        if not known:
            return None
        spots = [(place.centre[0], place.centre[1]) for place in known]
        reach = [max(place.size[:2]) / 2.0 + 0.5 for place in known]
        far = [self.walker.planner.distance(self.me.here, spot, r) for spot, r in zip(spots, reach, strict=True)]
        order = sorted(range(len(known)), key=lambda k: (far[k], known[k].id))
        return known[order[self.approach.tries // PATIENCE % len(order)]]


def _resting_point(place: Place, here: Vec2, number: int) -> Vec3:
    """A point on a surface of the place, near to the person at first, further along at later tries."""
    surfaces = catalog.kind(place.kind).rests(place.size)
    usable = [s for s in surfaces if 0.25 <= place.centre[2] + s.centre[2] <= 1.4] or list(surfaces)
    surface = usable[number // 3 % len(usable)] if usable else None
    if surface is None:
        return place.centre
    x, y, _ = to_local((here[0], here[1], 0.0), place.centre, place.yaw)
    shift = (0.0, 0.3, -0.3)[number % 3]
    half = [max(0.0, h - _EDGE_M) for h in surface.half]
    cx, cy, cz = surface.centre
    u, v = (x - cx, y - cy)
    if abs(v) - half[1] > abs(u) - half[0]:
        u += shift
    else:
        v += shift
    spot = (cx + max(-half[0], min(half[0], u)), cy + max(-half[1], min(half[1], v)), cz)
    return to_house(spot, place.centre, place.yaw)
