"""Going where a robot says that something is, and looking for it there from several sides.

The map in the headset shows the place itself, and goes on showing it, so nobody misses it by the 20 to 40 degrees by
which people point wrong from memory; what reading the map costs is in the pace (``k_map``) and in ways that turn out
to end at a wall.
"""

from __future__ import annotations

import math
from functools import partial

from hthor.geometry.plane import wrap
from hthor.humans.core.trial_context import Deed, Subject
from hthor.humans.memory.spatial_memory import Memory, Place
from hthor.humans.motor import viewpoints
from hthor.humans.motor.locomotion import Walker
from hthor.humans.perception.perception import Eyes
from hthor.humans.perception.wall_occlusion import Walls
from hthor.humans.search.exploration import Exploring
from hthor.navigation.grid_map import FREE
from hthor.types import Vec2, Vec3

_REACH_M = 1.14
_NEAR_M = 1.5
_TRIED_M = 0.35
_VIEWS = 3
"""A claim is worth another look, from where a door, a back or a shelf hides less."""
_ASIDE_RAD = math.radians(50.0)
_FURTHER_M = 3.0
"""So far people go for another look, when the first showed nothing."""
_TRIES = 12
_GLANCE_S = 0.6


class Following:
    """Follows what robots say: walks to where the place can be looked at, not only to where it is near on the map."""

    def __init__(self, me: Subject, eyes: Eyes, memory: Memory, walker: Walker, exploring: Exploring) -> None:
        self.me, self.eyes, self.memory, self.walker, self.exploring = me, eyes, memory, walker, exploring

    def follow(self, position: Vec3) -> Deed:
        """Go where something is said to be [m], and look there; True when all was done, whatever was found.

        The map in a headset shows how far off and in which direction the place is, not how to get there. Who finds a
        wall in between goes round it; who sees nothing from one side looks from others too.
        """
        self.eyes.attention = position
        looked: list[Vec2] = []
        hidden: list[Vec2] = []
        failed: list[Vec2] = []
        for _ in range(_TRIES):
            place = self.memory.at(position)
            spot = self._vantage(position, place, [*looked, *hidden], failed, _FURTHER_M if looked else math.inf)
            if spot is None and failed and not looked:
                failed.clear()  # by now the map tells more
                continue
            if spot is None:
                break
            guessed = self.walker.grid.at(*spot) != FREE
            arrived = yield from self.walker.go(spot, stop=partial(self._doubtful, position, place, spot, guessed))
            if self.memory.at(position) is not place or (arrived and self._is_short_of(spot)):
                continue  # the place came into view, or what is around it: choose again where to stand
            if not arrived:
                failed.append(spot)
                if looked:
                    break
                continue
            if not (yield from self._faces(position)):
                hidden.append(self.me.here)
                continue
            if place is not None and place.state == "closed" and (yield from self.exploring.open(place)):
                failed.append(spot)
                continue
            yield from self._look(position)
            looked.append(self.me.here)
            if place is None or len(looked) == _VIEWS:
                break  # on bare floor one look tells
        if not looked:
            yield from self._look(position)
        place = self.memory.at(position)
        if place is not None and looked:
            self.memory.expose(place, self.me.traits.e_done, self.me.now.tick)
        return True

    def _faces(self, position: Vec3) -> Deed:
        """Turn to where it should be; whether that is in view, or there is a wall, or something else, in between."""
        yield from self.me.look_at(position)
        if self.memory.at(position) is None:
            yield from self.me.rest(_GLANCE_S)
        place, here, grid = self.memory.at(position), self.me.here, self.walker.grid
        if Walls(grid, position[:2], _NEAR_M).hide(here):
            return False
        if place is None:
            return grid.at(position[0], position[1]) == FREE
        return viewpoints.faces(here, place, self.walker)

    def _look(self, position: Vec3) -> Deed:
        yield from self.me.look_at(position)
        yield from self.me.rest(self.me.traits.t_look)
        return True

    def _doubtful(self, position: Vec3, place: Place | None, spot: Vec2, guessed: bool) -> bool:
        """Whether it is time to choose anew where to stand."""
        if self.memory.at(position) is not place:
            return True
        return guessed and math.dist(self.me.here, spot) < _NEAR_M and self.walker.grid.at(*spot) == FREE

    def _is_short_of(self, spot: Vec2) -> bool:
        return math.dist(self.me.here, spot) > _TRIED_M

    def _vantage(
        self, position: Vec3, place: Place | None, seen: list[Vec2], failed: list[Vec2], most: float
    ) -> Vec2 | None:
        """The nearest spot on foot from which the place may be looked at, on a side from which it was not yet.

        None when there is none, or none within ``most`` metres.
        """
        point = position[:2]
        spots = viewpoints.at(place, self.walker, front=True) if place is not None and place.state else []
        spots = viewpoints.in_reach(spots, position, _NEAR_M) or viewpoints.around(position, _REACH_M)
        walls = Walls(self.walker.grid, point, _NEAR_M)
        sides = [math.atan2(old[1] - point[1], old[0] - point[0]) for old in seen]
        new = [
            spot
            for spot in spots
            if all(math.dist(spot, old) > _TRIED_M for old in failed)
            and all(abs(wrap(math.atan2(spot[1] - point[1], spot[0] - point[0]) - side)) > _ASIDE_RAD for side in sides)
            and self.walker.planner.fits(*spot)
            and not walls.hide(spot)
        ]
        new = [spot for spot in new if self.walker.grid.at(*spot) == FREE] or new
        ((way, number),) = self.walker.planner.nearest(self.me.here, [new])
        return new[number] if math.isfinite(way) and way <= most else None
