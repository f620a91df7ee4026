"""Going to the place that a robot's message names, and looking there from several sides.

While the map on the display is shown, it gives the place all the time, so people do not make the error of 20 to 40
degrees that they make when they point from memory. Reading the map has two costs: a slower pace (``k_map``), and paths
that end at a wall. With the map hidden, people go to where they remember the place (`hthor.humans.memory.map_memory`).
"""

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from hthor.geometry.plane import wrap
from hthor.humans.core.trial_context import Behaviour
from hthor.humans.memory.spatial_memory import KnownPlace
from hthor.humans.motor import approach
from hthor.humans.motor.approach import TRIED_M
from hthor.humans.search.exploration import Exploration
from hthor.navigation.grid_map import CELL_M, FREE, GridMap
from hthor.types import Vec2, Vec3

_REACH_M = 1.14
"""[m] Greatest distance to stand from a position about which nothing is known. Our choice."""
_NEAR_M = 1.5
"""[m] Within this distance of the place, or of the chosen spot, people choose again where to stand. Our choice."""
_MAX_VIEWS = 3
"""[count] Sides from which people look at furniture that a message named. Our choice: a door or a shelf may hide it."""
_ASIDE_RAD = math.radians(50.0)
"""[rad] Least angle between a new side and the sides already used. Our choice: 50 degrees."""
_FURTHER_M = 3.0
"""[m] Farthest walk to another side when the first look showed nothing. Our choice."""
_MAX_TRIES = 12
"""[count] Choices of a spot after which the message is given up. Our choice."""
_GLANCE_S = 0.6
"""[s] Duration of a glance that recognises the furniture at the position. Our choice."""
_THICK_M = 0.6 * CELL_M
"""[m] Half the thickness of a wall on the map. Our choice: a little more than half a cell."""
_SHORT_M = 0.02
"""[m] Walls this close to either end of a line of sight are ignored. Our choice."""


