"""A thing that is carried by its handles, its leader and those who are drawn along: one step of all.

The thing goes after its leader, and the others go after the thing, each on the tracks of what it follows, so that
they come round the same corners; see `hthor.world.carrying.follow_paths`. A step is worked out first and taken only
if all is well after it: the thing in no wall and in nobody, every arm no longer than it is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from hthor import rules
from hthor.geometry.plane import turn
from hthor.types import Pose, Vec2
from hthor.world.carrying import follow_paths as ways
from hthor.world.carrying import trailer_kernel
from hthor.world.carrying.load import Load
from hthor.world.state.body_state import BodyState
from hthor.world.state.movable_object import MovableObject

ARM_M = 0.30
"""How far from its bearer's side a handle is carried; arms stretch further only for a while."""
ELBOW_M = 0.03
"""What stays free between a bearer and what it carries."""
TOUCH_M = 0.002
"""Being less deep in something than this does not count."""
_ITERATIONS = 4
"""How often in a step the thing goes after those who hold it, and they after it."""
_LEADER_PULL_M, _FOLLOWER_PULL_M = 0.005, 0.001
"""How far a leader draws its handle at a time, and how far one who is drawn along holds it back."""
_STEP_SHARES = (1.0, 0.5, 0.25, 0.0)
"""Parts of a step that a leader tries; with the last the others catch up."""
_STEP_MAX_M = 0.3
"""Nothing goes farther in a step."""
_IN_WAY_GAP_M = 0.06
"""Who is farther away than this was in nobody's way."""
_PATH_RESOLUTION_M = 1e-4
"""Tracks are not kept finer than this."""
_STANDSTILL_M = 0.002
"""Whoever moves less in a tick stands still."""
_STUCK_STRETCH_M, _STEER_GAIN_M = 0.05, 0.008
"""An arm longer by the first while the thing stands still: it is caught. Then a pull aside is worth the second."""
_STEER_ANGLES = tuple(math.radians(angle) for angle in (30.0, -30.0, 60.0, -60.0, 90.0, -90.0))
_STEER_TICKS = 8
"""What is caught is pulled aside at one of these angles [rad], for so long."""
_FOLLOW_ANGLES = tuple(side * math.radians(15.0 * k) for k in range(9) for side in ((1.0, -1.0) if k else (1.0,)))
"""Ways that somebody who is drawn along tries, off the straight one [rad]."""

_Step = tuple[Any, dict[str, Vec2], dict[str, tuple[Vec2, ...]]]
"""A step of all: the thing's state, its bearers' places, and the lanes between them."""


