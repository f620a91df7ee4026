"""Splits the things of a house into those that can move, which the engine simulates, and those that never move.

Movable are the objects that a world is built with, and those things of the house that can be picked up and lie on a
surface, where `hthor.houses.laying` lays them. Things that cannot lie on a surface stay where the house puts them, as
furniture does. So do things on the bare floor, which are obstacles on the free-space grid.
"""

from collections.abc import Iterable

from msgspec import Struct

from hthor import catalog
from hthor.errors import HthorError
from hthor.houses import laying
from hthor.houses.checks import ids
from hthor.types import HouseSpec, Opening, Room, Thing, Vec3, Wall

DEFAULT_OBJECTS = tuple((name, name) for name in catalog.TARGETS)
"""The six target objects as (id, kind) pairs; their ids are their kinds' names."""


class MovableSpec(Struct, frozen=True, kw_only=True):
    """An object that can move: ``home`` [m] is where the house puts it, None for an object that a task must place."""

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
        """Whether it is one of the many small things of a house that are never the target of a task."""
        return self.home is not None and catalog.kind(self.kind).family != "target"


class Contents(Struct, frozen=True, kw_only=True):
    """A house's things, split into movable and static ones; ``doors`` are the static things that open."""

    statics: tuple[Thing, ...]
    movables: tuple[MovableSpec, ...]
    doors: tuple[Thing, ...]


def split_things(house: HouseSpec, objects: Iterable[tuple[str, str]]) -> Contents:
    """Split the house's things and the world's ``objects``, given as (id, kind) pairs.

    Raises:
        HthorError: when an object's id is that of something else or cannot be used, or its kind cannot be picked up.
        UnknownName: when a kind does not exist.
    """
    movables = [_free(thing) for thing in laying.movable_objects(house)]
    taken = {movable.id for movable in movables}
    statics = tuple(thing for thing in house.things if thing.id not in taken)
    parts: tuple[Thing | Room | Wall | Opening, ...] = (*house.things, *house.rooms, *house.walls, *house.openings)
    taken = {ids.engine_name(part.id) for part in parts}
    for pair in objects:
        id, name = _pair(pair)
        if problem := ids.why_unusable(id, brought=True):
            raise HthorError(f"objects: {problem}")
        kind = catalog.kind(name)
        if ids.engine_name(id) in taken:
            raise HthorError(f"object id '{id}' is taken by another thing of house '{house.id}'; choose another id")
        if not kind.pickable:
            raise HthorError(f"object '{id}' is of kind '{name}', which cannot be picked up")
        taken.add(ids.engine_name(id))
        movables.append(MovableSpec(id=id, kind=name, size=kind.size, mass=kind.mass))
    doors = tuple(thing for thing in statics if catalog.kind(thing.kind).joints(thing.size))
    return Contents(statics=statics, movables=tuple(movables), doors=doors)


def _pair(given: object) -> tuple[str, str]:
    """An (id, kind) pair as it was given."""
    pair = given if isinstance(given, (tuple, list)) else ()
    if len(pair) != 2 or not all(isinstance(word, str) for word in pair):
        raise HthorError(f"objects must be pairs of an id and a kind, such as ('my_apple', 'apple'), got {given!r:.60}")
    return pair[0], pair[1]


def _free(thing: Thing) -> MovableSpec:
    kind = catalog.kind(thing.kind)
    scale = (thing.size[0] * thing.size[1] * thing.size[2]) / (kind.size[0] * kind.size[1] * kind.size[2])
    return MovableSpec(
        id=thing.id,
        kind=thing.kind,
        size=thing.size,
        mass=kind.mass * scale,
        variant=thing.variant,
        home=thing.centre,
        yaw=thing.yaw,
        support=thing.parent,
    )
