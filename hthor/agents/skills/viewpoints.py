"""Where a body can stand to have something in reach, and the shortest path there."""

import functools
import itertools
import math
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hthor.geometry import plane
from hthor.houses.space.grid_kernel import cells_within
from hthor.navigation.detours import Disc
from hthor.types import Thing, Vec2, Vec3

Floats = NDArray[np.float64]

_MISS_M, _GRID_M = 0.3, 0.12
_SLACK_M = 1e-6
"""Lengths that differ by less count as equal, because of rounding [m]."""


class Routes(Protocol):
    """Paths of one body through a house, as far as it knows it; positions and lengths in metres.

    `stands` and `standing` say where the body may stand, `fits` whether it can go straight, `lengths` and `way` give
    shortest paths (inf and () for none), `past` a short path that keeps out of discs, `retreat` one to where it blocks
    nobody and `refuge` one that also keeps out of discs, `loose` where to go first when it is stopped, `open_to`
    whether no wall is between a spot and an edge, and `sees` whether the camera would see a point.
    """

    def stands(self, spot: Vec2) -> bool: ...
    def standing(self, spots: Sequence[Vec2]) -> list[Vec2]: ...
    def fits(self, a: Vec2, b: Vec2) -> bool: ...
    def lengths(self, here: Vec2, spots: Sequence[Vec2]) -> Sequence[float]: ...
    def way(self, here: Vec2, spot: Vec2) -> tuple[Vec2, ...]: ...
    def past(self, here: Vec2, goal: Vec2, discs: Sequence[Disc], most_m: float) -> tuple[Vec2, ...]: ...
    def refuge(self, here: Vec2, point: Vec2, apart_m: float, discs: Sequence[Disc]) -> tuple[Vec2, ...]: ...
    def retreat(self, here: Vec2, point: Vec2, apart_m: float) -> tuple[Vec2, ...]: ...
    def loose(self, here: Vec2) -> Vec2: ...
    def open_to(self, spot: Vec2, edge: Vec2) -> bool: ...
    def sees(self, spot: Vec2, point: Vec3) -> bool: ...


def path_to_reach(
    routes: Routes,
    here: Vec2,
    points: Sequence[Vec3],
    reach: float,
    holder: Thing | None = None,
    front: bool = False,
    but: Sequence[Vec2] = (),
    grid_m: float = _GRID_M,
) -> tuple[Vec2, ...]:
    """The shortest path to a spot from which one of the points is at most ``reach`` [m] away; () when there is none.

    Args:
        holder: the furniture that the points belong to: no wall may be between it and the spot.
        front: the spot must lie in front of the holder, where its door is.
        but: spots that failed; nothing within 0.3 m of them is proposed.
        grid_m: distance between the spots that are considered [m].
    """
    spots = [
        spot
        for spot in routes.standing(_lattice(tuple(points), reach, grid_m))
        if not (front and holder is not None and not _in_front(holder, spot, reach))
        and all(math.dist(spot, miss) > _MISS_M for miss in but)
    ]
    return _first(routes, here, spots, points, holder)


def closest_thing(
    routes: Routes, here: Vec2, things: Sequence[Thing], over: Callable[[Thing], Sequence[Vec3]], reach: float
) -> Thing:
    """The thing with the shortest `route` to points ``over`` it; of equals, or when there is no way, by id.

    Things farther away in a straight line than the best path is long are skipped.
    """
    looked = []
    for thing in things:
        points = over(thing)
        spots = routes.standing(_lattice(tuple(points), reach, _GRID_M))
        least = min((math.dist(here, spot) for spot in spots), default=math.inf)
        looked.append((least, thing.id, thing, points, spots))
    crow = routes.stands(here)  # if not, the path begins elsewhere
    best, answer = (math.inf, ""), things[0]
    for least, id, thing, points, spots in sorted(looked, key=lambda one: one[:2]):
        if crow and least > best[0] + _SLACK_M:
            break
        way = _first(routes, here, spots, points, thing)
        far = (path_length(way) if way else math.inf, id)
        if best[1] == "" or far < best:
            best, answer = far, thing
    return answer


