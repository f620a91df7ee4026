"""Plane geometry on Python floats: angles, polygons, turned rectangles."""

import itertools
import math
from collections.abc import Iterator, Sequence

from hthor.types import Vec2, Vec3


def wrap(angle: float) -> float:
    """The same angle in (-pi, pi]."""
    wrapped = math.remainder(angle, 2.0 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped


def turn(vector: Vec2, yaw: float) -> Vec2:
    """The vector turned counter-clockwise by ``yaw`` [rad]."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    return (cos * vector[0] - sin * vector[1], sin * vector[0] + cos * vector[1])


def to_house(local: Vec3, centre: Vec3, yaw: float) -> Vec3:
    """The house-frame coordinates of a point that is given in a thing's local frame."""
    x, y = turn((local[0], local[1]), yaw)
    return (centre[0] + x, centre[1] + y, centre[2] + local[2])


def to_local(point: Vec3, centre: Vec3, yaw: float) -> Vec3:
    """The local-frame coordinates of a point that is given in the house frame."""
    x, y = turn((point[0] - centre[0], point[1] - centre[1]), -yaw)
    return (x, y, point[2] - centre[2])


def signed_area(polygon: Sequence[Vec2]) -> float:
    """Area [m2], positive when the corners run counter-clockwise."""
    pairs = zip(polygon, (*polygon[1:], polygon[0]), strict=True)
    return 0.5 * sum(ax * by - bx * ay for (ax, ay), (bx, by) in pairs)


def inside(point: Vec2, polygon: Sequence[Vec2]) -> bool:
    """Whether the point lies in the polygon (even-odd rule; a point on the edge may count either way)."""
    x, y = point
    crossing = False
    for (ax, ay), (bx, by) in zip(polygon, (*polygon[1:], polygon[0]), strict=True):
        if (ay > y) != (by > y) and x < (bx - ax) * (y - ay) / (by - ay) + ax:
            crossing = not crossing
    return crossing


def distance_to_edge(point: Vec2, polygon: Sequence[Vec2]) -> float:
    """Distance [m] from a point to the nearest edge of a polygon, inside or outside."""
    x, y = point
    best = math.inf
    for (ax, ay), (bx, by) in zip(polygon, (*polygon[1:], polygon[0]), strict=True):
        ex, ey = bx - ax, by - ay
        share = ((x - ax) * ex + (y - ay) * ey) / (ex * ex + ey * ey or 1.0)
        share = min(1.0, max(0.0, share))
        best = min(best, math.hypot(ax + share * ex - x, ay + share * ey - y))
    return best


def rectangle(centre: Vec2, size: Vec2, yaw: float) -> tuple[Vec2, Vec2, Vec2, Vec2]:
    """Corners of a turned rectangle, counter-clockwise; ``size`` [m] is its full width and depth."""
    corners = []
    for sx, sy in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)):
        x, y = turn((sx * size[0], sy * size[1]), yaw)
        corners.append((centre[0] + x, centre[1] + y))
    return (corners[0], corners[1], corners[2], corners[3])


def distance_to_rectangle(point: Vec2, centre: Vec2, size: Vec2, yaw: float) -> float:
    """Distance [m] from a point to a turned rectangle, 0 for a point inside."""
    x, y = turn((point[0] - centre[0], point[1] - centre[1]), -yaw)
    return math.hypot(max(abs(x) - size[0] / 2, 0.0), max(abs(y) - size[1] / 2, 0.0))


def rectangular_strips(polygon: Sequence[Vec2]) -> Iterator[tuple[float, float, float, float]]:
    """Rectangles x0, y0, x1, y1 [m] that make up a polygon, from south to north; exact if all corners are square."""
    xs, ys = (sorted({round(corner[axis], 4) for corner in polygon}) for axis in (0, 1))
    for y0, y1 in itertools.pairwise(ys):
        begin = None
        for x0, x1 in [*itertools.pairwise(xs), (xs[-1], xs[-1])]:
            covered = x1 > x0 and inside(((x0 + x1) / 2, (y0 + y1) / 2), polygon)
            if covered and begin is None:
                begin = x0
            elif not covered and begin is not None:
                yield (begin, y0, x0, y1)
                begin = None
