"""What of a house moves and what stays: the split that decides which things the engine simulates; knows no engine.

Free to move are the objects that a world is built with, and of the house's own things all that can be picked up and lie
on a surface of something. What lies there in a way that no real thing could (deeper than `SUNK_M` in its neighbour or
in the ceiling, or over no surface at all) stays where the house puts it, as furniture does; so does what lies on the
bare floor, where the free-space grid counts it as an obstacle.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from msgspec import Struct

from hthor import catalog, geometry
from hthor.errors import HthorError
from hthor.houses import solids
from hthor.houses.solids import Slab
from hthor.types import HouseSpec, Surface, Thing, Vec3

DEFAULT_OBJECTS = tuple((name, name) for name in catalog.TARGETS)
"""The six target objects as (id, kind) pairs; their ids are their kinds' names."""
SUNK_M = 0.005
"""How deep an object of a house file may be in another and still count as free."""

_SNAP_M = 0.30
"""How far above or below a surface a house file may place what lies on it."""


class Movable(Struct, frozen=True, kw_only=True):
    """An object that can move: ``home`` is where the house puts it, None for one that a task must place."""

    id: str
    kind: str
    size: Vec3
    mass: float
    variant: int = 0
    home: Vec3 | None = None
    yaw: float = 0.0
    support: str = ""

    @property
    def clutter(self) -> bool:
        """Whether it is one of a house's many small things that no task asks for."""
        return self.home is not None and catalog.kind(self.kind).family != "target"


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
    movables = list(_free(house))
    taken = {movable.id for movable in movables}
    statics = tuple(thing for thing in house.things if thing.id not in taken)
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


def _free(house: HouseSpec) -> Iterator[Movable]:
    """The house's own things that can move, in its order; of two that are in one another the first."""
    small = {thing.id for thing in house.things if catalog.kind(thing.kind).pickable}
    standing = [thing for thing in house.things if thing.id not in small or not thing.parent]
    solid = [*solids.walls(house), *(slab for thing in standing for slab in _slabs(thing))]
    supports = {thing.id: thing for thing in house.things}
    for thing in house.things:
        if thing.id in small and thing.parent:
            placed = _placed(thing, supports.get(thing.parent))
            body = None if placed is None else _box(placed)
            if (
                placed is not None
                and body is not None
                and body.high <= house.height + SUNK_M
                and not any(_deep(body, other) for other in solid)
            ):
                solid.append(body)
                yield placed
            else:
                solid += _slabs(thing)


def _placed(thing: Thing, support: Thing | None) -> Movable | None:
    """The thing where its house puts it, laid exactly on the surface of ``support`` below it, None without any."""
    kind = catalog.kind(thing.kind)
    x, y, z = thing.centre
    low = z - thing.size[2] / 2
    heights = [] if support is None else _heights(support, thing.centre)
    height = min(heights, key=lambda height: abs(height - low), default=None)
    if height is None or abs(height - low) > _SNAP_M:
        return None
    scale = (thing.size[0] * thing.size[1] * thing.size[2]) / (kind.size[0] * kind.size[1] * kind.size[2])
    return Movable(
        id=thing.id,
        kind=thing.kind,
        size=thing.size,
        mass=kind.mass * scale,
        variant=thing.variant,
        home=(x, y, height + thing.size[2] / 2),
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


def _slabs(thing: Thing) -> list[Slab]:
    slabs = []
    for part in catalog.kind(thing.kind).parts(thing.size):
        x, y, z = geometry.to_house(part.centre, thing.centre, thing.yaw)
        slabs.append(Slab((x, y), (2 * part.half[0], 2 * part.half[1]), thing.yaw, z - part.half[2], z + part.half[2]))
    return slabs


def _box(movable: Movable) -> Slab:
    x, y, z = movable.home or (0.0, 0.0, 0.0)
    w, d, h = movable.size
    return Slab((x, y), (w, d), movable.yaw, z - h / 2, z + h / 2)


def _deep(one: Slab, two: Slab) -> bool:
    """Whether two boxes are deeper in one another than may be."""
    if min(one.high, two.high) - max(one.low, two.low) <= SUNK_M:
        return False
    return solids.overlap(one, two) > SUNK_M
