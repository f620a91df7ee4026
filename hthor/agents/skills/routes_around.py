"""Routes that also keep out of what a map does not have, such as a heavy object on the floor or bodies that stay."""

import itertools
import math
from collections.abc import Sequence

from hthor.agents.skills.viewpoints import Routes, keeps_clear, path_length
from hthor.geometry import plane
from hthor.navigation.detours import Disc
from hthor.types import Vec2, Vec3

_DETOUR_M = 6.0
"""A path that keeps out of discs may be this much longer [m]."""
_GAP_M = 0.03
"""Gap [m] that a body keeps to a thing on the floor."""
_ON_EDGE_M = 1e-6
_RING_M, _RINGS, _DIRECTIONS = 0.1, 8, 16
"""Radii [m] of the circles round a body in a disc on which a way out is looked for, and the spots on each."""


def discs_around(middle: Vec3, size: Vec2, yaw: float | None, radius: float) -> tuple[Disc, ...]:
    """Discs that keep a body of ``radius`` [m] off a thing that lies on the floor.

    Args:
        middle, size, yaw: of the thing [m, rad]; one large disc if its heading is not known.
    """
    long, deep = size[0] / 2, size[1] / 2
    if yaw is None:
        return ((*middle[:2], math.hypot(long, deep) + radius + _GAP_M),)
    reach = math.hypot(deep, deep) + radius + _GAP_M
    ends = (plane.to_house((side * (long - deep), 0.0, 0.0), middle, yaw) for side in (1, -1))
    return tuple((x, y, reach) for x, y, _ in ends)


class RoutesAround:
    """The routes of a body, less the spots and paths that lead into discs.

    Args:
        discs: radii are those of what stands there and of the body together [m].
    """

    def __init__(self, routes: Routes, discs: Sequence[Disc]) -> None:
        self.routes, self.discs = routes, tuple(discs)

    def stands(self, spot: Vec2) -> bool:
        return self._is_clear(spot) and self.routes.stands(spot)

    def standing(self, spots: Sequence[Vec2]) -> list[Vec2]:
        return [spot for spot in self.routes.standing(spots) if self._is_clear(spot)]

    def fits(self, a: Vec2, b: Vec2) -> bool:
        return self._keeps_clear(a, b) and self.routes.fits(a, b)

    def lengths(self, here: Vec2, spots: Sequence[Vec2]) -> Sequence[float]:
        """Lengths of the paths that do not heed the discs: they put spots in order."""
        return self.routes.lengths(here, spots)

    def way(self, here: Vec2, spot: Vec2) -> tuple[Vec2, ...]:
        """A path to the spot that keeps out of the discs, after a step out of those that the body is in.

        It leaves the shortest path only where that one leads into discs.
        """
        start = self._out(here)
        way = self.routes.way(start, spot)
        points = (start, *way)
        blocked = [k for k, (a, b) in enumerate(itertools.pairwise(points)) if not self._keeps_clear(a, b)]
        if blocked:
            first, beyond = blocked[0], range(blocked[-1] + 1, len(points))
            last = next((k for k in beyond if self._is_clear(points[k])), len(points) - 1)
            most = path_length(points[first : last + 1]) + _DETOUR_M
            round_it = self.past(points[first], points[last], (), most)
            way = (*way[:first], *round_it, *way[last:]) if round_it else ()
        return (start, *way) if way and start != here else way

    def past(self, here: Vec2, goal: Vec2, discs: Sequence[Disc], most_m: float) -> tuple[Vec2, ...]:
        return self.routes.past(here, goal, (*self.discs, *discs), most_m)

    def refuge(self, here: Vec2, point: Vec2, apart_m: float, discs: Sequence[Disc]) -> tuple[Vec2, ...]:
        return self.routes.refuge(here, point, apart_m, (*self.discs, *discs))

    def retreat(self, here: Vec2, point: Vec2, apart_m: float) -> tuple[Vec2, ...]:
        return self.routes.refuge(here, point, apart_m, self.discs)

    def loose(self, here: Vec2) -> Vec2:
        """The nearest spot out of the discs, for a body in them; otherwise where it has most room."""
        if not self._is_clear(here):
            return self._out(here)
        spot = self.routes.loose(here)
        return spot if self._is_clear(spot) else here

    def open_to(self, spot: Vec2, edge: Vec2) -> bool:
        return self.routes.open_to(spot, edge)

    def sees(self, spot: Vec2, point: Vec3) -> bool:
        return self.routes.sees(spot, point)

    def _keeps_clear(self, a: Vec2, b: Vec2) -> bool:
        return all(keeps_clear(a, b, (x, y), radius - _ON_EDGE_M) for x, y, radius in self.discs)

    def _is_clear(self, spot: Vec2) -> bool:
        return all(math.dist(spot, (x, y)) >= radius - _ON_EDGE_M for x, y, radius in self.discs)

    def _out(self, here: Vec2) -> Vec2:
        """The nearest spot outside of the discs to which the body can go straight; ``here`` if there is none."""
        if self._is_clear(here):
            return here
        for ring in range(1, _RINGS + 1):
            for k in range(_DIRECTIONS):
                angle = 2.0 * math.pi * k / _DIRECTIONS
                spot = (here[0] + ring * _RING_M * math.cos(angle), here[1] + ring * _RING_M * math.sin(angle))
                if self.stands(spot) and self.routes.fits(here, spot):
                    return spot
        return here
