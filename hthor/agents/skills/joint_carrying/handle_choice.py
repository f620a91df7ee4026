"""Which end of a heavy thing to take, so that whoever helps can get to the other end."""

import itertools
import math
from collections.abc import Callable, Sequence

from hthor.agents.skills.routes_around import RoutesAround
from hthor.agents.skills.viewpoints import Routes
from hthor.geometry import plane
from hthor.navigation.detours import Disc
from hthor.types import BodySpec, Vec2, Vec3

_GAPS_M = (0.12, 0.24, 0.36)
"""Gaps between a body and the handle that it is about to take [m]."""
_OFF_LINE_RAD = tuple(side * math.radians(20.0 * k) for k in range(7) for side in ((1.0, -1.0) if k else (1.0,)))
"""Angles off the thing's axis at which to stand for a handle, the smallest first [rad]."""
_NEAR_M, _DETOUR_M = 3.0, 4.0
"""The last part of a helper's way to their end, and by how much the way past this body may be longer [m]."""
_MARGIN_M = 0.2
"""Room that a helper needs to pass between this body and walls, beyond their own width [m]."""


class HandleChoice:
    """The ends of one thing on the floor, and where a body stands to take them.

    Args:
        way_length: length [m] of the shortest path from one point to another.
        rooms: the middles of all known rooms [m].
    """

    def __init__(
        self,
        body: BodySpec,
        routes: Routes,
        way_length: Callable[[Vec2, Vec2], float],
        rooms: Sequence[Vec2],
    ) -> None:
        self.body, self.routes, self._way_length, self.rooms = body, routes, way_length, rooms
        self._asked: tuple[object, tuple[Vec3, ...]] = (None, ())

    @staticmethod
    def ends(middle: Vec3, yaw: float, half_m: float) -> tuple[Vec3, Vec3]:
        """Positions [m] of the handles of a thing that is ``2 * half_m`` long."""
        return plane.to_house((half_m, 0.0, 0.0), middle, yaw), plane.to_house((-half_m, 0.0, 0.0), middle, yaw)

    def stand(self, handle: Vec3, middle: Vec3, outline: Sequence[Disc]) -> Vec3 | None:
        """Where to stand for a handle [m]: beyond it, as nearly in line with the thing as there is room.

        None if there is no room from which this handle is the nearer one. ``outline``: discs that keep the body off
        the thing.
        """
        routes = RoutesAround(self.routes, outline)
        out, half = math.atan2(handle[1] - middle[1], handle[0] - middle[0]), math.dist(handle[:2], middle[:2])
        for off in _OFF_LINE_RAD:
            for gap in _GAPS_M:
                apart = self.body.radius + gap
                spot = (handle[0] + apart * math.cos(out + off), handle[1] + apart * math.sin(out + off))
                if math.dist(spot, middle[:2]) > half and routes.stands(spot):
                    return (*spot, handle[2])
        return None

    def before_helper(
        self, ends: Sequence[Vec3], middle: Vec3, destination: Vec3, outline: Sequence[Disc]
    ) -> tuple[Vec3, ...]:
        """The ends that may be taken before a helper has come, the best first.

        Wherever the helper comes from, they must get past the body to the other end. The end in front, from where the
        thing can be pulled, goes first.
        """
        key = (tuple(ends), destination)
        if key != self._asked[0]:
            stands = {end: spot[:2] for end in ends if (spot := self.stand(end, middle, outline))}
            order = sorted(stands, key=lambda end: round(self._way_length(stands[end], destination[:2]), 2))
            self._asked = (key, tuple(mine for mine in order if self._leaves_way(mine, stands, outline)))
        return self._asked[1]

    def _leaves_way(self, mine: Vec3, stands: dict[Vec3, Vec2], outline: Sequence[Disc]) -> bool:
        """Whether a helper of the body's size gets past the body at one end to the other."""
        other = next((spot for end, spot in stands.items() if end != mine), None)
        if other is None:
            return False
        body: Disc = (*stands[mine], 2.0 * self.body.radius + _MARGIN_M)
        most = _NEAR_M + _DETOUR_M
        return all(self.routes.past(start, other, [body, *outline], most) for start in self._approaches(other))

    def _approaches(self, spot: Vec2) -> list[Vec2]:
        """Points [m] from which helpers come to a spot: a little before the end of the paths from all rooms."""
        ways = (self.routes.way(room, spot) for room in self.rooms)
        points = {(round(x, 1), round(y, 1)): (x, y) for x, y in (_before_end(way, _NEAR_M) for way in ways if way)}
        return list(points.values())


def _before_end(way: Sequence[Vec2], left_m: float) -> Vec2:
    """The point of a path from which ``left_m`` [m] of it are left; its first point if it is shorter."""
    for a, b in itertools.pairwise(reversed(way)):
        apart = math.dist(a, b)
        if apart >= left_m:
            share = left_m / apart
            return (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]))
        left_m -= apart
    return way[0]
