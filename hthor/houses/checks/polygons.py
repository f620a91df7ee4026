"""Geometry of floor polygons: crossings, overlaps, distance to the outline."""

import itertools
import math
from collections.abc import Sequence

from hthor.types import Vec2

Polygon = Sequence[Vec2]
_SAME_M = 1e-6


def simplify(polygon: Polygon) -> tuple[Vec2, ...]:
    """The corners without repetitions of the corner before, or of the first corner at the end."""
    corners: list[Vec2] = []
    for corner in polygon:
        if not corners or math.dist(corner, corners[-1]) > _SAME_M:
            corners.append(corner)
    if len(corners) > 1 and math.dist(corners[0], corners[-1]) <= _SAME_M:
        corners.pop()
    return tuple(corners)


def edges(polygon: Polygon) -> list[tuple[Vec2, Vec2]]:
    """The sides, in order."""
    return list(zip(polygon, (*polygon[1:], polygon[0]), strict=True))


def _side(a: Vec2, b: Vec2, c: Vec2) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def distance_to_segment(point: Vec2, a: Vec2, b: Vec2) -> float:
    """Distance [m] from a point to a segment."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length2 = dx * dx + dy * dy
    share = ((point[0] - a[0]) * dx + (point[1] - a[1]) * dy) / length2 if length2 else 0.0
    share = min(1.0, max(0.0, share))
    return math.hypot(point[0] - a[0] - share * dx, point[1] - a[1] - share * dy)


def distance_to_outline(point: Vec2, polygon: Polygon) -> float:
    """Distance [m] from a point to the nearest side, inside as well as outside."""
    return min(distance_to_segment(point, a, b) for a, b in edges(polygon))


def _meet(p: tuple[Vec2, Vec2], q: tuple[Vec2, Vec2]) -> bool:
    """Whether two segments cross, or an end of one lies on the other; a common end alone does not count.

    So a floor may touch itself corner to corner, as a floor grown cell by cell does.
    """
    if _side(*p, q[0]) * _side(*p, q[1]) < 0 and _side(*q, p[0]) * _side(*q, p[1]) < 0:
        return True
    return any(_on(q, end) for end in p) or any(_on(p, end) for end in q)


def _on(side: tuple[Vec2, Vec2], point: Vec2) -> bool:
    """Whether a point lies on a segment, but not at its ends."""
    return distance_to_segment(point, *side) < _SAME_M and min(math.dist(point, end) for end in side) >= _SAME_M


def find_crossing(polygon: Polygon) -> tuple[int, int] | None:
    """Indices of two sides that cross, touch (other than in a common corner) or fold back on each other, or None."""
    sides = edges(polygon)
    count = len(sides)
    for i in range(count):
        for j in range(i + 1, count):
            if j == i + 1 or (i == 0 and j == count - 1):
                first, second = (i, j) if j == i + 1 else (j, i)
                if _folds(sides[first], sides[second][1]):
                    return i, j
            elif _meet(sides[i], sides[j]):
                return i, j
    return None


def _folds(side: tuple[Vec2, Vec2], after: Vec2) -> bool:
    (ax, ay), (bx, by) = side
    back = (bx - ax) * (after[0] - bx) + (by - ay) * (after[1] - by) < 0
    return back and abs(_side(*side, after)) < _SAME_M * math.dist(*side)


def overlap_area(p: Polygon, q: Polygon) -> float:
    """Area [m2] that two simple polygons share, exact up to rounding.

    The plane is cut into upright strips at every corner and every crossing of sides; within a strip the width that
    both cover changes linearly, so the width at its middle gives the area.
    """
    low = max(min(x for x, _ in p), min(x for x, _ in q))
    high = min(max(x for x, _ in p), max(x for x, _ in q))
    if low >= high:
        return 0.0
    cuts = {x for x, _ in (*p, *q)} | {x for a in edges(p) for b in edges(q) for x in _crossing_x(a, b)}
    marks = sorted({low, high} | {x for x in cuts if low < x < high})
    return sum((b - a) * _shared((a + b) / 2, p, q) for a, b in itertools.pairwise(marks))


def _crossing_x(a: tuple[Vec2, Vec2], b: tuple[Vec2, Vec2]) -> list[float]:
    one, two = _side(*b, a[0]), _side(*b, a[1])
    if one * two >= 0 or _side(*a, b[0]) * _side(*a, b[1]) >= 0:
        return []
    return [a[0][0] + (a[1][0] - a[0][0]) * one / (one - two)]


def vertical_spans(x: float, polygon: Polygon) -> list[tuple[float, float]]:
    """The stretches [m] in y of a polygon that the upright line at ``x`` runs through, lowest first."""
    ys = sorted(ay + (by - ay) * (x - ax) / (bx - ax) for (ax, ay), (bx, by) in edges(polygon) if (ax > x) != (bx > x))
    return list(zip(ys[::2], ys[1::2], strict=True))


def _shared(x: float, p: Polygon, q: Polygon) -> float:
    return sum(max(0.0, min(b, d) - max(a, c)) for a, b in vertical_spans(x, p) for c, d in vertical_spans(x, q))
