"""Worlds that are kept for later trials in the same house, within a bound on their memory."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import TYPE_CHECKING

from msgspec import Struct

from hthor import gc_freeze

if TYPE_CHECKING:
    from hthor.world import World

Objects = tuple[tuple[str, str], ...]
"""(id, kind) pairs of the objects that a task places."""
MOST_BYTES = 1 << 30
"""The most memory for worlds that are kept. Our choice: 25 to 40 houses."""
SPARE_MAX = 16
"""The most objects in a world that serves tasks with different ones: each costs some time in every tick. Our choice."""
_KEPT_SHARE = 0.75
"""So full are the worlds after some were dropped, as finding their memory again takes as long as building one."""


class _Kept(Struct, eq=False):
    key: Hashable
    objects: Objects
    world: World


class Worlds:
    """Keeps worlds; those that were not used for the longest time are dropped when they take too much memory.

    A trial goes the same in a world that has more objects than its task places, so tasks with different objects in one
    house share a world.

    Args:
        most_bytes: the most memory, by `World.nbytes`; the world that was asked for last is kept in any case.
    """

    def __init__(self, most_bytes: int = MOST_BYTES) -> None:
        self._most_bytes = most_bytes
        self._kept: list[_Kept] = []  # the one used last is last
        gc_freeze.unfreeze_after(self)

    def __len__(self) -> int:
        return len(self._kept)

    def get(self, key: Hashable, objects: Objects, make: Callable[[Objects], World]) -> World:
        """A world for tasks that place these objects, made by ``make`` unless there is one.

        Args:
            key: everything that decides a world, except its objects.
        """
        place = self._find(key, objects)
        if place is None:
            objects = self._take_in(key, objects)
            self._kept.append(_Kept(key, objects, make(objects)))
            self._make_room()
            gc_freeze.freeze_existing()
        else:
            self._kept.append(self._kept.pop(place))
        return self._kept[-1].world

    def _find(self, key: Hashable, objects: Objects) -> int | None:
        """The place of a world with all these objects; None if there is none."""
        for place, kept in enumerate(self._kept):
            if kept.key == key and set(objects) <= set(kept.objects):
                return place
        return None

    def _take_in(self, key: Hashable, objects: Objects) -> Objects:
        """These objects and those of a world that can have them too, which is dropped for the new one with all."""
        for place, kept in enumerate(self._kept):
            if kept.key == key and _share_a_world(kept.objects, objects):
                del self._kept[place]
                return tuple(dict.fromkeys((*kept.objects, *objects)))
        return objects

    def _make_room(self) -> None:
        """Drop the worlds that were used least lately, if all together take too much memory."""
        sizes = [kept.world.nbytes for kept in self._kept]
        left, count = sum(sizes), 0
        if left <= self._most_bytes:
            return
        while count < len(sizes) - 1 and left > _KEPT_SHARE * self._most_bytes:
            left -= sizes[count]
            count += 1
        del self._kept[:count]
        gc_freeze.collect_frozen()


def _share_a_world(some: Objects, others: Objects) -> bool:
    """Whether a world can have all these objects: not too many, and none with two kinds."""
    both = {*some, *others}
    return len(both) <= SPARE_MAX and len({id for id, _ in both}) == len(both)
