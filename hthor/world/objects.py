"""The movable objects of one episode: where each is, what it lies on, who holds it; knows nothing of laws."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from hthor.geometry import wrap
from hthor.types import ThingState, Vec3
from hthor.world import geoms
from hthor.world.contents import Movable
from hthor.world.env import FastEnv, QPose
from hthor.world.places import Places
from hthor.world.scene import Scene

AWAY: Vec3 = (-500.0, 0.0, 0.0)


class Item:
    """One object. ``present`` is false for what this episode does not use."""

    def __init__(self, movable: Movable, model: Any, span: tuple[int, int]) -> None:
        self.id, self.kind, self.size, self.mass = movable.id, movable.kind, movable.size, movable.mass
        body = model.geom_bodyid[span[0]]
        joint = model.body_jntadr[body]
        self.qpos, self.dof = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        self.tree = int(model.body_treeid[body])
        self.geoms = slice(*span)
        self.clear()

    def clear(self) -> None:
        """Out of the world until placed."""
        self.present, self.settling, self.held_by, self.support = False, False, "", ""
        self.position, self.yaw = AWAY, 0.0

    def at(self, qpos: Sequence[float]) -> None:
        """Read position and heading from a pose, position and quaternion."""
        x, y, z, w, _, _, k = qpos
        self.position, self.yaw = (x, y, z), wrap(2.0 * math.atan2(k, w))

    def state(self) -> ThingState:
        """Its true state now."""
        return ThingState(
            id=self.id, kind=self.kind, position=self.position, support=self.support, held_by=self.held_by
        )


class Objects:
    """All movable objects of a world.

    Attributes:
        changes: grows whenever any object's position, holder or support changes.
    """

    def __init__(self, movables: Iterable[Movable], env: FastEnv, scene: Scene, places: Places) -> None:
        self._env, self._scene, self._places = env, scene, places
        items = (Item(movable, env.model, scene.span[movable.id]) for movable in movables)
        self._items = {item.id: item for item in sorted(items, key=lambda item: item.id)}
        self.changes = 0

    def __iter__(self) -> Iterator[Item]:
        return iter(self._items.values())

    def get(self, id: str) -> Item | None:
        """The object of that id if it is in this episode."""
        item = self._items.get(id)
        return item if item is not None and item.present else None

    def reset(self, starts: Mapping[str, tuple[Vec3, float, str]]) -> None:
        """Begin an episode, the engine having been reset: id -> (position, yaw, what the task says it lies on)."""
        for item in self:
            self._collide(item, True)
            item.clear()
            if item.id in starts:
                position, item.yaw, support = starts[item.id]
                item.present, item.position = True, position
                item.support = self._places.support(position, item.size[2]) or support
        self._scene.hide_all_but(())
        self.changes += 1

    def take(self, id: str, seat: str, hand: Callable[[], QPose]) -> None:
        """From now on the object is in the hand of ``seat``, which ``hand()`` says where it is."""
        item = self._items[id]
        item.held_by, item.support, item.settling = seat, "", False
        self._collide(item, False)
        self._env.carry(item.tree, item.qpos, item.dof, hand)
        self._after_handling()
        self.follow(id)

    def put(self, id: str, pose: QPose, support: str) -> None:
        """Let go of the object at ``pose``, a little above ``support``."""
        item = self._items[id]
        item.held_by, item.support, item.settling = "", support, True
        item.at(pose)
        self._collide(item, True)
        self._env.release(item.tree, pose)
        self._after_handling()

    def follow(self, id: str) -> None:
        """A carried object's holder has moved."""
        item = self._items[id]
        self._env.pin()
        item.at(self._env.data.qpos[item.qpos : item.qpos + 7].tolist())
        self.changes += 1

    def settle(self) -> None:
        """Read from the engine what moved in the last tick; what came to rest lies on what is below it."""
        asleep = self._env.asleep
        for item in self:
            if not item.present or item.held_by or (asleep[item.tree] >= 0 and not item.settling):
                continue
            item.at(self._env.data.qpos[item.qpos : item.qpos + 7].tolist())
            item.settling = True
            if asleep[item.tree] >= 0:
                item.settling = False
                item.support = self._places.support(item.position, item.size[2])
            self.changes += 1

    def _collide(self, item: Item, on: bool) -> None:
        bits = geoms.MOVABLE if on else geoms.GHOST
        self._env.model.geom_contype[item.geoms] = bits["contype"]
        self._env.model.geom_conaffinity[item.geoms] = bits["conaffinity"]

    def _after_handling(self) -> None:
        self._scene.hide_all_but(item.id for item in self if item.held_by)
        self.changes += 1
