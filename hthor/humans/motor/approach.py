"""Getting within reach or sight of something, from another side when one side did not do."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

from hthor.geometry.plane import wrap
from hthor.humans.core.trial_context import Deed, Subject
from hthor.humans.memory.spatial_memory import Memory, Place
from hthor.humans.motor import viewpoints
from hthor.humans.motor.locomotion import Walker, never
from hthor.humans.perception.perception import Eyes
from hthor.navigation.grid_map import FREE
from hthor.types import Vec2, Vec3

PATIENCE = 6
"""Tries before something else is thought of."""
REACH = 0.96
"""Share of the arm's length that people count on."""
_TRIED_M = 0.35
_LAST = 3
_GLIMPSE_M = 1.5


class Approach:
    """Walks up to things and remembers which spots were tried. ``tries`` counts them."""

    def __init__(self, me: Subject, eyes: Eyes, memory: Memory, walker: Walker) -> None:
        self.me, self.eyes, self.memory, self.walker = me, eyes, memory, walker
        self.anew()

    def anew(self) -> None:
        """Forget what was tried."""
        self.tries = 0
        self._tried: list[Vec2] = []

    def to_object(self, point: Vec3, support: str, reach: float, stop: Callable[[], bool] = never) -> Deed:
        """Walk to within ``reach`` [m] of an object, a little elsewhere at each new try."""

        def spots() -> list[Vec2]:
            place = self.memory.places.get(support) or self.memory.at(point)
            around = viewpoints.near(point, place, self.walker, reach)
            if place is None or not place.state:
                return around
            return viewpoints.in_reach(viewpoints.at(place, self.walker, front=True), point, reach) or around

        self.tries += 1
        arrived = yield from self._stand(spots, point, reach, stop)
        yield from self.me.look_at(point)
        return arrived

    def to_place(self, place: Place) -> Deed:
        """Walk to a side of a place, to its front when it opens."""

        def spots() -> list[Vec2]:
            return viewpoints.at(place, self.walker, front=bool(place.state))

        self.tries += 1
        reach = self.me.body.reach * REACH + min(place.size[:2]) / 2.0
        return (yield from self._stand(spots, place.centre, reach, never))

    def _stand(self, spots: Callable[[], list[Vec2]], point: Vec3, reach: float, stop: Callable[[], bool]) -> Deed:
        """Walk to the best of the spots; choose again once near enough to see whether one can stand there."""
        for _ in range(PATIENCE):
            spot = None if self.tries % _LAST == 0 else self._nearest(spots(), point)
            if spot is None:
                return (yield from self.walker.go((point[0], point[1]), within=reach, stop=stop))
            guessed = self.walker.grid.at(*spot) != FREE and math.dist(self.me.here, spot) > _GLIMPSE_M
            arrived = yield from self.walker.go(spot, stop=partial(self._halt, stop, spot if guessed else None))
            if not arrived or not guessed or stop() or math.dist(self.me.here, spot) < _TRIED_M:
                break
            self._tried.pop()
        return arrived

    def _halt(self, stop: Callable[[], bool], guess: Vec2 | None) -> bool:
        return stop() or (guess is not None and math.dist(self.me.here, guess) < _GLIMPSE_M)

    def _nearest(self, spots: list[Vec2], point: Vec3) -> Vec2 | None:
        """The nearest spot on foot; after failures another one, from where the object was seen if possible."""
        new = [spot for spot in spots if all(math.dist(spot, old) > _TRIED_M for old in self._tried)]
        if not new:
            new, self._tried = spots, []
        seen_from = self.eyes.subject.spot if self._tried else None
        if seen_from is None:
            ((far, number),) = self.walker.planner.nearest(self.me.here, [new])
        else:
            ways = self.walker.planner.distances(self.me.here, new)
            far, number = min((way + _aslant(new[k], point, seen_from), k) for k, way in enumerate(ways))
        if not math.isfinite(far):
            return None
        self._tried.append(new[number])
        return self._tried[-1]


def _aslant(spot: Vec2, point: Vec3, seen_from: Vec2) -> float:
    """How far [rad] a spot lies off the line along which an object was seen."""
    a = math.atan2(spot[1] - point[1], spot[0] - point[0])
    return abs(wrap(a - math.atan2(seen_from[1] - point[1], seen_from[0] - point[0])))
