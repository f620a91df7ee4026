"""Choosing where to stand to see or reach something, and walking there; after a failure, to another side."""

import functools
import math
from collections.abc import Callable, Sequence
from functools import partial

from hthor.geometry.plane import to_house, wrap
from hthor.humans.core.trial_context import Behaviour, HumanContext
from hthor.humans.memory.spatial_memory import KnownPlace, SpatialMemory
from hthor.humans.motor.locomotion import Walker, never
from hthor.humans.perception.perception import Eyes
from hthor.navigation.grid_map import FREE
from hthor.navigation.waiting_spots import MAYBE, YES, usable
from hthor.types import Vec2, Vec3

GAP_M = 0.42
"""[m] Distance from the edge of furniture to the middle of the body of a person who stands at it. Our choice."""
_SPACING_M = 0.6
"""[m] Distance between the spots that are considered along a side of furniture. Our choice."""
_FRONT_SPACING = 0.6
"""[ratio] Spots in front of furniture that opens are closer together by this factor. Our choice."""
_RING_M = (0.6, 0.75, 0.9, 1.0, 1.14)
"""[m] Radii of the rings of spots around an object. Our choice."""
_DIRECTIONS = 20
"""[count] Spots on each ring. Our choice."""
_UNKNOWN_SIZE_M = 0.5
"""[m] Side length of the furniture that is assumed under an object of unknown support. Our choice."""
PATIENCE = 6
"""[count] Failed tries after which people do something else. Our choice."""
REACH = 0.96
"""[ratio] Share of the arm's length that people rely on. Our choice."""
TRIED_M = 0.35
"""[m] Spots nearer to each other than this count as the same spot. Our choice."""
_STRAIGHT_EVERY = 3
"""[count] One try in this many goes straight to the object instead of to a chosen spot. Our choice."""
_GLIMPSE_M = 1.5
"""[m] Distance from which people see whether there is room to stand at a spot. Our choice."""


def viewpoints_of_place(place: KnownPlace, walker: Walker, front: bool = False) -> list[Vec2]:
    """Spots [m] along the edges of a place, ``front`` only or all round, to stand at and see it."""
    return _usable(_beside(place.centre, place.size, place.yaw, front), place, walker)


def viewpoints_of_object(point: Vec3, support: KnownPlace | None, walker: Walker, reach: float) -> list[Vec2]:
    """Spots [m] within ``reach`` metres of an object; ``support`` is the furniture that it lies on, if known."""
    return _usable(rings(point, reach), support or _assumed_place(point), walker)


def rings(point: Vec3, reach: float) -> list[Vec2]:
    """Spots [m] in rings around an object, within ``reach`` metres, free or not."""
    x, y = point[0], point[1]
    return [
        (x + r * math.cos(a), y + r * math.sin(a))
        for r in _RING_M
        if r <= reach
        for a in (2.0 * math.pi * k / _DIRECTIONS for k in range(_DIRECTIONS))
    ]


def within_reach(spots: list[Vec2], point: Vec3, reach: float) -> list[Vec2]:
    """The spots from which an object is at most ``reach`` metres away."""
    return [spot for spot in spots if math.dist(spot, point[:2]) <= reach]


@functools.lru_cache(maxsize=4096)
def _beside(centre: Vec3, size: Vec3, yaw: float, front: bool) -> tuple[Vec2, ...]:
    half = (size[0] / 2.0, size[1] / 2.0)
    deep = half[1] + GAP_M
    local = [(s, deep) for s in _spread(half[0], front)]
    if not front:
        local += [(s, -deep) for s in _spread(half[0], front)]
        local += [(side * (half[0] + GAP_M), s) for side in (-1.0, 1.0) for s in _spread(half[1], front)]
    return tuple(to_house((x, y, 0.0), centre, yaw)[:2] for x, y in local)


def _spread(half: float, wide: bool) -> list[float]:
    """Positions along a side, including its middle; ``wide`` adds some past its ends."""
    count = max(0, math.floor(half / _SPACING_M)) + (1 if wide else 0)
    return [k * _SPACING_M * (_FRONT_SPACING if wide else 1.0) for k in range(-count, count + 1)]


def _usable(spots: Sequence[Vec2], place: KnownPlace, walker: Walker) -> list[Vec2]:
    """Spots known to be free; when there are none, spots that might be free."""
    ranks = usable(walker.map.grid, walker.map.planner, spots, [_edge(spot, place) for spot in spots], walker.margin)
    best = YES if YES in ranks else MAYBE
    return [spot for spot, rank in zip(spots, ranks, strict=True) if rank == best]


def has_free_line(spot: Vec2, place: KnownPlace, walker: Walker) -> bool:
    """Whether the map shows no wall or other obstacle between a spot and the nearest edge of the place."""
    return not walker.map.grid.meets(spot, _edge(spot, place), walker.margin)


