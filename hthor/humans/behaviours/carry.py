"""Carrying an object that is too heavy for one person: take hold, wait for a helper, follow or lead.

The object rises once several carriers hold it. A walking carrier pulls the others along; one who lets go puts it down.
Whoever comes first takes the far end and so leaves the near one to the helper, who need not get past them. Who has held
one end in vain tries the other one next. Both are our choice.
"""

import math
from collections.abc import Sequence
from functools import partial

from hthor.geometry.plane import to_house
from hthor.humans.core.trial_context import Behaviour
from hthor.humans.memory.subgoals import Subgoal, SubgoalTracker
from hthor.humans.motor.approach import Approach, rings
from hthor.humans.search.exploration import Exploration
from hthor.humans.search.option_choice import OptionChoice
from hthor.navigation.planner import Planner
from hthor.types import Detection, Drop, Pick, Vec2, Vec3, Wait

_WATCH_S = 0.5
"""[s] Time between two looks at the load. Our choice."""
_LEAVE_S = 3.0
"""[s] How long people stay at a load that they have put down. Our choice."""
_STILL_M = 0.02
"""[m] A person who moved less than this between two looks is standing still. Our choice."""
_NEAR_M = 0.45
"""[m] Distance from its spot within which a load may be put down. Our choice."""
_ENOUGH_M = 0.7
"""[m] The same distance for a load that does not come closer. Our choice."""
_BESIDE_M = 1.5
"""[m] Somebody within this distance of the load is assumed to hold it or to be about to. Our choice."""
_PATIENCE = 3.0
"""[ratio] How much longer people hold their end for a helper while somebody is beside the load. Our choice."""
_NEARER_M = 0.3
"""[m] How much nearer than the other end an end has to be for people to be at its side of the load. Our choice."""
_AT_END_M = 0.8
"""[m] How near to its end people stand to lift a load. Our choice: not with the arm stretched out."""
_AHEAD_M = (0.8, 0.5)
"""[m] How far past the spot to walk, so that the load ends up on it; the first with room is used. Our choice."""
_TURNS_RAD = tuple(side * math.radians(30.0 * k) for k in range(5) for side in ((1.0, -1.0) if k else (1.0,)))
"""[rad] Directions in which people may walk past the spot, off straight on. Our choice: up to 120 degrees."""
_WIDE_M = 0.15
"""[m] How much farther than otherwise people who pull a load keep from corners. Our choice."""
_INSIDE_M = 1.9
"""[m] How deep into a room to walk, so that the load is inside it too. Our choice: more than the length of the load."""
_DIRECTIONS = 16
"""[count] Directions in which a spot deep inside a room is looked for. Our choice."""


