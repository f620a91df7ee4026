"""How a person gets about: on a map of their own, at their own pace, hopeful about what they have not seen."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from itertools import pairwise

from msgspec import Struct

from hthor.geometry.plane import wrap
from hthor.humans.core.trial_context import GAZE_PITCH, Deed, Subject
from hthor.humans.memory.spatial_memory import Doorway, Memory
from hthor.navigation.grid_map import CELL_M, FREE, GridMap
from hthor.navigation.path_follower import toward
from hthor.navigation.planner import Planner, length
from hthor.types import Motion, Move, Rotate, Vec2, Wait

_TURN_RAD = math.radians(12.0)
_MAP_EVERY_M, _MAP_EVERY_RAD = 0.4, 0.6
_ARRIVED_M = 0.03
_CHECK_TICKS = 5
_CREEP = 0.3
_DETOUR, _DETOUR_M = 1.4, 1.5
_FAMILIAR, _FAMILIAR_M = 1.5, 2.0
_DOORWAY_M = 1.0
_GIVE_UP, _REPLANS = 12, 100
_POLITE_S, _AVOID_S, _TRUSTED_S = 0.5, 6.0, 10.0
_ASIDE_RAD = math.radians(60.0)


class Way(Struct, frozen=True, kw_only=True):
    """A path [m] to a goal ``metres`` away, or only to just behind the ``doorway`` that should lead there."""

    path: tuple[Vec2, ...]
    metres: float
    doorway: Doorway | None = None


def never() -> bool:
    """Never stop early."""
    return False


class Walker:
    """Legs and the map in the head.

    ``haste`` scales the pace: below 1 while reading or following a map. Nearer than ``margin`` [m] to a piece of
    furniture, what is on the map is taken for a part of it. A person's stick gives the pace directly, one short move a
    tick; larger turns are made standing, and while people are ``looking`` for something they stop now and then to look
    aside.
    """

    def __init__(self, me: Subject, memory: Memory, x: float, y: float, margin: float = 0.12) -> None:
        self.me, self.memory, self.haste, self.margin, self._bumps = me, memory, 1.0, margin, 0
        self.looking = True
        self._robot: tuple[float, float, float] | None = None
        self._robot_until = -1
        self._drawn = me.now.tick
        self._stops = 0
        self._until_stop = self._stretch()
        self._draw_map(x, y)

    def _draw_map(self, x: float, y: float) -> None:
        self.grid = GridMap(x, y)
        self.planner = Planner(self.grid, self.me.body.radius, optimistic=True)
        self._mapped: tuple[float, float, float] | None = None

    def sense(self) -> None:
        """Bring the map up to date, when the view has changed enough."""
        pose, last = self.me.now.pose, self._mapped
        if last is not None:
            near = math.hypot(pose.x - last[0], pose.y - last[1]) < _MAP_EVERY_M
            if near and abs(wrap(pose.yaw - last[2])) < _MAP_EVERY_RAD:
                return
        self._mapped = (pose.x, pose.y, pose.yaw)
        self.grid.integrate(self.me.now.scan)

    def go(self, goal: Vec2, within: float = 0.0, stop: Callable[[], bool] = never) -> Deed:
        """Walk to ``goal`` [m], or to where it is within ``within`` metres; False when there is no way.

        A way that turns out to be blocked, so that the next one is much longer, is no way either: time to think again.

        Args:
            stop: asked before each motion; the walk ends, well, when it says so.
        """
        self._bumps, budget, here = 0, math.inf, self.me.here
        for _ in range(_REPLANS):
            way = self._way(goal, within)
            budget, here = budget - math.dist(here, self.me.here), self.me.here
            if way is None or way.metres > budget:
                return False
            budget, bumps = min(budget, _DETOUR * way.metres + _DETOUR_M), self._bumps
            ended = yield from self._follow(way.path, stop)
            if ended and (way.doorway is None or stop()):
                return True
            if ended and way.doorway is not None:
                way.doorway.passed = True
            if self._bumps > bumps:
                budget = math.inf
            if self._bumps >= _GIVE_UP:
                return False
        return False

    def _way(self, goal: Vec2, within: float) -> Way | None:
        """How to get to the goal: where one has been if that is not much farther, else by a doorway, else straight on.

        None when there is no way or a robot stands on the goal.
        """
        if self._robot is not None and self.me.now.tick <= self._robot_until:
            x, y, radius = self._robot
            if math.dist((x, y), goal) <= radius + self.me.body.radius + within:
                return None
            return _as_way(_planner_with(self.grid, self.me.body.radius, x, y, radius).path(self.me.here, goal, within))
        hopeful = _as_way(self.planner.path(self.me.here, goal, within))
        if hopeful is None:
            return _as_way(self.planner.path(self.me.here, goal, within)) if self._doubted() else None
        if all(self.grid.seen(a, b) for a, b in pairwise(hopeful.path)):
            return hopeful
        known = self._known(goal, within)
        if known is not None and known.metres <= _FAMILIAR * hopeful.metres + _FAMILIAR_M:
            return known
        return self._by_doorway(goal, hopeful.metres + _DOORWAY_M) or hopeful

    def _known(self, goal: Vec2, within: float) -> Way | None:
        """A way over floor that was seen."""
        if within <= 0.0 and self.grid.at(*goal) != FREE:
            return None
        self.planner.optimistic = False
        try:
            return _as_way(self.planner.path(self.me.here, goal, within))
        finally:
            self.planner.optimistic = True

    def _by_doorway(self, goal: Vec2, most: float) -> Way | None:
        """The way through the doorway not yet passed that promises the shortest way, ``most`` metres in all."""
        doors = [door for door in self.memory.doorways.values() if door.sides and not door.spent]
        here, best = self.me.here, None
        least = {door.id: math.dist(here, door.beyond) + math.dist(door.beyond, goal) for door in doors}
        for door in sorted(doors, key=lambda door: (least[door.id], door.id)):
            if least[door.id] >= most:
                break
            rest = math.dist(door.beyond, goal)
            path = self.planner.path(here, door.beyond, most=most - rest)
            if path is not None and length(path) + rest < most:
                most = length(path) + rest
                best = Way(path=path, metres=most, doorway=door)
        return best

    def _follow(self, path: tuple[Vec2, ...], stop: Callable[[], bool]) -> Deed:
        """Walk the path; False when it turns out to be blocked."""
        me, ahead, left, moves = self.me, list(path), math.inf, 0
        now, checked = me.now, me.now.tick
        while not stop():
            pose = now.pose
            here = pose.x, pose.y
            while ahead and math.dist(ahead[0], here) <= _ARRIVED_M:
                ahead.pop(0)
            if not ahead:
                return True
            if now.tick - checked >= _CHECK_TICKS:
                checked = now.tick
                if not self._open(ahead):
                    return False
                was, left = left, length((here, *ahead))
                if moves >= _CHECK_TICKS and left > was - _CREEP * moves * self._pace() * me.tick_s:
                    yield from self._give_way(ahead[0])
                    return False
                moves = 0
            motion = toward(pose, ahead[0], self._pace() * me.tick_s, _TURN_RAD)
            if isinstance(motion, Move):
                yield motion
                now, moves = me.now, moves + 1
                outcome = now.outcome
                if outcome is not None and not outcome.ok and outcome.motion == "move":
                    yield from self._give_way(ahead[0])
                    return False
                self._until_stop -= me.tick_s if self.looking else 0.0
                if self._until_stop <= 0.0:
                    yield from self._look_aside()
                    now = me.now
            else:
                yield self._measured(motion)
                now = me.now
        return True

    def _pace(self) -> float:
        return min(self.me.traits.v_pace * self.haste, self.me.body.speed)

    def _stretch(self) -> float:
        """Seconds under way until the next stop to look."""
        return -self.me.traits.stop_every * math.log(self.me.draw("stop", self._stops))

    def _look_aside(self) -> Deed:
        """Stop, look to the side that chance names, and stand a moment."""
        me, number = self.me, self._stops
        self._stops += 1
        self._until_stop = self._stretch()
        yield from me.look_round(_ASIDE_RAD * me.draw("aside", number), "stop", number)
        yield from me.rest(me.traits.stop_s)
        return True

    def _measured(self, motion: Motion) -> Motion:
        if isinstance(motion, Rotate):
            return self.me.turn(motion.yaw, GAZE_PITCH - self.me.now.pose.pitch)
        return motion

    def _open(self, ahead: list[Vec2]) -> bool:
        """Whether the rest of the way still looks free."""
        return self.planner.clear((self.me.here, *ahead))

    def _bumped(self) -> bool:
        outcome = self.me.now.outcome
        return outcome is not None and outcome.motion == "move" and not outcome.ok

    def _give_way(self, ahead: Vec2) -> Deed:
        """Put furniture that is felt on the map; wait for what moves, then plan round it."""
        self._bumps += 1
        outcome = self.me.now.outcome
        if self._bumped() and outcome is not None and not outcome.by.startswith("robot"):
            self._mark(ahead)
            return True
        obstacle = self._felt(ahead)
        yield Wait(seconds=_POLITE_S)
        if self._bumps > 1:
            self._robot, self._robot_until = obstacle, self.me.now.tick + round(_AVOID_S / self.me.tick_s)
        return True

    def _felt(self, ahead: Vec2) -> tuple[float, float, float]:
        """Middle and radius [m] of what stands in the way ``ahead``: as large as oneself, as near as a touch."""
        (x, y), radius = self.me.here, self.me.body.radius
        share = 2.0 * radius / max(math.dist((x, y), ahead), 1e-9)
        return (x + share * (ahead[0] - x), y + share * (ahead[1] - y), radius)

    def _mark(self, point: Vec2) -> None:
        """Something that no scan showed stands in the direction of ``point`` [m], in touch with the body."""
        (x, y), apart = self.me.here, math.dist(self.me.here, point)
        if apart > 0.0:
            share = (self.me.body.radius + 0.05) / apart
            self.grid.mark_blocked(x + share * (point[0] - x), y + share * (point[1] - y))

    def _doubted(self) -> bool:
        """Throw a map away that shows no way: what was felt may have gone, what was seen may have been seen badly."""
        if self.me.now.tick < self._drawn + round(_TRUSTED_S / self.me.tick_s):
            return False
        self._drawn = self.me.now.tick
        self._draw_map(*self.me.here)
        self.sense()
        return True


def _as_way(path: tuple[Vec2, ...] | None) -> Way | None:
    return None if path is None else Way(path=path, metres=length(path))


def _planner_with(grid: GridMap, radius: float, x: float, y: float, size: float) -> Planner:
    """A planner on a copy of the map in which a disc of radius ``size`` [m] stands at (``x``, ``y``)."""
    trial = copy.deepcopy(grid)
    count = math.ceil(2.0 * math.pi * size / CELL_M)
    for k in range(count):
        angle = 2.0 * math.pi * k / count
        trial.mark_blocked(x + size * math.cos(angle), y + size * math.sin(angle))
    return Planner(trial, radius, optimistic=True)