def _edge(spot: Vec2, place: KnownPlace) -> Vec2:
    """The point of a place's outline, or inside it, that is nearest to a spot."""
    cx, cy, _ = place.centre
    cos, sin = math.cos(place.yaw), math.sin(place.yaw)
    dx, dy, w, d = spot[0] - cx, spot[1] - cy, place.size[0] / 2.0, place.size[1] / 2.0
    x, y = max(-w, min(w, dx * cos + dy * sin)), max(-d, min(d, dy * cos - dx * sin))
    return cx + x * cos - y * sin, cy + x * sin + y * cos


def _assumed_place(point: Vec3) -> KnownPlace:
    size = (_UNKNOWN_SIZE_M, _UNKNOWN_SIZE_M, 0.0)
    return KnownPlace(id="", kind="", centre=point, size=size, yaw=0.0)


class Approach:
    """Walks up to things and remembers which spots were tried; ``tries`` counts the tries."""

    def __init__(self, human: HumanContext, eyes: Eyes, memory: SpatialMemory, walker: Walker) -> None:
        self.human, self.eyes, self.memory, self.walker = human, eyes, memory, walker
        self.reset()

    def reset(self) -> None:
        """Forget the tried spots."""
        self.tries = 0
        self._tried: list[Vec2] = []

    @property
    def arm(self) -> float:
        """How far [m] people reach for things."""
        return self.human.body.reach * REACH

    def to_object(self, point: Vec3, support: str, reach: float, stop: Callable[[], bool] = never) -> Behaviour:
        """Walk to within ``reach`` [m] of an object, to a different spot at each new try."""

        def spots() -> list[Vec2]:
            place = self.memory.places.get(support) or self.memory.at(point)
            around = viewpoints_of_object(point, place, self.walker, reach)
            if place is None or not place.state:
                return around
            front = viewpoints_of_place(place, self.walker, front=True)
            return within_reach(front, point, reach) or around

        self.tries += 1
        arrived = yield from self._stand(spots, point, reach, stop)
        yield from self.human.look_at(point)
        return arrived

    def to_place(self, place: KnownPlace) -> Behaviour:
        """Walk to a side of a place, to its front when it can be opened."""

        def spots() -> list[Vec2]:
            return viewpoints_of_place(place, self.walker, front=bool(place.state))

        self.tries += 1
        return (yield from self._stand(spots, place.centre, self.arm + min(place.size[:2]) / 2.0, never))

    def _stand(self, spots: Callable[[], list[Vec2]], point: Vec3, reach: float, stop: Callable[[], bool]) -> Behaviour:
        """Walk to the best of the spots; choose again when near enough to see whether there is room to stand."""
        for _ in range(PATIENCE):
            spot = None if self.tries % _STRAIGHT_EVERY == 0 else self._nearest(spots(), point)
            if spot is None:
                return (yield from self.walker.go((point[0], point[1]), within=reach, stop=stop))
            guessed = self.walker.map.grid.at(*spot) != FREE and math.dist(self.human.here, spot) > _GLIMPSE_M
            arrived = yield from self.walker.go(spot, stop=partial(self._halt, stop, spot if guessed else None))
            if not arrived or not guessed or stop() or math.dist(self.human.here, spot) < TRIED_M:
                break
            self._tried.pop()
        return arrived

    def _halt(self, stop: Callable[[], bool], guess: Vec2 | None) -> bool:
        return stop() or (guess is not None and math.dist(self.human.here, guess) < _GLIMPSE_M)

    def _nearest(self, spots: list[Vec2], point: Vec3) -> Vec2 | None:
        """The spot nearest on foot; after failures, spots on the side from which the object was seen are preferred."""
        new = [spot for spot in spots if all(math.dist(spot, old) > TRIED_M for old in self._tried)]
        if not new:
            new, self._tried = spots, []
        seen_from = self.eyes.current.spot if self._tried else None
        if seen_from is None:
            ((far, number),) = self.walker.map.planner.nearest(self.human.here, [new])
        else:
            ways = self.walker.map.planner.distances(self.human.here, new)
            far, number = min((way + _off_line(new[k], point, seen_from), k) for k, way in enumerate(ways))
        if not math.isfinite(far):
            return None
        self._tried.append(new[number])
        return self._tried[-1]


def _off_line(spot: Vec2, point: Vec3, seen_from: Vec2) -> float:
    """Angle [rad] at the object between a spot and the point ``seen_from``."""
    a = math.atan2(spot[1] - point[1], spot[0] - point[0])
    return abs(wrap(a - math.atan2(seen_from[1] - point[1], seen_from[0] - point[0])))
