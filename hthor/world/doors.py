"""The hinged doors of one episode: which are open and how they swing; knows nothing of who opens them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from hthor.types import Thing, ThingState
from hthor.world.env import FastEnv
from hthor.world.openables import Door


class Leaf:
    """One door. ``user`` is the seat that is opening or closing it, empty otherwise."""

    def __init__(self, door: Door, env: FastEnv) -> None:
        self.thing: Thing = door.thing
        self.joints = door.joints
        ids = [env.physics.bind(element).element_id for element in door.elements]
        self.qpos = [int(env.model.jnt_qposadr[id]) for id in ids]
        self.dof = [int(env.model.jnt_dofadr[id]) for id in ids]
        self.open, self.user = False, ""


class Doors:
    """All things that open.

    Attributes:
        changes: grows whenever a door moves.
    """

    def __init__(self, doors: Iterable[Door], env: FastEnv) -> None:
        self._env = env
        self._leaves = {door.id: Leaf(door, env) for door in sorted(doors, key=lambda door: door.id)}
        self.changes = 0

    def __iter__(self) -> Iterator[Leaf]:
        return iter(self._leaves.values())

    def get(self, thing: str) -> Leaf | None:
        """The door of that thing, None for what has none."""
        return self._leaves.get(thing)

    def reset(self) -> None:
        """All closed, the engine having been reset."""
        for leaf in self:
            leaf.open, leaf.user = False, ""
        self.changes += 1

    def swing(self, leaf: Leaf, share: float) -> None:
        """Set a door ``share`` of the way open, 0 to 1."""
        for joint, qpos, dof in zip(leaf.joints, leaf.qpos, leaf.dof, strict=True):
            self._env.data.qpos[qpos] = joint.travel * share
            self._env.data.qvel[dof] = 0.0
        self._env.touch()
        self.changes += 1

    def states(self) -> Iterator[ThingState]:
        """True states of all things that open."""
        for leaf in self:
            thing = leaf.thing
            yield ThingState(id=thing.id, kind=thing.kind, position=thing.centre, open=leaf.open)
