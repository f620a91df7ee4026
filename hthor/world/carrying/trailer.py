"""A thing that several bodies carry by its handles: one step of the leader, the thing, and the followers.

Seen from above, the thing is a rectangle with a handle at either end; each bearer holds one at arm's length::

    leader  o----[=========]----o  follower
            arm  handle   handle  arm

Like a trailer on a drawbar, the thing has no drive of its own. Each step is solved by position-based dynamics (Müller
et al. 2007, "Position based dynamics"): the handles are pulled towards the bearers until no arm is longer than allowed,
and the rectangle is pushed out of walls and bodies. Each correction is the smallest shift and turn of a uniform plate
that satisfies its constraint (`hthor.world.carrying.trailer_kernel`). Then each follower walks along its handle's path,
round the same corners. A step is taken only if the thing then overlaps nothing and no arm is beyond its body's reach.

All lengths, angles and counts below are our choice.
"""

import math
from collections.abc import Callable, Sequence

import msgspec
import numpy as np

from hthor import rules
from hthor.geometry.plane import turn
from hthor.geometry.ray_casting import Floats
from hthor.types import Vec2
from hthor.world.carrying import trailer_kernel
from hthor.world.carrying.load import Load
from hthor.world.records import LoadRecord
from hthor.world.state.body_state import BodyState
from hthor.world.state.movable_object import MovableObject

ARM_M = 0.30
"""[m] Distance from a bearer's side to its handle; an arm is longer than this only for a short time."""
ELBOW_M = 0.03
"""[m] Gap kept free between a bearer's disc and the thing."""
TOUCH_M = 0.002
"""[m] Overlaps up to this depth are ignored because the solver does not remove them completely."""
_ITERATIONS = 4
"""How many times per step the solver alternates between the thing and the followers."""
_LEADER_PULL_M, _FOLLOWER_PULL_M = 0.005, 0.001
"""[m] The most by which one pull moves a leader's or a follower's handle, so that the thing slides along obstacles."""
_STEP_SHARES = (1.0, 0.5, 0.25, 0.0)
"""Shares of a step that a leader tries in turn; with the last share only the followers move, to catch up."""
_STEP_MAX_M = 0.3
"""[m] The longest motion in one step; obstacles farther away are ignored in that step."""
_IN_WAY_GAP_M = 0.06
"""[m] A body farther than this from the leader or the thing is not named as being in the way."""
_PATH_RESOLUTION_M = 1e-4
"""[m] Points of a path that are closer together than this count as one point."""
_STANDSTILL_M = 0.002
"""[m] A thing that moves less than this in a tick counts as standing still."""
_STUCK_STRETCH_M, _STEER_GAIN_M = 0.05, 0.008
"""[m] A thing is stuck if it stands still while the leader's path to it is too long by the first length; then the pull
is turned aside if that moves the thing by the second length."""
_STEER_ANGLES = tuple(math.radians(angle) for angle in (30.0, -30.0, 60.0, -60.0, 90.0, -90.0))
"""[rad] Angles by which the pull on a stuck thing is turned aside, tried in this order."""
_STEER_TICKS = 8
"""[ticks] How long the pull stays turned aside."""
_FOLLOW_ANGLES = tuple(side * math.radians(15.0 * k) for k in range(9) for side in ((1.0, -1.0) if k else (1.0,)))
"""[rad] Angles off the straight line that a follower tries, up to 120 degrees to either side, the smallest first."""

_Step = tuple[Floats, dict[str, Vec2], dict[str, tuple[Vec2, ...]]]
"""A solved step: the thing's state (3,), each bearer's place, and each bearer's path from its handle."""


