"""Obstacles as upright boxes: walls cut at doorways, and furniture."""

import math
from collections.abc import Iterator
from typing import NamedTuple

from hthor.types import HouseSpec, Opening, Thing, Vec2, Wall

WALL_M = 0.10
"""Thickness of every wall, half of it on either side of the line that the house file gives."""
_LINE_M = 0.08
"""How far a doorway's ends may lie from the line of a wall that it cuts, since a wall's two faces may be apart."""
_SHORT_M = 1e-6


class Slab(NamedTuple):
    """An upright box: ``centre`` and full ``size`` of its footprint, its ``yaw``, and how high it reaches, all [m]."""

    centre: Vec2
    size: Vec2
    yaw: float
    low: float
    high: float


def wall_slabs(house: HouseSpec) -> tuple[Slab, ...]:
    """Every wall, cut at the passable doorways (closed doors and windows stay solid), each stretch once.

    A wall reaches half its thickness beyond its two ends, so that corners are closed; not beyond a doorway's jambs.
    """
    doorways = [opening for opening in house.openings if opening.passable]
    slabs: dict[tuple[int, ...], Slab] = {}
    for wall in house.walls:
        for slab in _pieces(wall, doorways):
            slabs.setdefault(_key(slab), slab)
    return tuple(slabs.values())


def furniture_slabs(house: HouseSpec) -> tuple[tuple[Thing, Slab], ...]:
    """Every thing that stands on the floor or hangs on a wall with its bounding box.

    Things on or in other things are left out: their supports are included.
    """
    return tuple((thing, _box(thing)) for thing in house.things if not thing.parent or _bottom(thing) <= 0.05)


def _bottom(thing: Thing) -> float:
    return thing.centre[2] - thing.size[2] / 2


def _box(thing: Thing) -> Slab:
    low = _bottom(thing)
    return Slab((thing.centre[0], thing.centre[1]), (thing.size[0], thing.size[1]), thing.yaw, low, low + thing.size[2])


def _key(slab: Slab) -> tuple[int, ...]:
    """A key that is equal for the two faces of one wall, whatever their directions."""
    yaw = round(math.degrees(slab.yaw) * 100) % 18000
    numbers = (*slab.centre, *slab.size, slab.low, slab.high)
    return (*(round(number * 1e4) for number in numbers), yaw)


def _pieces(wall: Wall, doorways: list[Opening]) -> Iterator[Slab]:
    length = math.dist(wall.a, wall.b)
    if length < _SHORT_M:
        return
    along = ((wall.b[0] - wall.a[0]) / length, (wall.b[1] - wall.a[1]) / length)
    cuts = sorted(cut for doorway in doorways if (cut := _cut(wall, along, length, doorway)) is not None)
    start = -WALL_M / 2
    for begin, end, low, high in cuts:
        yield from _slab(wall, along, start, begin, 0.0, wall.height)
        yield from _slab(wall, along, begin, end, 0.0, low)
        yield from _slab(wall, along, begin, end, high, wall.height)
        start = max(start, end)
    yield from _slab(wall, along, start, length + WALL_M / 2, 0.0, wall.height)


def _cut(wall: Wall, along: Vec2, length: float, doorway: Opening) -> tuple[float, float, float, float] | None:
    """The stretch (begin, end) [m] along the wall and the heights (low, high) that the doorway cuts out of it.

    A cut that reaches the wall's end also removes the half thickness beyond it.
    """
    places = []
    for x, y in (doorway.a, doorway.b):
        dx, dy = x - wall.a[0], y - wall.a[1]
        if abs(along[0] * dy - along[1] * dx) > _LINE_M:
            return None
        places.append(along[0] * dx + along[1] * dy)
    begin, end = max(min(places), 0.0), min(max(places), length)
    if end - begin < _SHORT_M:
        return None
    return (
        begin if begin > _SHORT_M else -WALL_M / 2,
        end if end < length - _SHORT_M else length + WALL_M / 2,
        doorway.low,
        doorway.high,
    )


def _slab(wall: Wall, along: Vec2, begin: float, end: float, low: float, high: float) -> Iterator[Slab]:
    if end - begin > _SHORT_M and high - low > _SHORT_M:
        middle = (begin + end) / 2
        centre = (wall.a[0] + along[0] * middle, wall.a[1] + along[1] * middle)
        yield Slab(centre, (end - begin, WALL_M), math.atan2(along[1], along[0]), low, high)


def overlap_depth(one: Slab, two: Slab) -> float:
    """How deep [m] two boxes overlap, by the least sideways shift that separates them; 0 when they do not."""
    if one.low >= two.high or two.low >= one.high:
        return 0.0
    depth = math.inf
    dx, dy = two.centre[0] - one.centre[0], two.centre[1] - one.centre[1]
    for yaw in (one.yaw, one.yaw + math.pi / 2, two.yaw, two.yaw + math.pi / 2):
        ux, uy = math.cos(yaw), math.sin(yaw)
        depth = min(depth, _spread(one, ux, uy) + _spread(two, ux, uy) - abs(dx * ux + dy * uy))
    return max(depth, 0.0)


def penetration(one: Slab, two: Slab) -> float:
    """How deep [m] two boxes overlap, by the least shift, sideways or upward, that separates them."""
    return min(overlap_depth(one, two), min(one.high, two.high) - max(one.low, two.low))


def _spread(slab: Slab, ux: float, uy: float) -> float:
    """Half the extent of a footprint along a unit direction."""
    cos, sin = math.cos(slab.yaw), math.sin(slab.yaw)
    return (abs(cos * ux + sin * uy) * slab.size[0] + abs(cos * uy - sin * ux) * slab.size[1]) / 2
