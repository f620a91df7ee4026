"""What of a house moves and what stays: the split that decides which things the engine simulates; knows no engine.

Furniture and clutter stay where the house puts them. Free to move are the objects that a world is built with and the
house's own things of the benchmark's target kinds, unless they lie on the bare floor, where the free-space grid counts
them as obstacles.
"""

from __future__ import annotations

from collections.abc import Iterable

from msgspec import Struct

from hthor import catalog, geometry
from hthor.errors import HthorError
from hthor.types import HouseSpec, Surface, Thing, Vec3

DEFAULT_OBJECTS = tuple((name, name) for name in catalog.TARGETS)
"""The six target objects as (id, kind) pairs; their ids are their kinds' names."""

_SNAP_M = 0.30
"""How far above or below a surface a house file may place what lies on it."""


class Movable(Struct, frozen=True, kw_only=True):
    """An object that can move: ``home`` is where the house puts it, None for one that a task must place."""

    id: str
    kind: str
    size: Vec3
    mass: float
    home: Vec3 | None = None
    yaw: float = 0.0
    support: str = ""


class Contents(Struct, frozen=True, kw_only=True):
    """A house's things, split. ``doors`` are the statics that open."""

    statics: tuple[Thing, ...]
    movables: tuple[Movable, ...]
    doors: tuple[Thing, ...]


def split(house: HouseSpec, objects: Iterable[tuple[str, str]]) -> Contents:
    """Sort the house's things and the world's ``objects``, given as (id, kind) pairs.

    Raises:
        HthorError: when two things share an id, or an object's kind cannot be picked up.
        UnknownName: when a kind does not exist.
    """
    free = tuple(thing for thing in house.things if _is_free(thing))
    taken = {thing.id for thing in free}
    statics = tuple(thing for thing in house.things if thing.id not in taken)
    supports = {thing.id: thing for thing in statics}
    movables = [_placed(thing, supports.get(thing.parent)) for thing in free]
    taken = {thing.id for thing in house.things}
    for id, name in objects:
        kind = catalog.kind(name)
        if id in taken:
            raise HthorError(f"object id '{id}' is taken by another thing of house '{house.id}'; choose another id")
        if not kind.pickable:
            raise HthorError(f"object '{id}' is of kind '{name}', which cannot be picked up")
        taken.add(id)
        movables.append(Movable(id=id, kind=name, size=kind.size, mass=kind.mass))
    doors = tuple(thing for thing in statics if catalog.kind(thing.kind).joints(thing.size))
    return Contents(statics=statics, movables=tuple(movables), doors=doors)


def _is_free(thing: Thing) -> bool:
    kind = catalog.kind(thing.kind)
    return kind.pickable and kind.family == "target" and bool(thing.parent)


def _placed(thing: Thing, support: Thing | None) -> Movable:
    """The thing where its house puts it, laid exactly on the surface of ``support`` below it."""
    kind = catalog.kind(thing.kind)
    x, y, z = thing.centre
    if support is not None:
        low = z - thing.size[2] / 2
        heights = [height for height in _heights(support, thing.centre) if abs(height - low) <= _SNAP_M]
        z = min(heights, key=lambda height: abs(height - low), default=low) + thing.size[2] / 2
    scale = (thing.size[0] * thing.size[1] * thing.size[2]) / (kind.size[0] * kind.size[1] * kind.size[2])
    return Movable(
        id=thing.id,
        kind=thing.kind,
        size=thing.size,
        mass=kind.mass * scale,
        home=(x, y, z),
        yaw=thing.yaw,
        support=thing.parent,
    )


def _heights(support: Thing, point: Vec3) -> list[float]:
    local = geometry.to_local(point, support.centre, support.yaw)
    surfaces: tuple[Surface, ...] = catalog.kind(support.kind).surfaces(support.size)
    return [
        support.centre[2] + surface.centre[2]
        for surface in surfaces
        if all(abs(local[axis] - surface.centre[axis]) <= surface.half[axis] for axis in (0, 1))
    ]
