"""Carrying what is too heavy for one: take hold, wait for another, go along or go ahead.

Several hold a thing by its handles. Once they are strong enough together it is off the floor, and whoever goes draws
the others along; whoever lets go puts it down.
"""

from __future__ import annotations

import math
from functools import partial

from hthor.geometry.plane import to_house
from hthor.humans.core.trial_context import Deed, Subject
from hthor.humans.memory.spatial_memory import Memory
from hthor.humans.memory.subgoals import Duties, Duty
from hthor.humans.motor.approach import REACH, Approach
from hthor.humans.motor.locomotion import Walker
from hthor.humans.motor.manipulation import Hands
from hthor.humans.search.exploration import Exploring
from hthor.humans.search.option_choice import Search
from hthor.types import Detection, Drop, Pick, Vec2, Vec3, Wait

_GLANCE_S = 0.5
_LEAVE_S = 3.0
_STILL_M = 0.02
_NEAR_M = 0.45
_BESIDE_M = 1.5
_AHEAD_M = (0.7, 0.4, 0.0)
"""How far past the place to go, so that what hangs behind comes to lie there."""
_INSIDE_M = 1.9
"""How deep into a room to go, so that what hangs behind is in it too."""
_DIRECTIONS = 16


class Hauling:
    """Helps to carry one heavy thing."""

    def __init__(
        self,
        me: Subject,
        memory: Memory,
        walker: Walker,
        approach: Approach,
        exploring: Exploring,
        hands: Hands,
        duties: Duties,
    ) -> None:
        self.me, self.memory, self.walker, self.approach = me, memory, walker, approach
        self.exploring, self.hands, self.duties = exploring, hands, duties
        self._search = Search(me, memory, walker, {}, "room")

    def haul(self, duty: Duty) -> Deed:
        """Take hold, and bring it where it belongs together with whoever takes the other end.

        Whoever wants to may go first; the person does when nobody has for a while.
        """
        if not self._holds(duty) and not (yield from self._take_hold(duty)):
            return False
        alone, still, here = 0.0, 0.0, self.me.here
        while self._holds(duty) and alone <= self.me.traits.partner:
            if not (yield from self._is_up(duty)):
                alone += _GLANCE_S
            elif math.dist(self.me.here, here) > _STILL_M:
                still = 0.0
            else:
                still += _GLANCE_S
                if self._is_there(duty):
                    break
                if still > self.me.traits.lead:
                    yield from self._go_first(duty)
                    still = 0.0
            here = self.me.here
            yield Wait(seconds=_GLANCE_S)
        if self._holds(duty):
            yield Drop()
        seen = duty.known.seen
        if seen is not None:
            yield from self.me.look_at(seen.position)
        yield from self.me.rest(_LEAVE_S)
        return True

    def _holds(self, duty: Duty) -> bool:
        return self.me.now.holding == duty.target

    def _take_hold(self, duty: Duty) -> Deed:
        seen = duty.known.lies
        if seen is None:
            return False
        ends = sorted(_handles(seen), key=lambda end: math.dist(end[:2], self.me.here))
        robots = [one.position[:2] for one in self.me.now.detections if one.family == "robot"]
        beside = [spot for spot in robots if math.dist(spot, seen.position[:2]) < _BESIDE_M]
        if beside:  # the handle that nobody stands at first
            ends.sort(key=lambda end: -math.dist(end[:2], beside[0]))
        end = ends[self.approach.tries % len(ends)]
        if not (yield from self.approach.to_object(end, "", self.me.body.reach * REACH)):
            return False
        reason = yield from self.hands.do(Pick(object=duty.target), f"pick {duty.target}")
        return not reason

    def _is_up(self, duty: Duty) -> Deed:
        """Look at it: whether it is off the floor."""
        seen = duty.known.seen
        if seen is not None:
            yield from self.me.look_at(seen.position)
        seen = duty.known.seen
        return seen is not None and bool(seen.held_by)

    def _is_there(self, duty: Duty) -> bool:
        """Whether it may be put down, as far as one sees."""
        seen = duty.known.seen
        if seen is None:
            return False
        if duty.spot is not None:
            return math.dist(seen.position[:2], duty.spot[:2]) < _NEAR_M
        return self.duties.room_of(seen.position) in duty.job.destinations

    def _go_first(self, duty: Duty) -> Deed:
        """Draw it along to where it belongs; False when there is no way."""
        if duty.spot is not None:
            return (yield from self._pull_to(duty, duty.spot))
        rooms = duty.job.destinations
        arrived = partial(self._is_over, duty)
        if not arrived():
            known = next((self.memory.entered[room] for room in rooms if room in self.memory.entered), None)
            if known is None:
                yield from self.exploring.look_for(self._search, arrived)
            else:
                yield from self.walker.go(known, stop=arrived)
        spot = self._deeper() if self.me.now.room in rooms and self._holds(duty) else None
        return spot is not None and (yield from self.walker.go(spot, stop=lambda: not self._holds(duty)))

    def _is_over(self, duty: Duty) -> bool:
        return not self._holds(duty) or self.me.now.room in duty.job.destinations

    def _pull_to(self, duty: Duty, spot: Vec3) -> Deed:
        seen = duty.known.seen
        start = seen.position if seen is not None else (*self.me.here, 0.0)
        far = max(math.dist(start[:2], spot[:2]), 1e-6)
        ux, uy = (spot[0] - start[0]) / far, (spot[1] - start[1]) / far
        goals = [(spot[0] + ahead * ux, spot[1] + ahead * uy) for ahead in _AHEAD_M]
        goal = next((goal for goal in goals if self.walker.planner.fits(*goal)), goals[-1])
        return (yield from self.walker.go(goal, stop=lambda: not self._holds(duty)))

    def _deeper(self) -> Vec2 | None:
        """A spot well inside this room, farther from where it was entered than the thing is long."""
        door = self.memory.entered.get(self.me.now.room)
        if door is None:
            return None
        angles = [2.0 * math.pi * k / _DIRECTIONS for k in range(_DIRECTIONS)]
        ring = [(door[0] + _INSIDE_M * math.cos(a), door[1] + _INSIDE_M * math.sin(a)) for a in angles]
        spots = [
            spot
            for spot in ring
            if self.walker.planner.fits(*spot) and self.duties.room_of((*spot, 0.0)) == self.me.now.room
        ]
        far = self.walker.planner.distances(self.me.here, spots) if spots else ()
        ranked = [(way, spot) for way, spot in zip(far, spots, strict=True) if math.isfinite(way)]
        return min(ranked)[1] if ranked else None


def _handles(seen: Detection) -> tuple[Vec3, Vec3]:
    """Where the two handles of a thing are [m], at the ends of its length."""
    half = seen.size[0] / 2.0
    return to_house((half, 0.0, 0.0), seen.position, seen.yaw), to_house((-half, 0.0, 0.0), seen.position, seen.yaw)
