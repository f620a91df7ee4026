"""Puts the small things of a house exactly on the surfaces below them, when the house is loaded.

A house file gives heights measured on furniture of other shapes than hthor's, so a cup would hang above its table or be
inside a shelf. A thing that cannot be put down stays where the file puts it and does not move: it would be deeper than
`SUNK_M` in a neighbour or the ceiling, or it is over no surface.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import msgspec

from hthor import catalog
from hthor.geometry import plane
from hthor.houses.space import solids
from hthor.houses.space.solids import Slab
from hthor.types import HouseSpec, Thing, Vec3

SUNK_M = 0.005
"""How deep a small thing may be in another thing and still count as free to move."""
ROUNDING_M = 1e-4
"""A height within this distance of the surface's height is the same, rounded: the file's number is kept."""
_SNAP_M = 0.30
"""How far above or below its surface a house file may place a thing."""


def snap_objects(house: HouseSpec) -> HouseSpec:
    """The house with every small thing on its surface; `Thing.lift` is how much higher the file places the thing.

    Doing this twice changes nothing more.
    """
    laid = {thing.id: thing for thing in movable_objects(house)}
    things = tuple(_laid(thing, laid.get(thing.id, thing)) for thing in house.things)
    return msgspec.structs.replace(house, things=things)


def movable_objects(house: HouseSpec) -> tuple[Thing, ...]:
    """The small things that rest freely on a surface, exactly on it, in the house's order.

    Of two things that overlap, the first is free. A thing on another small thing follows it to that thing's new place.
    """
    return tuple(laid for _, laid, _ in _lay(house) if laid is not None)


def fixed_objects(house: HouseSpec) -> Iterator[tuple[Thing, str]]:
    """The other small things that a file puts on or into something, each with the reason why it cannot be moved."""
    return ((thing, problem) for thing, laid, problem in _lay(house) if laid is None)


def _lay(house: HouseSpec) -> Iterator[tuple[Thing, Thing | None, str]]:
    """Every small thing with a support, where it lies on that, or None and the reason why it cannot."""
    small = {thing.id for thing in house.things if catalog.kind(thing.kind).pickable}
    standing = (thing for thing in house.things if thing.id not in small or not thing.parent)
    crowd = _Crowd([*solids.wall_slabs(house), *(slab for thing in standing for slab in part_slabs(thing))])
    supports = {thing.id: thing for thing in house.things}
    for thing in house.things:
        if thing.id not in small or not thing.parent:
            continue
        laid, problem = _on_surface(thing, supports.get(thing.parent))
        if laid is not None and _body(laid).high > house.height + SUNK_M:
            laid, problem = None, f"on '{thing.parent}' it reaches through the ceiling"
        if laid is not None and crowd.holds(_body(laid)):
            laid, problem = None, f"on '{thing.parent}' it is inside something else"
        if laid is None:
            crowd.add(part_slabs(thing))
        else:
            crowd.add([_body(laid)])
            supports[thing.id] = laid
        yield thing, laid, problem


def part_slabs(thing: Thing) -> Iterator[Slab]:
    """Every part of a thing, closed, as an upright box."""
    for part in catalog.kind(thing.kind).parts(thing.size):
        x, y, z = plane.to_house(part.centre, thing.centre, thing.yaw)
        yield Slab((x, y), (2 * part.half[0], 2 * part.half[1]), thing.yaw, z - part.half[2], z + part.half[2])


def _laid(thing: Thing, laid: Thing) -> Thing:
    lift = thing.centre[2] - laid.centre[2]
    if abs(lift) <= ROUNDING_M:
        return thing
    return msgspec.structs.replace(thing, centre=laid.centre, lift=thing.lift + lift)


def _on_surface(thing: Thing, support: Thing | None) -> tuple[Thing | None, str]:
    """The thing on the surface of ``support`` that is nearest below or above it; None and why if no surface is near."""
    x, y, z = thing.centre
    low = z - thing.size[2] / 2
    heights = [] if support is None else _heights(support, thing.centre)
    height = min(heights, key=lambda height: abs(height - low), default=None)
    if height is None:
        return None, f"it is over no surface of '{thing.parent}'"
    if abs(height - low) > _SNAP_M:
        side = "above" if low > height else "below"
        return None, f"it is {abs(low - height):.2f} m {side} '{thing.parent}', more than {_SNAP_M:.2f} m"
    return msgspec.structs.replace(thing, centre=(x, y, height + thing.size[2] / 2)), ""


def _heights(support: Thing, point: Vec3) -> list[float]:
    """Heights [m] of the surfaces that the point is above or below."""
    local = plane.to_local(point, support.centre, support.yaw)
    return [
        support.centre[2] + surface.centre[2]
        for surface in catalog.kind(support.kind).surfaces(support.size)
        if all(abs(local[axis] - surface.centre[axis]) <= surface.half[axis] for axis in (0, 1))
    ]


def _body(thing: Thing) -> Slab:
    (x, y, z), (w, d, h) = thing.centre, thing.size
    return Slab((x, y), (w, d), thing.yaw, z - h / 2, z + h / 2)


class _Crowd:
    """A growing set of solids, and whether a new one is deep in any of them. Plain floats: loading needs no numpy."""

    def __init__(self, first: Iterable[Slab]) -> None:
        self._rows: list[tuple[float, float, float, float, float, Slab]] = []
        self.add(first)

    def add(self, more: Iterable[Slab]) -> None:
        """Add these solids."""
        self._rows += [(*slab.centre, math.hypot(*slab.size) / 2, slab.low, slab.high, slab) for slab in more]

    def holds(self, body: Slab) -> bool:
        """Whether the body is deeper than `SUNK_M` in any of the solids."""
        (x, y), radius = body.centre, math.hypot(*body.size) / 2
        low, high = body.low + SUNK_M, body.high - SUNK_M
        return any(
            solids.overlap_depth(body, slab) > SUNK_M
            for u, v, r, bottom, top, slab in self._rows
            if bottom < high and top > low and (u - x) ** 2 + (v - y) ** 2 < (r + radius) ** 2
            if min(body.high, top) - max(body.low, bottom) > SUNK_M
        )
