"""The participant's mental map: the floor that was seen, and ways over it, assuming that unseen floor is free."""

import math
from itertools import pairwise

from msgspec import Struct

from hthor.geometry.plane import wrap
from hthor.humans.core.trial_context import HumanContext
from hthor.humans.memory.spatial_memory import KnownDoorway, SpatialMemory
from hthor.humans.motor.encounters import Obstacle, planner_around
from hthor.navigation.grid_map import FREE, GridMap
from hthor.navigation.planner import Planner, path_length
from hthor.types import Vec2

_MAP_EVERY_M = 0.4
"""[m] Distance walked after which the view is added to the map. Our choice."""
_MAP_EVERY_RAD = 0.6
"""[rad] Angle turned after which the view is added to the map. Our choice."""
_FAMILIAR = 1.5
"""[ratio] A path over seen floor may be this times as long as one over unseen floor, plus `_FAMILIAR_M`. Our choice."""
_FAMILIAR_M = 2.0
"""[m] Part of that permitted length that does not depend on the path's length. Our choice."""
_DOORWAY_M = 1.0
"""[m] How much longer a path through a known doorway may be than one over unseen floor. Our choice."""
_TRUSTED_S = 10.0
"""[s] A map younger than this is not thrown away even if it shows no path. Our choice."""


class Route(Struct, frozen=True, kw_only=True):
    """A path [m] to a goal ``metres`` away, or only to just behind the ``doorway`` that should lead there."""

    path: tuple[Vec2, ...]
    metres: float
    doorway: KnownDoorway | None = None


class MentalMap:
    """What the participant has seen of the floor, and ways through it.

    ``planner`` treats unseen floor as free, and furniture and walls that were seen as obstacles.
    """

    def __init__(self, human: HumanContext, memory: SpatialMemory, x: float, y: float) -> None:
        self.human, self.memory = human, memory
        self._drawn = human.now.tick
        self._draw(x, y)

    def _draw(self, x: float, y: float) -> None:
        self.grid = GridMap(x, y)
        self.planner = Planner(self.grid, self.human.body.radius, optimistic=True)
        self._mapped: tuple[float, float, float] | None = None

    def sense(self) -> None:
        """Add what is in view to the map, when the view has changed enough."""
        pose, last = self.human.now.pose, self._mapped
        if last is not None:
            near = math.hypot(pose.x - last[0], pose.y - last[1]) < _MAP_EVERY_M
            if near and abs(wrap(pose.yaw - last[2])) < _MAP_EVERY_RAD:
                return
        self._mapped = (pose.x, pose.y, pose.yaw)
        self.grid.integrate(self.human.now.scan)

    def include(self, point: Vec2) -> None:
        """Extend the map to a ``point`` [m] that was seen through doors, farther away than the map reaches."""
        self.grid.include(*point)

    def route(self, goal: Vec2, within: float) -> Route | None:
        """The way to ``goal`` [m]: over seen floor if not much longer, else by a doorway, else over unseen floor."""
        hopeful = _as_route(self.planner.path(self.human.here, goal, within))
        if hopeful is None:
            return _as_route(self.planner.path(self.human.here, goal, within)) if self._begin_new_map() else None
        if all(self.grid.seen(a, b) for a, b in pairwise(hopeful.path)):
            return hopeful
        known = self._known(goal, within)
        if known is not None and known.metres <= _FAMILIAR * hopeful.metres + _FAMILIAR_M:
            return known
        return self._by_doorway(goal, hopeful.metres + _DOORWAY_M) or hopeful

    def route_around(self, obstacle: Obstacle, goal: Vec2, within: float) -> Route | None:
        """The way to ``goal`` [m] round a disc on the floor; None also when the disc leaves no room at the goal."""
        radius = self.human.body.radius
        if math.dist(obstacle[:2], goal) <= obstacle[2] + radius + within:
            return None
        return _as_route(planner_around(self.grid, radius, obstacle).path(self.human.here, goal, within))

    def length(self, goal: Vec2, within: float) -> float:
        """Length of the shortest path to ``goal`` [m] on this map; infinite if there is none."""
        path = self.planner.path(self.human.here, goal, within)
        return math.inf if path is None else path_length(path)

    def _known(self, goal: Vec2, within: float) -> Route | None:
        """A path over floor that was seen."""
        if within <= 0.0 and self.grid.at(*goal) != FREE:
            return None
        self.planner.optimistic = False
        try:
            return _as_route(self.planner.path(self.human.here, goal, within))
        finally:
            self.planner.optimistic = True

    def _by_doorway(self, goal: Vec2, most: float) -> Route | None:
        """The shortest path through an unexplored doorway, if its length is below ``most`` metres."""
        doors = self.memory.unexplored_doorways()
        here, best = self.human.here, None
        least = {door.id: math.dist(here, door.beyond) + math.dist(door.beyond, goal) for door in doors}
        for door in sorted(doors, key=lambda door: (least[door.id], door.id)):
            if least[door.id] >= most:
                break
            rest = math.dist(door.beyond, goal)
            path = self.planner.path(here, door.beyond, most=most - rest)
            if path is not None and path_length(path) + rest < most:
                most = path_length(path) + rest
                best = Route(path=path, metres=most, doorway=door)
        return best

    def _begin_new_map(self) -> bool:
        """Begin a new map if the map is old, as obstacles may have moved; returns whether a new map began."""
        if self.human.now.tick < self._drawn + round(_TRUSTED_S / self.human.tick_s):
            return False
        self._drawn = self.human.now.tick
        self._draw(*self.human.here)
        self.sense()
        return True


def _as_route(path: tuple[Vec2, ...] | None) -> Route | None:
    return None if path is None else Route(path=path, metres=path_length(path))
