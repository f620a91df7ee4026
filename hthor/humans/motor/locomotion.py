"""How a participant walks: at their own pace, on a map of what was seen, assuming that unseen floor is free."""

import math
from collections.abc import Callable

from hthor.humans.core.trial_context import GAZE_PITCH, Behaviour, HumanContext
from hthor.humans.memory.spatial_memory import SpatialMemory
from hthor.humans.motor.encounters import (
    AVOID_S,
    KEEP_BEHIND_S,
    Encounters,
    Obstacle,
    goes_ahead,
    person_ahead,
)
from hthor.humans.motor.mental_map import MentalMap, Route
from hthor.navigation.path_follower import toward
from hthor.navigation.planner import path_length
from hthor.types import Motion, Move, Rotate, Vec2, Wait, is_person

_TURN_RAD = math.radians(12.0)
"""[rad] Larger direction errors are corrected while standing, smaller errors while walking. Our choice: 12 degrees."""
_ARRIVED_M = 0.03
"""[m] A point of the path this near has been reached. Our choice."""
_CHECK_TICKS = 5
"""[ticks] How often people check that the way ahead is free and that they advance. Our choice: twice a second."""
_CREEP = 0.3
"""[ratio] Share of their pace below which people believe that they are blocked. Our choice."""
_DETOUR = 1.4
"""[ratio] A new path that is longer than this times the first, plus `_DETOUR_M`, is not taken. Our choice."""
_DETOUR_M = 1.5
"""[m] Part of a permitted detour that does not depend on the path's length. Our choice."""
_GIVE_UP = 12
"""[count] Bumps after which a walk is given up. Our choice."""
_REPLANS = 100
"""[count] Plans of a path after which a walk is given up. Our choice."""
_POLITE_S = 0.5
"""[s] How long people wait for a robot or another person in their way. Our choice."""
_AVOID_S = 6.0
"""[s] How long people plan around a robot or another person who did not move. Our choice."""
_ASIDE_RAD = math.radians(60.0)
"""[rad] Largest turn aside at a stop to look. Our choice: 60 degrees."""
_FELT_M = 0.05
"""[m] Distance beyond the body's edge at which a bump marks an obstacle. Our choice."""
MARGIN_M = 0.06
"""[m] Obstacles this near to the end of a line to furniture belong to the furniture. Our choice: walls are thicker."""


def never() -> bool:
    """Never stop early."""
    return False