class TrailerLoad(Load):
    """A load on its way.

    Args:
        rows: gives (N, 5) what stands in its way now, see `hthor.world.carrying.trailer_kernel`.
    """

    def __init__(self, item: MovableObject, seats: Sequence[BodyState], rows: Callable[[], Any]) -> None:
        super().__init__(item, seats)
        self._rows = rows
        self._lanes: dict[str, tuple[Vec2, ...]] = {}
        self._bend, self._bent = 0.0, 0
        self._around = float(self.half[0]) + _STEP_MAX_M + max((seat.spec.reach for seat in seats), default=0.0)

    def lead(self, leader: BodyState, dx: float, dy: float) -> bool:
        """Let ``leader`` go by (dx, dy) [m], or by a part of it, and all that hangs on it come along.

        Returns:
            whether anything moved. Nothing does that would end in a wall, in somebody, or out of a bearer's reach.
        """
        rows, strangers = trailer_kernel.nearby_rectangles(self.state, self._around, self._rows()), self._strangers()
        self._bent = max(0, self._bent - 1)
        found = self._step(leader, (dx, dy), self._bend if self._bent else 0.0, rows, strangers)
        if found is None or (self._stir(found) < _STANDSTILL_M and self._stretched(leader, rows)):
            for angle in _STEER_ANGLES:
                other = self._step(leader, (dx, dy), angle, rows, strangers)
                if other is not None and self._stir(other) > _STEER_GAIN_M:
                    found, self._bend, self._bent = other, angle, _STEER_TICKS
                    break
        return found is not None and self._accept(*found, rows, leader)

    def beside(self, leader: BodyState) -> str:
        """The seat of a body so close to the leader, or of a stranger so close to the thing, that it is in the way."""
        for other in self.seats:
            apart = math.dist((leader.pose.x, leader.pose.y), (other.pose.x, other.pose.y))
            disc = np.array((other.pose.x, other.pose.y, other.spec.radius + _IN_WAY_GAP_M))
            touched = other.name not in self.ends and trailer_kernel.disc_contact(self.state, self.half, disc)[0] > 0.0
            if other is not leader and (touched or apart < leader.spec.radius + other.spec.radius + _IN_WAY_GAP_M):
                return other.name
        return ""

    def _step(self, leader: BodyState, by: Vec2, bend: float, rows: Any, strangers: Any) -> _Step | None:
        """The longest part of a step after which all is well, None when there is none."""
        before = trailer_kernel.deepest_contacts(self.state, self.half, rows, strangers)
        for share in _STEP_SHARES:
            to = (leader.pose.x + share * by[0], leader.pose.y + share * by[1])
            if share and not self._may(leader, to):
                continue
            state, places = self._drawn(leader, to, bend, rows, strangers)
            wall, body = trailer_kernel.deepest_contacts(state, self.half, rows, strangers)
            if wall <= max(TOUCH_M, before[0]) and body <= max(TOUCH_M, before[1]):
                lanes = {seat.name: self._lane(seat, state, places[seat.name]) for seat in self.bearers}
                if self._sound(state, places, lanes, rows):
                    return state, places, lanes
        return None

    def _stir(self, found: _Step) -> float:
        """How far the thing goes in a step [m]."""
        (x, y, yaw), now = found[0], self.state
        return math.hypot(x - now[0], y - now[1]) + float(self.half[0] * abs(yaw - now[2]))

    def _stretched(self, seat: BodyState, rows: Any) -> bool:
        way = self._way(seat, self.state, (seat.pose.x, seat.pose.y))
        return ways.taut_length(way, rows) > _arm_length(seat) + _STUCK_STRETCH_M

    def _drawn(
        self, leader: BodyState, to: Vec2, bend: float, rows: Any, strangers: Any
    ) -> tuple[Any, dict[str, Vec2]]:
        """Where the thing and its bearers come to be when the leader goes there."""
        bearers, state = self.bearers, self.state
        places = {seat.name: (seat.pose.x, seat.pose.y) for seat in bearers}
        places[leader.name] = to
        ends = np.array([self.ends[seat.name] * self.half[0] for seat in bearers])
        pulls = np.array([_LEADER_PULL_M if seat is leader else _FOLLOWER_PULL_M for seat in bearers])
        first = [number for number, seat in enumerate(bearers) if seat is leader]
        for _ in range(_ITERATIONS):
            hands, ropes = self._hands(state, places, rows, leader, bend)
            discs = np.array([(*places[seat.name], seat.spec.radius + ELBOW_M) for seat in bearers])
            near = np.concatenate((strangers, discs[first]))
            state = trailer_kernel.relax(state, self.half, ends, hands, ropes, pulls, rows, near)
            for seat in bearers:
                if seat is not leader:
                    places[seat.name] = self._come(seat, state, places, rows)
            hands, ropes = self._hands(state, places, rows, leader, bend)
            discs[:, :2] = [places[seat.name] for seat in bearers]
            near = np.concatenate((strangers, discs))
            state = trailer_kernel.relax(state, self.half, ends, hands, ropes, pulls, rows, near)
        return state, places

    def _hands(self, state: Any, places: dict[str, Vec2], rows: Any, leader: BodyState, bend: float) -> tuple[Any, Any]:
        """Where each bearer draws its handle to, and what is left of its arm there: round corners on its own tracks."""
        hands, ropes = [], []
        for seat in self.bearers:
            way = self._way(seat, state, places[seat.name])
            aim = ways.aim_index(way, rows)
            x, y = way[aim]
            if bend and seat is leader:
                dx, dy = turn((x - way[0][0], y - way[0][1]), bend)
                x, y = way[0][0] + dx, way[0][1] + dy
            hands.append((x, y))
            ropes.append(max(0.0, _arm_length(seat) - ways.path_length(way[aim:])))
        return np.array(hands), np.array(ropes)

    def _come(self, seat: BodyState, state: Any, places: dict[str, Vec2], rows: Any) -> Vec2:
        """Where a bearer goes whose handle is drawn away from it, or pushed towards it."""
        here = places[seat.name]
        way = self._way(seat, state, here)[::-1]
        aim = ways.aim_index(way, rows)
        far = math.dist(here, way[aim])
        spare = far + ways.path_length(way[aim:]) - _arm_length(seat)
        deep, nx, ny, _, _ = trailer_kernel.disc_contact(
            state, self.half, np.array((*here, seat.spec.radius + ELBOW_M))
        )
        if deep > 0.0:
            along, length = (-nx, -ny), float(deep)
        elif spare > 0.0 and far > 0.0:
            along, length = ((way[aim][0] - here[0]) / far, (way[aim][1] - here[1]) / far), min(spare, far)
        else:
            return here
        gone = math.dist(here, (seat.pose.x, seat.pose.y))
        length = min(length, seat.spec.speed * rules.TICK_S - gone)
        for angle in _FOLLOW_ANGLES if length > 1e-6 else ():
            x, y = turn(along, angle)
            to = (here[0] + length * x, here[1] + length * y)
            if seat.space.segment_free(here, to) and self._clear(seat, here, to, places):
                return to
        return here

    def _end(self, seat: BodyState, state: Any) -> Vec2:
        x, y = turn((self.ends[seat.name] * float(self.half[0]), 0.0), float(state[2]))
        return (float(state[0]) + x, float(state[1]) + y)

    def _way(self, seat: BodyState, state: Any, place: Vec2) -> tuple[Vec2, ...]:
        """From the handle to its bearer, the way that one of them went after the other."""
        return (self._end(seat, state), *self._lanes.get(seat.name, ()), place)

    def _lane(self, seat: BodyState, state: Any, place: Vec2) -> tuple[Vec2, ...]:
        """What lies between the handle and its bearer once both have moved."""
        lane, now, end = self._lanes.get(seat.name, ()), (seat.pose.x, seat.pose.y), self._end(seat, self.state)
        before = (end,) if math.dist(end, self._end(seat, state)) > _PATH_RESOLUTION_M else ()
        after = (now,) if math.dist(now, place) > _PATH_RESOLUTION_M else ()
        return (*before, *lane, *after)

    def _sound(self, state: Any, places: dict[str, Vec2], lanes: dict[str, tuple[Vec2, ...]], rows: Any) -> bool:
        """Whether no arm is stretched too far, and the thing is in no bearer that it was not in before."""
        for seat in self.bearers:
            place = places[seat.name]
            if ways.taut_length((self._end(seat, state), *lanes[seat.name], place), rows) > seat.spec.reach:
                return False
            now = np.array((seat.pose.x, seat.pose.y, seat.spec.radius))
            deep = trailer_kernel.disc_contact(state, self.half, np.array((*place, seat.spec.radius)))[0]
            if deep > max(TOUCH_M, trailer_kernel.disc_contact(self.state, self.half, now)[0]):
                return False
        return True

    def _accept(
        self, state: Any, places: dict[str, Vec2], lanes: dict[str, tuple[Vec2, ...]], rows: Any, leader: BodyState
    ) -> bool:
        """Take the step, unless nobody gets anywhere by it."""
        ways_gone = (math.dist(places[seat.name], (seat.pose.x, seat.pose.y)) for seat in self.bearers)
        if max(self._stir((state, places, lanes)), *ways_gone) <= _STANDSTILL_M:
            return False
        for seat in self.bearers:
            place, pose = places[seat.name], seat.pose
            way = (self._end(seat, state), *lanes[seat.name], place)
            if seat is leader:
                lanes[seat.name] = way[ways.aim_index(way, rows) : -1]
            else:
                lanes[seat.name] = way[::-1][ways.aim_index(way[::-1], rows) : -1][::-1]
            if place != (pose.x, pose.y) or seat is leader:  # a new record tells the world that something has moved
                seat.pose = Pose(x=float(place[0]), y=float(place[1]), yaw=pose.yaw, pitch=pose.pitch)
        self.state, self._lanes = state, lanes
        return True

    def _may(self, seat: BodyState, to: Vec2) -> bool:
        here = (seat.pose.x, seat.pose.y)
        return seat.space.segment_free(here, to) and self._clear(seat, here, to, {})

    def _clear(self, seat: BodyState, here: Vec2, to: Vec2, places: dict[str, Vec2]) -> bool:
        """Whether a step comes too close to nobody; away from those who are too close already it always may."""
        for other in self.seats:
            if other is not seat:
                at = places.get(other.name, (other.pose.x, other.pose.y))
                apart = math.dist(to, at)
                if apart < seat.spec.radius + other.spec.radius - 1e-9 and apart < math.dist(here, at):
                    return False
        return True

    def _strangers(self) -> Any:
        found = [(one.pose.x, one.pose.y, one.spec.radius) for one in self.seats if one.name not in self.ends]
        return np.array(found).reshape(-1, 3)


def _arm_length(seat: BodyState) -> float:
    return min(seat.spec.radius + ARM_M, seat.spec.reach)
