"""Convex outlines in the plane: the outline of points, and how deep a disc is in one."""

import math
from collections.abc import Iterable, Sequence

from hthor.types import Vec2


def hull(points: Iterable[Vec2]) -> tuple[Vec2, ...]:
    """Corners [m] of the convex outline of points, counter-clockwise (Andrew's monotone chain)."""
    ordered = sorted(set(points))
    if len(ordered) < 3:
        return tuple(ordered)
    lower, upper = _chain(ordered), _chain(ordered[::-1])
    return (*lower[:-1], *upper[:-1])


def disc_overlap(centre: Vec2, radius: float, outline: Sequence[Vec2]) -> tuple[float, Vec2]:
    """How deep [m] a disc is in a convex outline, 0 or less for not at all, and the unit vector along which the outline
    leaves the disc by the shortest way.

    Args:
        outline: its corners [m], counter-clockwise.
    """
    x, y = centre
    nearest, inward, least = outline[0], (1.0, 0.0), math.inf
    inside = len(outline) > 2
    for (ax, ay), (bx, by) in zip(outline, (*outline[1:], outline[0]), strict=True):
        ux, uy = bx - ax, by - ay
        if ux * (y - ay) - uy * (x - ax) < 0.0:
            inside = False
        square = ux * ux + uy * uy
        share = min(max(((x - ax) * ux + (y - ay) * uy) / square, 0.0), 1.0) if square else 0.0
        px, py = ax + share * ux, ay + share * uy
        apart = (px - x) ** 2 + (py - y) ** 2
        if apart < least:
            nearest, least = (px, py), apart
            inward = (-uy / math.sqrt(square), ux / math.sqrt(square)) if square else inward
    apart = math.sqrt(least)
    if apart < 1e-9:
        return radius, inward
    way = ((nearest[0] - x) / apart, (nearest[1] - y) / apart)
    return (radius + apart, (-way[0], -way[1])) if inside else (radius - apart, way)


def _chain(points: Sequence[Vec2]) -> list[Vec2]:
    chain: list[Vec2] = []
    for x, y in points:
        while len(chain) > 1:
            (ax, ay), (bx, by) = chain[-2:]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                break
            chain.pop()
        chain.append((x, y))
    return chain