class JointCarrying:
    """Helps to carry one heavy object."""

    def __init__(self, approach: Approach, exploration: Exploration, subgoals: SubgoalTracker) -> None:
        self.approach, self.exploration, self.subgoals, self.hands = approach, exploration, subgoals, exploration.hands
        self.human, self.memory, self.walker = approach.human, approach.memory, approach.walker
        self._search = OptionChoice(self.human, self.memory, self.walker, "room")
        self._vain = self._pulls = 0

    def carry(self, subgoal: Subgoal) -> Behaviour:
        """Take hold and bring the load to where it belongs; the participant leads when nobody has moved for a while."""
        if not self._holds(subgoal) and not (yield from self._take_hold(subgoal)):
            return False
        alone, still, here = 0.0, 0.0, self.human.here
        while self._holds(subgoal) and alone <= self.human.traits.partner:
            if not (yield from self._is_up(subgoal)):
                alone += _WATCH_S / (_PATIENCE if self._is_somebody_beside(subgoal) else 1.0)
            elif math.dist(self.human.here, here) > _STILL_M:
                still = 0.0
            else:
                still += _WATCH_S
                if self._is_there(subgoal):
                    break
                if still > self.human.traits.lead:
                    before = subgoal.known.seen
                    yield from self._lead_loaded(subgoal)
                    still = 0.0
                    if self._is_enough(subgoal, before):
                        break
            here = self.human.here
            yield Wait(seconds=_WATCH_S)
        if alone > self.human.traits.partner:
            self._vain += 1
        if self._holds(subgoal):
            yield Drop()
        seen = subgoal.known.seen
        if seen is not None:
            yield from self.human.look_at(seen.position)
        yield from self.human.rest(_LEAVE_S)
        return True

    def _holds(self, subgoal: Subgoal) -> bool:
        return self.human.now.holding == subgoal.target

    def _take_hold(self, subgoal: Subgoal) -> Behaviour:
        seen = subgoal.known.lies
        if seen is None:
            return False
        ends = sorted(_handles(seen), key=lambda end: -math.dist(end[:2], self.human.here))
        others = [one.position[:2] for one in self.human.now.detections if one.family in ("robot", "person")]
        beside = [spot for spot in others if math.dist(spot, seen.position[:2]) < _BESIDE_M]
        if beside:  # the free handle first
            ends.sort(key=lambda end: -math.dist(end[:2], beside[0]))
        end = ends[(self._vain or self.approach.tries) % len(ends)]
        self.walker.map.include(end[:2])
        if not (yield from self._go_to(end, ends)):
            return False
        reason = yield from self.hands.do(Pick(object=subgoal.target), f"pick {subgoal.target}")
        return not reason

    def _go_to(self, end: Vec3, ends: Sequence[Vec3]) -> Behaviour:
        """Walk to where an end can be taken, if possible on its own side of the load."""
        spot = self._beyond(end, ends)
        if spot is not None and (yield from self.walker.go(spot)):
            self.approach.tries += 1
            yield from self.human.look_at(end)
            return True
        return (yield from self.approach.to_object(end, "", self.approach.arm))

    def _beyond(self, end: Vec3, ends: Sequence[Vec3]) -> Vec2 | None:
        """The spot nearest on foot from which this end is clearly nearer than the other."""
        other = next(one for one in ends if one != end)
        spots = [
            spot
            for spot in rings(end, _AT_END_M)
            if math.dist(spot, other[:2]) > math.dist(spot, end[:2]) + _NEARER_M and self.walker.map.planner.fits(*spot)
        ]
        far = self.walker.map.planner.distances(self.human.here, spots) if spots else ()
        ranked = [(way, spot) for way, spot in zip(far, spots, strict=True) if math.isfinite(way)]
        return min(ranked)[1] if ranked else None

    def _is_up(self, subgoal: Subgoal) -> Behaviour:
        """Look at the load; True when it is off the floor."""
        seen = subgoal.known.seen
        if seen is not None:
            yield from self.human.look_at(seen.position)
        seen = subgoal.known.seen
        return seen is not None and bool(seen.held_by)

    def _is_somebody_beside(self, subgoal: Subgoal) -> bool:
        """Whether another person was seen next to the load, or a robot is in view there, who may take the other end."""
        seen, others = subgoal.known.seen, self.human.others.recent(self.human.now.tick)
        spots = [one.spot for one in others]
        spots += [one.position[:2] for one in self.human.now.detections if one.family == "robot"]
        return seen is not None and any(math.dist(spot, seen.position[:2]) < _BESIDE_M for spot in spots)

    def _is_there(self, subgoal: Subgoal) -> bool:
        """Whether the load may be put down here, as far as the participant sees."""
        seen = subgoal.known.seen
        if seen is None:
            return False
        if subgoal.spot is not None:
            return math.dist(seen.position[:2], subgoal.spot[:2]) < _NEAR_M
        return self.subgoals.room_of(seen.position) in subgoal.job.destinations

    def _is_enough(self, subgoal: Subgoal, before: Detection | None) -> bool:
        """Whether the load is close to its spot and did not get closer although it was pulled."""
        seen = subgoal.known.seen
        if seen is None or before is None or subgoal.spot is None:
            return False
        apart = math.dist(seen.position[:2], subgoal.spot[:2])
        return _ENOUGH_M > apart > math.dist(before.position[:2], subgoal.spot[:2]) - _STILL_M

    def _lead_loaded(self, subgoal: Subgoal) -> Behaviour:
        """Lead; meanwhile it is rather the load that is stuck than the participant."""
        self.walker.loaded = True
        try:
            return (yield from self._lead(subgoal))
        finally:
            self.walker.loaded = False

    def _lead(self, subgoal: Subgoal) -> Behaviour:
        """Pull the load to where it belongs; False when there is no path."""
        if subgoal.spot is not None:
            return (yield from self._pull_to(subgoal, subgoal.spot))
        rooms = subgoal.job.destinations
        arrived = partial(self._is_over, subgoal)
        if not arrived():
            known = next((self.memory.entered[room] for room in rooms if room in self.memory.entered), None)
            if known is None:
                yield from self.exploration.look_for(self._search, arrived)
            else:
                yield from self.walker.go(known, stop=arrived)
        spot = self._deep_inside() if self.human.now.room in rooms and self._holds(subgoal) else None
        return spot is not None and (yield from self.walker.go(spot, stop=lambda: not self._holds(subgoal)))

    def _is_over(self, subgoal: Subgoal) -> bool:
        return not self._holds(subgoal) or self.human.now.room in subgoal.job.destinations

    def _pull_to(self, subgoal: Subgoal, spot: Vec3) -> Behaviour:
        seen = subgoal.known.seen
        start = seen.position if seen is not None else (*self.human.here, 0.0)
        for point in (*self._wide_path(spot[:2]), self._past(start[:2], spot[:2])):
            if not (yield from self.walker.go(point, stop=lambda: not self._holds(subgoal))):
                return False
        return True

    def _past(self, start: Vec2, spot: Vec2) -> Vec2:
        """Where to walk from the spot, so that the load ends up on it: past it, as nearly straight on as there is room.

        Each pull after the first prefers another direction.
        """
        ahead, planner = math.atan2(spot[1] - start[1], spot[0] - start[0]), self.walker.map.planner
        self._pulls += 1
        turns = _TURNS_RAD[(self._pulls - 1) % len(_TURNS_RAD) :] + _TURNS_RAD[: (self._pulls - 1) % len(_TURNS_RAD)]
        for far in _AHEAD_M:
            for off in turns:
                point = (spot[0] + far * math.cos(ahead + off), spot[1] + far * math.sin(ahead + off))
                if planner.fits(*point) and planner.straight(spot, point):
                    return point
        return spot

    def _wide_path(self, goal: Vec2) -> tuple[Vec2, ...]:
        """A path that takes corners wide, so that the load gets round them too; only the goal if there is none."""
        wide = Planner(self.walker.map.grid, self.human.body.radius + _WIDE_M, optimistic=True)
        path = wide.path(self.human.here, goal, _WIDE_M) or ()
        return (*(point for point in path if math.dist(point, self.human.here) > _STILL_M), goal)

    def _deep_inside(self) -> Vec2 | None:
        """A spot in this room whose distance from the entrance is more than the length of the load."""
        door = self.memory.entered.get(self.human.now.room)
        if door is None:
            return None
        angles = [2.0 * math.pi * k / _DIRECTIONS for k in range(_DIRECTIONS)]
        ring = [(door[0] + _INSIDE_M * math.cos(a), door[1] + _INSIDE_M * math.sin(a)) for a in angles]
        spots = [
            spot
            for spot in ring
            if self.walker.map.planner.fits(*spot) and self.subgoals.room_of((*spot, 0.0)) == self.human.now.room
        ]
        far = self.walker.map.planner.distances(self.human.here, spots) if spots else ()
        ranked = [(way, spot) for way, spot in zip(far, spots, strict=True) if math.isfinite(way)]
        return min(ranked)[1] if ranked else None


def _handles(seen: Detection) -> tuple[Vec3, Vec3]:
    """Where the two handles of a load are [m], at the ends of its length."""
    half = seen.size[0] / 2.0
    return to_house((half, 0.0, 0.0), seen.position, seen.yaw), to_house((-half, 0.0, 0.0), seen.position, seen.yaw)
