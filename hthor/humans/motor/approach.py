"""Getting within reach or sight of something, from another side when one side failed."""

import math
from collections.abc import Callable
from functools import partial

from hthor.geometry.plane import wrap
from hthor.humans.core.trial_context import Behaviour, HumanContext
from hthor.humans.memory.spatial_memory import KnownPlace, SpatialMemory
from hthor.humans.motor import viewpoints
from hthor.humans.motor.locomotion import Walker, never
from hthor.humans.perception.perception import Eyes
from hthor.navigation.grid_map import FREE
from hthor.types import Vec2, Vec3

PATIENCE = 6
"""[count] Failed tries after which people do something else. Our choice."""
REACH = 0.96
"""[ratio] Share of the arm's length that people rely on. Our choice."""
TRIED_M = 0.35
"""[m] Spots nearer to each other than this count as the same spot. Our choice."""
_STRAIGHT_EVERY = 3
"""[count] Every so many tries people walk straight up to the thing instead of to a chosen spot. Our choice."""
_GLIMPSE_M = 1.5
"""[m] From so near people see whether there is room to stand at a spot. Our choice."""


class Approach:
    """Walks up to things and remembers which spots were tried. ``tries`` counts them."""

    def __init__(self, human: HumanContext, eyes: Eyes, memory: SpatialMemory, walker: Walker) -> None:
        self.human, self.eyes, self.memory, self.walker = human, eyes, memory, walker
        self.reset()

    def reset(self) -> None:
        """Forget what was tried."""
        self.tries = 0
        self._tried: list[Vec2] = []

    @property
    def arm(self) -> float:
        """How far [m] people stretch out for things."""
        return self.human.body.reach * REACH

    def to_object(self, point: Vec3, support: str, reach: float, stop: Callable[[], bool] = never) -> Behaviour:
        """Walk to within ``reach`` [m] of an object, to a different spot at each new try."""

        def spots() -> list[Vec2]:
            place = self.memory.places.get(support) or self.memory.at(point)
            around = viewpoints.viewpoints_of_object(point, place, self.walker, reach)
            if place is None or not place.state:
                return around
            front = viewpoints.viewpoints_of_place(place, self.walker, front=True)
            return viewpoints.within_reach(front, point, reach) or around

        self.tries += 1
        arrived = yield from self._stand(spots, point, reach, stop)
        yield from self.human.look_at(point)
        return arrived

    def to_place(self, place: KnownPlace) -> Behaviour:
        """Walk to a side of a place, to its front when it can be opened."""

        def spots() -> list[Vec2]:
            return viewpoints.viewpoints_of_place(place, self.walker, front=bool(place.state))

        self.tries += 1
        return (yield from self._stand(spots, place.centre, self.arm + min(place.size[:2]) / 2.0, never))

    def _stand(self, spots: Callable[[], list[Vec2]], point: Vec3, reach: float, stop: Callable[[], bool]) -> Behaviour:
        """Walk to the best of the spots; choose again once near enough to see whether one can stand there."""
        for _ in range(PATIENCE):
            spot = None if self.tries % _STRAIGHT_EVERY == 0 else self._nearest(spots(), point)
            if spot is None:
                return (yield from self.walker.go((point[0], point[1]), within=reach, stop=stop))
            guessed = self.walker.grid.at(*spot) != FREE and math.dist(self.human.here, spot) > _GLIMPSE_M
            arrived = yield from self.walker.go(spot, stop=partial(self._halt, stop, spot if guessed else None))
            if not arrived or not guessed or stop() or math.dist(self.human.here, spot) < TRIED_M:
                break
            self._tried.pop()
        return arrived

    def _halt(self, stop: Callable[[], bool], guess: Vec2 | None) -> bool:
        return stop() or (guess is not None and math.dist(self.human.here, guess) < _GLIMPSE_M)

    def _nearest(self, spots: list[Vec2], point: Vec3) -> Vec2 | None:
        """The nearest spot on foot; after failures one from which the object was seen, if possible."""
        new = [spot for spot in spots if all(math.dist(spot, old) > TRIED_M for old in self._tried)]
        if not new:
            new, self._tried = spots, []
        seen_from = self.eyes.current.spot if self._tried else None
        if seen_from is None:
            ((far, number),) = self.walker.planner.nearest(self.human.here, [new])
        else:
            ways = self.walker.planner.distances(self.human.here, new)
            far, number = min((way + _off_line(new[k], point, seen_from), k) for k, way in enumerate(ways))
        if not math.isfinite(far):
            return None
        self._tried.append(new[number])
        return self._tried[-1]


def _off_line(spot: Vec2, point: Vec3, seen_from: Vec2) -> float:
    """Angle [rad] between the directions from the object to a spot and to where it was seen from."""
    a = math.atan2(spot[1] - point[1], spot[0] - point[0])
    return abs(wrap(a - math.atan2(seen_from[1] - point[1], seen_from[0] - point[0])))
