"""Walking distances to a place in a known house, for the state and the reward of a robot that learns."""

import itertools
import math

from msgspec import Struct

from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.geodesic import house_geodesics
from hthor.types import BodySpec, HouseSpec, Vec2


class Way(Struct, frozen=True, kw_only=True):
    """The shortest way to a place: its length [m], infinite if there is none, and its first bend [m], house frame."""

    metres: float
    first: Vec2


class WalkingDistance:
    """Shortest ways of one body through a house, with all doors open."""

    def __init__(self, house: HouseSpec, body: BodySpec) -> None:
        self._space = FreeSpace.of(house, body.radius, body.height)
        self._geodesics = house_geodesics(house, body.radius, body.height)

    def metres(self, here: Vec2, goal: Vec2) -> float:
        """Length [m] of the way from ``here`` to the free floor nearest to ``goal``; infinite if there is none."""
        return self._geodesics.distance(self._spot(goal), self._space.nearest_free(*here))

    def way(self, here: Vec2, goal: Vec2) -> Way:
        """The way from ``here`` to the free floor nearest to ``goal``."""
        path = self._geodesics.path(self._spot(goal), self._space.nearest_free(*here))
        if not path:
            return Way(metres=math.inf, first=here)
        length = sum(math.dist(a, b) for a, b in itertools.pairwise(path))
        return Way(metres=length, first=path[-2] if len(path) > 1 else path[0])

    def _spot(self, goal: Vec2) -> Vec2:
        return self._space.nearest_free(round(goal[0], 1), round(goal[1], 1))