class TrailerLoad(Load):
    """A thing that its bearers carry together.

    Args:
        obstacles: returns the rectangles (N, 5) in its way now, see `hthor.world.carrying.trailer_kernel`.
    """

    def __init__(self, item: MovableObject, seats: Sequence[BodyState], obstacles: Callable[[], Floats]) -> None:
        super().__init__(item, seats)
        self._obstacles = obstacles
        self._paths: dict[str, tuple[Vec2, ...]] = {}
        self._steer_angle, self._steer_left = 0.0, 0
        self._horizon = float(self.half[0]) + _STEP_MAX_M + max((seat.spec.reach for seat in seats), default=0.0)

    def record(self) -> LoadRecord:
        """The state of the thing and its bearers."""
        x, y, yaw = (float(value) for value in self.state)
        return LoadRecord(
            item=self.item.id,
            ends=self.ends,
            up=self.up,
            leader=self._leader,
            tick=self._tick,
            z=self.z,
            state=(x, y, yaw),
            paths=self._paths,
            steer_angle=self._steer_angle,
            steer_left=self._steer_left,
        )

    def restore(self, record: LoadRecord) -> None:
        """Go back to a state."""
        self.ends, self._paths = dict(record.ends), dict(record.paths)
        self.up, self._leader, self._tick, self.z = record.up, record.leader, record.tick, record.z
        self.state = np.array(record.state)
        self._steer_angle, self._steer_left = record.steer_angle, record.steer_left

    def lead(self, leader: BodyState, dx: float, dy: float) -> bool:
        """Move ``leader`` by (dx, dy) [m], or by a share of it, and the thing and the other bearers with it.

        Returns:
            whether anything moved. A step that would end in a wall, in a body or out of a bearer's reach is not taken.
        """
        obstacles = trailer_kernel.nearby_rectangles(self.state, self._horizon, self._obstacles())
        strangers = self._stranger_discs()
        self._steer_left = max(0, self._steer_left - 1)
        step = self._step(leader, (dx, dy), self._steer_angle if self._steer_left else 0.0, obstacles, strangers)
        if step is None or (self._displacement(step) < _STANDSTILL_M and self._is_stuck(leader, obstacles)):
            for angle in _STEER_ANGLES:
                other = self._step(leader, (dx, dy), angle, obstacles, strangers)
                if other is not None and self._displacement(other) > _STEER_GAIN_M:
                    step, self._steer_angle, self._steer_left = other, angle, _STEER_TICKS
                    break
        least = min(_STANDSTILL_M, math.hypot(dx, dy) / 2.0)  # the end of a move may be shorter than a standstill
        return step is not None and self._take_step(*step, obstacles, leader, least)

    def body_in_the_way(self, leader: BodyState) -> str:
        """The seat of a body too close to the leader or, unless it is a bearer, to the thing; empty for none."""
        for other in self.seats:
            apart = math.dist((leader.pose.x, leader.pose.y), (other.pose.x, other.pose.y))
            disc = np.array((other.pose.x, other.pose.y, other.spec.radius + _IN_WAY_GAP_M))
            touched = other.name not in self.ends and trailer_kernel.disc_contact(self.state, self.half, disc)[0] > 0.0
            if other is not leader and (touched or apart < leader.spec.radius + other.spec.radius + _IN_WAY_GAP_M):
                return other.name
        return ""

    def _step(self, leader: BodyState, by: Vec2, steer: float, obstacles: Floats, strangers: Floats) -> _Step | None:
        """The solution with the largest share of a step that is valid; None if no share is."""
        before = trailer_kernel.deepest_contacts(self.state, self.half, obstacles, strangers)
        for share in _STEP_SHARES:
            to = (leader.pose.x + share * by[0], leader.pose.y + share * by[1])
            if share and not self._can_go(leader, to):
                continue
            state, places = self._solve(leader, to, steer, obstacles, strangers)
            wall, body = trailer_kernel.deepest_contacts(state, self.half, obstacles, strangers)
            if wall <= max(TOUCH_M, before[0]) and body <= max(TOUCH_M, before[1]):
                paths = {seat.name: self._path(seat, state, places[seat.name]) for seat in self.bearers}
                if self._is_valid(state, places, paths, obstacles):
                    return state, places, paths
        return None

    def _displacement(self, step: _Step) -> float:
        """How far the thing's ends move in a step [m], by its shift and its turn."""
        (x, y, yaw), now = step[0], self.state
        return math.hypot(x - now[0], y - now[1]) + float(self.half[0] * abs(yaw - now[2]))

    def _is_stuck(self, seat: BodyState, obstacles: Floats) -> bool:
        way = self._path_to(seat, self.state, (seat.pose.x, seat.pose.y))
        return trailer_kernel.taut_length(way, obstacles) > _arm_length(seat) + _STUCK_STRETCH_M

    def _solve(
        self, leader: BodyState, to: Vec2, steer: float, obstacles: Floats, strangers: Floats
    ) -> tuple[Floats, dict[str, Vec2]]:
        """Where the thing and its bearers end up when the leader goes to ``to``."""
        bearers, state = self.bearers, self.state
        places = {seat.name: (seat.pose.x, seat.pose.y) for seat in bearers}
        places[leader.name] = to
        ends = np.array([self.ends[seat.name] * self.half[0] for seat in bearers])
        pulls = np.array([_LEADER_PULL_M if seat is leader else _FOLLOWER_PULL_M for seat in bearers])
        first = [number for number, seat in enumerate(bearers) if seat is leader]
        for _ in range(_ITERATIONS):
            hands, ropes = self._pull_points(state, places, obstacles, leader, steer)
            discs = np.array([(*places[seat.name], seat.spec.radius + ELBOW_M) for seat in bearers])
            near = np.concatenate((strangers, discs[first]))
            state = trailer_kernel.relax(state, self.half, ends, hands, ropes, pulls, obstacles, near)
            for seat in bearers:
                if seat is not leader:
                    places[seat.name] = self._follow(seat, state, places, obstacles)
            hands, ropes = self._pull_points(state, places, obstacles, leader, steer)
            discs[:, :2] = [places[seat.name] for seat in bearers]
            near = np.concatenate((strangers, discs))
            state = trailer_kernel.relax(state, self.half, ends, hands, ropes, pulls, obstacles, near)
        return state, places

    def _pull_points(
        self, state: Floats, places: dict[str, Vec2], obstacles: Floats, leader: BodyState, steer: float
    ) -> tuple[Floats, Floats]:
        """The point towards which each bearer pulls its handle round corners, and the arm length left there [m]."""
        hands, ropes = [], []
        for seat in self.bearers:
            way = self._path_to(seat, state, places[seat.name])
            aim = trailer_kernel.aim_index(way, obstacles)
            x, y = way[aim]
            if steer and seat is leader:
                dx, dy = turn((x - way[0][0], y - way[0][1]), steer)
                x, y = way[0][0] + dx, way[0][1] + dy
            hands.append((x, y))
            ropes.append(max(0.0, _arm_length(seat) - trailer_kernel.path_length(way[aim:])))
        return np.array(hands), np.array(ropes)

    def _follow(self, seat: BodyState, state: Floats, places: dict[str, Vec2], obstacles: Floats) -> Vec2:
        """The place to which a follower goes when its handle moves away from it or the thing is pushed into it."""
        here = places[seat.name]
        way = self._path_to(seat, state, here)[::-1]
        aim = trailer_kernel.aim_index(way, obstacles)
        far = math.dist(here, way[aim])
        spare = far + trailer_kernel.path_length(way[aim:]) - _arm_length(seat)
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

    def _handle(self, seat: BodyState, state: Floats) -> Vec2:
        x, y = turn((self.ends[seat.name] * float(self.half[0]), 0.0), float(state[2]))
        return (float(state[0]) + x, float(state[1]) + y)

    def _path_to(self, seat: BodyState, state: Floats, place: Vec2) -> tuple[Vec2, ...]:
        """The path from the handle to its bearer, along which one of the two has followed the other."""
        return (self._handle(seat, state), *self._paths.get(seat.name, ()), place)

    def _path(self, seat: BodyState, state: Floats, place: Vec2) -> tuple[Vec2, ...]:
        """The path between the handle and its bearer once both have moved."""
        path, now, end = self._paths.get(seat.name, ()), (seat.pose.x, seat.pose.y), self._handle(seat, self.state)
        before = (end,) if math.dist(end, self._handle(seat, state)) > _PATH_RESOLUTION_M else ()
        after = (now,) if math.dist(now, place) > _PATH_RESOLUTION_M else ()
        return (*before, *path, *after)

    def _is_valid(
        self, state: Floats, places: dict[str, Vec2], paths: dict[str, tuple[Vec2, ...]], obstacles: Floats
    ) -> bool:
        """Whether every arm is within reach, and the thing overlaps no bearer more deeply than before."""
        for seat in self.bearers:
            place = places[seat.name]
            way = (self._handle(seat, state), *paths[seat.name], place)
            if trailer_kernel.taut_length(way, obstacles) > seat.spec.reach:
                return False
            now = np.array((seat.pose.x, seat.pose.y, seat.spec.radius))
            deep = trailer_kernel.disc_contact(state, self.half, np.array((*place, seat.spec.radius)))[0]
            if deep > max(TOUCH_M, trailer_kernel.disc_contact(self.state, self.half, now)[0]):
                return False
        return True

    def _take_step(
        self,
        state: Floats,
        places: dict[str, Vec2],
        paths: dict[str, tuple[Vec2, ...]],
        obstacles: Floats,
        leader: BodyState,
        least: float,
    ) -> bool:
        """Take the step unless nothing moves by more than ``least`` [m]; returns whether it was taken."""
        ways_gone = (math.dist(places[seat.name], (seat.pose.x, seat.pose.y)) for seat in self.bearers)
        if max(self._displacement((state, places, paths)), *ways_gone) <= least:
            return False
        ways = {seat: (places[seat.name][0] - seat.pose.x, places[seat.name][1] - seat.pose.y) for seat in self.bearers}
        if not all(seat.loose is None or seat.loose.make_way(seat, way) for seat, way in ways.items()):
            return False
        for seat in self.bearers:
            place, pose = places[seat.name], seat.pose
            path = (self._handle(seat, state), *paths[seat.name], place)
            if seat is leader:
                paths[seat.name] = path[trailer_kernel.aim_index(path, obstacles) : -1]
            else:
                paths[seat.name] = path[::-1][trailer_kernel.aim_index(path[::-1], obstacles) : -1][::-1]
            if place != (pose.x, pose.y) or seat is leader:  # a new record tells the world that something has moved
                seat.pose = msgspec.structs.replace(pose, x=float(place[0]), y=float(place[1]))
        self.state, self._paths = state, paths
        return True

    def _can_go(self, seat: BodyState, to: Vec2) -> bool:
        here = (seat.pose.x, seat.pose.y)
        return seat.space.segment_free(here, to) and self._clear(seat, here, to, {})

    def _clear(self, seat: BodyState, here: Vec2, to: Vec2, places: dict[str, Vec2]) -> bool:
        """Whether a step stays clear of all other bodies; moving away from a body is always allowed."""
        for other in self.seats:
            if other is not seat:
                at = places.get(other.name, (other.pose.x, other.pose.y))
                apart = math.dist(to, at)
                if apart < seat.spec.radius + other.spec.radius - 1e-9 and apart < math.dist(here, at):
                    return False
        return True

    def _stranger_discs(self) -> Floats:
        step = [(one.pose.x, one.pose.y, one.spec.radius) for one in self.seats if one.name not in self.ends]
        return np.array(step).reshape(-1, 3)


def _arm_length(seat: BodyState) -> float:
    return min(seat.spec.radius + ARM_M, seat.spec.reach)