class MessageFollowing:
    """Walks to a spot from which the named place can be seen, not only to one that is near it on the map."""

    def __init__(self, exploration: Exploration) -> None:
        self.exploration, self.human, self.eyes = exploration, exploration.human, exploration.eyes
        self.memory, self.walker = exploration.memory, exploration.walker

    def visit(self, remembered: Vec3, forgotten: Callable[[], bool]) -> Behaviour:
        """Go to where the place of a message is ``remembered`` [m] to be, and look there, unless it is ``forgotten``.

        What is looked for may come into view on the way, which ends this behaviour.
        """
        self.eyes.attention = remembered
        yield from self.walker.go(remembered[:2], within=_REACH_M, stop=forgotten)
        if not forgotten():
            yield from self._look(remembered)
        return True

    def follow(self, position: Vec3) -> Behaviour:
        """Go to the ``position`` [m] named by a message and look there; True when done, with or without success.

        The map in the headset shows the distance and direction of the place, but no path to it. The participant walks
        around walls in between; when one side shows nothing, others are tried.
        """
        self.eyes.attention = position
        looked: list[Vec2] = []
        hidden: list[Vec2] = []
        failed: list[Vec2] = []
        for _ in range(_MAX_TRIES):
            place = self.memory.at(position)
            spot = self._viewpoint(position, place, [*looked, *hidden], failed, _FURTHER_M if looked else math.inf)
            if spot is None and failed and not looked:
                failed.clear()  # they may work now that the map shows more
                continue
            if spot is None:
                break
            guessed = self.walker.map.grid.at(*spot) != FREE
            arrived = yield from self.walker.go(
                spot, stop=partial(self._should_rechoose, position, place, spot, guessed)
            )
            if self.memory.at(position) is not place or (arrived and self._is_short_of(spot)):
                continue  # the place came into view, or what is around it: choose again where to stand
            if not arrived:
                failed.append(spot)
                if looked:
                    break
                continue
            if not (yield from self._faces(position)):
                hidden.append(self.human.here)
                continue
            if place is not None and place.state == "closed" and (yield from self.exploration.open(place)):
                failed.append(spot)
                continue
            yield from self._look(position)
            looked.append(self.human.here)
            if place is None or len(looked) == _MAX_VIEWS:
                break  # on bare floor one look is enough
        if not looked:
            yield from self._look(position)
        place = self.memory.at(position)
        if place is not None and looked:
            self.memory.expose(place, self.human.traits.e_done, self.human.now.tick)
        return True

    def _faces(self, position: Vec3) -> Behaviour:
        """Turn to the position; True when it is in view, with neither a wall nor anything else in between."""
        yield from self.human.look_at(position)
        if self.memory.at(position) is None:
            yield from self.human.rest(_GLANCE_S)
        place, here, grid = self.memory.at(position), self.human.here, self.walker.map.grid
        if Walls(grid, position[:2], _NEAR_M).hide(here):
            return False
        if place is None:
            return grid.at(position[0], position[1]) == FREE
        return approach.has_free_line(here, place, self.walker)

    def _look(self, position: Vec3) -> Behaviour:
        yield from self.human.look_at(position)
        yield from self.human.rest(self.human.traits.t_look)
        return True

    def _should_rechoose(self, position: Vec3, place: KnownPlace | None, spot: Vec2, guessed: bool) -> bool:
        """Whether it is time to choose again where to stand."""
        if self.memory.at(position) is not place:
            return True
        return guessed and math.dist(self.human.here, spot) < _NEAR_M and self.walker.map.grid.at(*spot) == FREE

    def _is_short_of(self, spot: Vec2) -> bool:
        return math.dist(self.human.here, spot) > TRIED_M

    def _viewpoint(
        self, position: Vec3, place: KnownPlace | None, seen: list[Vec2], failed: list[Vec2], most: float
    ) -> Vec2 | None:
        """The spot nearest on foot, within ``most`` metres, from which a new side of the place may be seen."""
        point = position[:2]
        opens = place is not None and bool(place.state)
        spots = approach.viewpoints_of_place(place, self.walker, front=True) if place is not None and opens else []
        spots = approach.within_reach(spots, position, _NEAR_M) or approach.rings(position, _REACH_M)
        walls = Walls(self.walker.map.grid, point, _NEAR_M)
        sides = [math.atan2(old[1] - point[1], old[0] - point[0]) for old in seen]
        new = [
            spot
            for spot in spots
            if all(math.dist(spot, old) > TRIED_M for old in failed)
            and all(abs(wrap(math.atan2(spot[1] - point[1], spot[0] - point[0]) - side)) > _ASIDE_RAD for side in sides)
            and self.walker.map.planner.fits(*spot)
            and not walls.hide(spot)
        ]
        new = [spot for spot in new if self.walker.map.grid.at(*spot) == FREE] or new
        ((way, number),) = self.walker.map.planner.nearest(self.human.here, [new])
        return new[number] if math.isfinite(way) and way <= most else None


class Walls:
    """Walls on the map within ``reach`` metres of ``point`` [m]: obstacles that are higher than any furniture.

    People look over a counter and past a lamp, but not through a wall.
    """

    def __init__(self, grid: GridMap, point: Vec2, reach: float) -> None:
        self.point = point
        met = grid.obstacles
        walls = (met[met[:, 2] == 0, :2] + 0.5) * CELL_M - point
        self._offsets = walls[np.abs(walls).max(axis=1) <= reach] if len(walls) else walls

    def hide(self, spot: Vec2) -> bool:
        """Whether a wall is between the point and ``spot`` [m]."""
        dx, dy = spot[0] - self.point[0], spot[1] - self.point[1]
        apart = math.hypot(dx, dy)
        if apart <= _SHORT_M or not len(self._offsets):
            return False
        ux, uy = dx / apart, dy / apart
        along = self._offsets[:, 0] * ux + self._offsets[:, 1] * uy
        off = np.abs(self._offsets[:, 1] * ux - self._offsets[:, 0] * uy)
        return bool(((along > _SHORT_M) & (along < apart) & (off < _THICK_M)).any())