class Walker:
    """Legs and a mental map. The stick sets the pace directly, one short move per tick; larger turns are made standing.

    ``haste`` scales the pace, below 1 while reading or following a map; ``looking``: the participant is searching, and
    stops now and then to look aside; ``loaded``: they pull a load that others carry too.
    """

    margin = MARGIN_M

    def __init__(self, human: HumanContext, memory: SpatialMemory, x: float, y: float) -> None:
        self.human, self.haste, self._bumps = human, 1.0, 0
        self.map = MentalMap(human, memory, x, y)
        self.looking, self.loaded = True, False
        self._robot: Obstacle | None = None
        self._robot_until = -1
        self.encounters = Encounters(human)
        self._stops = 0
        self._until_stop = self._stretch()

    def go(self, goal: Vec2, within: float = 0.0, stop: Callable[[], bool] = never) -> Behaviour:
        """Walk to ``goal`` [m], or to within ``within`` metres of it; False when there is no path.

        Also False when the path turns out to be blocked and the next one is much longer: the caller may choose again.

        Args:
            stop: checked before each motion; the walk ends successfully when it returns True.
        """
        self._bumps, budget, here = 0, math.inf, self.human.here
        for _ in range(_REPLANS):
            way = self._route(goal, within)
            budget, here = budget - math.dist(here, self.human.here), self.human.here
            avoids = self._avoids_person()
            if way is None or way.metres > (min(budget, self._longest_detour(goal, within)) if avoids else budget):
                if self._bumps >= _GIVE_UP or not self.encounters.blocks(goal, within):
                    return False
                self._bumps, self._robot_until, budget = self._bumps + 1, -1, math.inf
                yield from self.encounters.let_by(self.map.planner)
                continue
            budget, bumps = min(budget, _DETOUR * way.metres + _DETOUR_M), self._bumps
            ended = yield from self._follow(way.path, (lambda: stop() or not self._avoids_person()) if avoids else stop)
            if avoids and not stop() and math.dist(self.human.here, way.path[-1]) > _ARRIVED_M:
                ended = False  # the person has probably moved on: look for a shorter path
            if ended and (way.doorway is None or stop()):
                return True
            if ended and way.doorway:
                way.doorway.passed = True
            if self._bumps > bumps:
                budget = math.inf
            if self._bumps >= _GIVE_UP:
                return False
        return False

    def _route(self, goal: Vec2, within: float) -> Route | None:
        """The way to the goal, for a while round a robot or a person who did not move."""
        if self._robot is not None and self.human.now.tick <= self._robot_until:
            return self.map.route_around(self._robot, goal, within)
        return self.map.route(goal, within)

    def _avoids_person(self) -> bool:
        """Whether paths are planned round another person now."""
        return self.encounters.met is not None and self.human.now.tick <= self._robot_until

    def _longest_detour(self, goal: Vec2, within: float) -> float:
        """How long a path round a person may be [m]: for a longer one, people rather wait or step back."""
        return _DETOUR * self.map.length(goal, within) + _DETOUR_M

    def _follow(self, path: tuple[Vec2, ...], stop: Callable[[], bool]) -> Behaviour:
        """Walk the path; False when it turns out to be blocked."""
        human, ahead, left, moves = self.human, list(path), math.inf, 0
        now, checked = human.now, human.now.tick
        while not stop():
            pose = now.pose
            here = pose.x, pose.y
            while ahead and math.dist(ahead[0], here) <= _ARRIVED_M:
                ahead.pop(0)
            if not ahead:
                return True
            if now.tick - checked >= _CHECK_TICKS:
                checked = now.tick
                if not self.map.planner.clear((self.human.here, *ahead)):  # the rest of the path is not free any more
                    return False
                was, left = left, path_length((here, *ahead))
                if moves >= _CHECK_TICKS and left > was - _CREEP * moves * self._pace() * human.tick_s:
                    yield from self._give_way(ahead[0])
                    return False
                moves = 0
            motion = toward(pose, ahead[0], self._pace() * human.tick_s, _TURN_RAD)
            if isinstance(motion, Move):
                met = person_ahead(human, ahead[0]) if human.others.seats else None
                if met is not None:
                    yield Wait(seconds=KEEP_BEHIND_S)
                    if not goes_ahead(human, met, ahead[0]):
                        self._avoid(met.spot)
                        return False
                    now, checked, left, moves = human.now, human.now.tick, math.inf, 0
                    continue
                yield motion
                now, moves = human.now, moves + 1
                outcome = now.outcome
                if outcome is not None and not outcome.ok and outcome.motion == "move":
                    yield from self._give_way(ahead[0])
                    return False
                self._until_stop -= human.tick_s if self.looking else 0.0
                if self._until_stop <= 0.0:
                    yield from self._look_aside()
                    now = human.now
            else:
                yield self._at_own_rate(motion)
                now = human.now
        return True

    def _pace(self) -> float:
        return min(self.human.traits.v_pace * self.haste, self.human.body.speed)

    def _stretch(self) -> float:
        """Walking time [s] until the next stop to look."""
        return -self.human.traits.stop_every * math.log(self.human.draw("stop", self._stops))

    def _look_aside(self) -> Behaviour:
        """Stop, look to a random side, and stand a moment."""
        human, number = self.human, self._stops
        self._stops += 1
        self._until_stop = self._stretch()
        yield from human.look_round(_ASIDE_RAD * human.draw("aside", number), "stop", number)
        yield from human.rest(human.traits.stop_s)
        return True

    def _at_own_rate(self, motion: Motion) -> Motion:
        """A turn at the participant's own speed of turning."""
        if isinstance(motion, Rotate):
            return self.human.turn(motion.yaw, GAZE_PITCH - self.human.now.pose.pitch)
        return motion

    def _give_way(self, ahead: Vec2) -> Behaviour:
        """Put furniture that was bumped into on the map; wait for a robot or another person, then plan around them."""
        self._bumps += 1
        outcome = self.human.now.outcome
        bumped = outcome is not None and outcome.motion == "move" and not outcome.ok
        if bumped and outcome is not None and not outcome.by.startswith(("robot", "human")):
            if not self.loaded:  # else it is rather the load that is stuck
                self._mark(ahead)
            return True
        obstacle = self._felt(ahead)
        yield Wait(seconds=_POLITE_S)
        if bumped and outcome and is_person(outcome.by):
            self._avoid(obstacle[:2])
        elif self._bumps > 1:
            self.encounters.forget()
            self._robot, self._robot_until = obstacle, self.human.now.tick + round(_AVOID_S / self.human.tick_s)
        return True

    def _avoid(self, other: Vec2) -> None:
        """Plan round a person at ``other`` [m] for a while."""
        self._robot = self.encounters.avoid(other)
        self._robot_until = self.human.now.tick + round(AVOID_S / self.human.tick_s)

    def _felt(self, ahead: Vec2) -> Obstacle:
        """Middle and radius [m] of the obstacle ahead: assumed to be as large as the participant, and to touch them."""
        (x, y), radius = self.human.here, self.human.body.radius
        share = 2.0 * radius / max(math.dist((x, y), ahead), 1e-9)
        return (x + share * (ahead[0] - x), y + share * (ahead[1] - y), radius)

    def _mark(self, point: Vec2) -> None:
        """Put an obstacle that no scan showed on the map, in the direction of ``point`` [m], just beyond the body."""
        (x, y), apart = self.human.here, math.dist(self.human.here, point)
        if apart > 0.0:
            share = (self.human.body.radius + _FELT_M) / apart
            self.map.grid.mark_blocked(x + share * (point[0] - x), y + share * (point[1] - y))