def path_length(way: Sequence[Vec2]) -> float:
    """Length [m] of a path."""
    return math.fsum(math.dist(a, b) for a, b in itertools.pairwise(way))


def _first(
    routes: Routes, here: Vec2, spots: Sequence[Vec2], points: Sequence[Vec3], holder: Thing | None
) -> tuple[Vec2, ...]:
    """The path to the nearest spot from which the nearest point is accessible; () when there is none."""
    lengths = routes.lengths(here, spots) if spots else ()
    plan = np.array([point[:2] for point in points])
    order = sorted((round(length, 6), number) for number, length in enumerate(lengths) if math.isfinite(length))
    for _, number in order:
        spot = spots[number]
        point = nearest_point(_few(points, plan, spot), spot)
        if routes.open_to(spot, point[:2] if holder is None else nearest_outline_point(holder, spot)) and routes.sees(
            spot, point
        ):
            way = routes.way(here, spot)
            if way:
                return way
    return ()


def nearest_point(points: Sequence[Vec3], spot: Vec2) -> Vec3:
    """The point nearest to a spot on the plan, the first of equals."""
    return min(points, key=lambda point: round(math.dist(point[:2], spot), 6))


def _few(points: Sequence[Vec3], plan: Floats, spot: Vec2) -> Sequence[Vec3]:
    """The points that may be nearest to a spot; ``plan`` (N, 2) has their x and y. Comparing all exactly is slow."""
    apart = np.hypot(plan[:, 0] - spot[0], plan[:, 1] - spot[1])
    return list(itertools.compress(points, (apart <= apart.min() + 10.0 * _SLACK_M).tolist()))


def nearest_outline_point(thing: Thing, spot: Vec2) -> Vec2:
    """The point of a thing's outline, or inside it, that is nearest to a spot."""
    u, v, _ = plane.to_local((*spot, 0.0), thing.centre, thing.yaw)
    w, d = thing.size[0] / 2, thing.size[1] / 2
    x, y, _ = plane.to_house((max(-w, min(w, u)), max(-d, min(d, v)), 0.0), thing.centre, thing.yaw)
    return (x, y)


def outline_distance(thing: Thing, spot: Vec2) -> float:
    """Distance [m] from a spot to a thing's outline."""
    return plane.distance_to_rectangle(spot, thing.centre[:2], thing.size[:2], thing.yaw)


def keeps_clear(a: Vec2, b: Vec2, point: Vec2, radius: float) -> bool:
    """Whether a straight path keeps ``radius`` [m] from a point, or leads away from it."""
    ex, ey = b[0] - a[0], b[1] - a[1]
    along = ((point[0] - a[0]) * ex + (point[1] - a[1]) * ey) / max(ex * ex + ey * ey, 1e-12)
    share = max(0.0, min(1.0, along))
    return along <= 0.0 or math.dist((a[0] + share * ex, a[1] + share * ey), point) >= radius


@functools.lru_cache(maxsize=256)
def _lattice(points: tuple[Vec3, ...], reach: float, grid_m: float) -> tuple[Vec2, ...]:
    """Spots of a square lattice within reach of any of the points [m] on the plan, row by row."""
    plan = np.array(points)[:, :2].copy()
    low, high = np.ceil((plan.min(0) - reach) / grid_m), np.floor((plan.max(0) + reach) / grid_m)
    xs, ys = (np.arange(low[axis], high[axis] + 1) * grid_m for axis in (0, 1))
    rows, columns = np.nonzero(cells_within(xs, ys, plan, reach))
    return tuple(zip(xs[columns].tolist(), ys[rows].tolist(), strict=True))


def _in_front(thing: Thing, spot: Vec2, reach: float) -> bool:
    """Whether a thing's door is straight ahead of a spot: from the side, its open leaf would block the way."""
    u, v, _ = plane.to_local((*spot, 0.0), (*thing.centre[:2], 0.0), thing.yaw)
    return v > thing.size[1] / 2 and abs(u) < min(thing.size[0] / 2, 0.4 * reach)
