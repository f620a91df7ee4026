"""Rules about the bare plan: how large rooms are, how wide doorways."""

import itertools
import math
from collections.abc import Iterator

from hthor.geometry.plane import signed_area
from hthor.houses.checks import polygons
from hthor.houses.checks.findings import Finding, readable_kind, warning
from hthor.houses.space import solids
from hthor.houses.space.free_space import STEP_M
from hthor.houses.space.solids import Slab
from hthor.types import HouseSpec, Opening, Vec2

CODE_PART = "tools"

AREA_M2 = 4.0
WIDTH_M = 1.4
"""Least area of a room, and least width of any stretch of it."""
CLEAR_M = 0.8
"""Least clear width of a doorway."""
BEFORE_M = 0.3
"""What stands nearer than this to a doorway, on either side, narrows it."""
LEAF_M = 0.06
"""What an open leaf and the frame that it hangs in take of a doorway's width."""
_DOUBLE_M = 1.3
"""Wider doorways have two leaves."""
_HAIR_M = 1e-6


def check_rooms(house: HouseSpec) -> Iterator[Finding]:
    """``room-size``: smaller than `AREA_M2`, or somewhere narrower than `WIDTH_M`."""
    for room in house.rooms:
        area, width = abs(signed_area(room.polygon)), least_width(room.polygon)
        if area < AREA_M2:
            problem = f"the {room.name or room.kind} has {area:.2f} m2; a room needs {AREA_M2} m2"
            yield warning("room-size", room.id, problem)
        if width < WIDTH_M - _HAIR_M:
            problem = f"the {room.name or room.kind} is only {width:.2f} m wide somewhere; it needs {WIDTH_M} m"
            yield warning("room-size", room.id, problem)


def least_width(polygon: tuple[Vec2, ...]) -> float:
    """Least length [m] of any cut through the polygon along x or y; its least width when its corners are square."""
    turned = tuple((y, x) for x, y in polygon)
    return min(_narrowest(polygon), _narrowest(turned))


def _narrowest(polygon: tuple[Vec2, ...]) -> float:
    marks = sorted({round(x, 6) for x, _ in polygon})
    middles = [(a + b) / 2 for a, b in itertools.pairwise(marks) if b - a > 1e-3]
    return min((high - low for x in middles for low, high in polygons.vertical_spans(x, polygon)), default=0.0)


def check_doors(house: HouseSpec, height: float) -> Iterator[Finding]:
    """``door-clear``: a doorway with less than `CLEAR_M` between its jambs and the furniture near it."""
    pieces = [
        (thing, slab) for thing, slab in solids.furniture_slabs(house) if slab.low < height and slab.high > STEP_M
    ]
    for opening in house.openings:
        if not opening.passable:
            continue
        near = [(thing, span) for thing, slab in pieces if (span := _shadow(opening, slab)) is not None]
        width = math.dist(opening.a, opening.b)
        clear = widest_gap(width, [*_leaves(opening, width), *(span for _, span in near)])
        if clear < CLEAR_M - _HAIR_M:
            who = ", ".join(f"'{thing.id}' ({readable_kind(thing.kind)})" for thing, _ in near)
            problem = f"{clear:.2f} m clear; a doorway needs {CLEAR_M} m"
            yield warning("door-clear", opening.id, problem + (f"; in the way: {who}" if who else ""))


def _leaves(opening: Opening, width: float) -> list[tuple[float, float]]:
    """The stretches [m] along a doorway that its open leaves take: at its end ``a``, of a wide one at both."""
    if not opening.openable:
        return []
    return [(0.0, LEAF_M)] if width <= _DOUBLE_M else [(0.0, LEAF_M), (width - LEAF_M, width)]


def widest_gap(width: float, spans: list[tuple[float, float]]) -> float:
    """The longest stretch [m] of ``[0, width]`` that no span covers."""
    best, start = 0.0, 0.0
    for low, high in sorted(spans):
        best, start = max(best, min(low, width) - start), max(start, high)
    return max(best, width - start)


def _shadow(opening: Opening, slab: Slab) -> tuple[float, float] | None:
    """The stretch [m] along the doorway that a box takes of the floor before it, None for a box that is elsewhere."""
    width = math.dist(opening.a, opening.b)
    if width < _HAIR_M:
        return None
    ux, uy = (opening.b[0] - opening.a[0]) / width, (opening.b[1] - opening.a[1]) / width
    deep = solids.WALL_M / 2 + BEFORE_M
    cos, sin = math.cos(slab.yaw), math.sin(slab.yaw)
    corners = []
    for sx, sy in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)):
        x = slab.centre[0] + sx * slab.size[0] * cos - sy * slab.size[1] * sin - opening.a[0]
        y = slab.centre[1] + sx * slab.size[0] * sin + sy * slab.size[1] * cos - opening.a[1]
        corners.append((x * ux + y * uy, y * ux - x * uy))
    inside = _below(_below(corners, deep), deep, -1.0)
    if not inside:
        return None
    low, high = max(0.0, min(u for u, _ in inside)), min(width, max(u for u, _ in inside))
    return (low, high) if high - low > _HAIR_M else None


def _below(corners: list[Vec2], limit: float, sign: float = 1.0) -> list[Vec2]:
    """The part of a convex polygon where ``sign * v`` is below the limit."""
    kept: list[Vec2] = []
    for (u0, v0), (u1, v1) in zip(corners, (*corners[1:], *corners[:1]), strict=True):
        if sign * v0 < limit:
            kept.append((u0, v0))
        if (sign * v0 < limit) != (sign * v1 < limit):
            share = (sign * limit - v0) / (v1 - v0)
            kept.append((u0 + share * (u1 - u0), sign * limit))
    return kept
