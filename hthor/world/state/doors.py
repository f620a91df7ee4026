"""The doors and drawers of one episode: which are open and how they move."""

from collections.abc import Iterable, Iterator

import numpy as np

from hthor.types import Opening, Thing, ThingState
from hthor.world.model import geoms
from hthor.world.model.articulated import Door
from hthor.world.model.composer_env import LazyComposerEnv
from hthor.world.state.support_surfaces import SupportSurfaces


class DoorState:
    """All doors and drawers of one thing, which move together, or those of a doorway.

    ``user`` is the seat that is opening or closing it, empty otherwise.
    """

    def __init__(self, door: Door, env: LazyComposerEnv) -> None:
        self.thing: Thing = door.thing
        self.opening: Opening | None = door.opens.opening
        self.parts, self.joints = door.opens.parts, door.joints
        ids = [env.physics.bind(element).element_id for element in door.elements]
        self.qpos = [int(env.model.jnt_qposadr[id]) for id in ids]
        self.dof = [int(env.model.jnt_dofadr[id]) for id in ids]
        hinges = [env.model.jnt_bodyid[id] for id, joint in zip(ids, self.joints, strict=True) if joint.kind == "hinge"]
        self.geoms = np.flatnonzero(np.isin(env.model.geom_bodyid, hinges))
        self.clear()

    def clear(self) -> None:
        """The state at the start of an episode: things closed, doorways open."""
        self.open, self.user = self.opening is not None, ""
        self.share = 1.0 if self.open else 0.0

    @property
    def slides(self) -> bool:
        """Whether it has drawers."""
        return any(joint.kind == "slide" for joint in self.joints)


class Doors:
    """All things that open, and the doorways with leaves.

    Attributes:
        changes: grows whenever a door moves.
    """

    def __init__(self, doors: Iterable[Door], env: LazyComposerEnv, surfaces: SupportSurfaces) -> None:
        self._env, self._surfaces = env, surfaces
        self._leaves = {door.id: DoorState(door, env) for door in sorted(doors, key=lambda door: door.id)}
        self._moved: set[str] = set(self._leaves)
        self.changes = 0

    def __iter__(self) -> Iterator[DoorState]:
        return iter(self._leaves.values())

    def get(self, thing: str) -> DoorState | None:
        """The door of that thing, None for what has none."""
        return self._leaves.get(thing)

    def reset(self) -> None:
        """Begin an episode, after the engine was reset: things closed, doorways open."""
        for id in sorted(self._moved):
            leaf = self._leaves[id]
            leaf.clear()
            self._firm(leaf)
        if self._moved:
            self._surfaces.reset()
        self._moved.clear()
        self.changes += 1

    def swing(self, leaf: DoorState, share: float) -> None:
        """Set a door ``share`` of the way open, 0 to 1."""
        for joint, qpos, dof in zip(leaf.joints, leaf.qpos, leaf.dof, strict=True):
            self._env.data.qpos[qpos] = joint.travel * share
            self._env.data.qvel[dof] = 0.0
        leaf.share = share
        self._moved.add(leaf.thing.id)
        self._surfaces.pull(leaf.thing.id, share)
        self._firm(leaf)
        self._env.touch()
        self.changes += 1

    def _firm(self, leaf: DoorState) -> None:
        """A hinged door stops objects only while it is closed; a drawer always does."""
        self._env.model.geom_contype[leaf.geoms] = geoms.SWUNG if leaf.share > 0.0 else geoms.SHUT

    def states(self) -> Iterator[ThingState]:
        """True states of all things that open."""
        return (door_state(leaf) for leaf in self)


def door_state(leaf: DoorState) -> ThingState:
    """The true state of a thing that opens, or of a doorway with a leaf, whose kind is "door"."""
    thing = leaf.thing
    return ThingState(id=thing.id, kind=thing.kind, position=thing.centre, open=leaf.open)
