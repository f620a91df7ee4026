"""The movable objects of one episode: where each is, what it lies on, who holds it; knows nothing of seats' bodies."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from hthor.types import ThingState, Vec3
from hthor.world.contents import Movable
from hthor.world.engine import mujoco
from hthor.world.env import FastEnv
from hthor.world.places import Places
from hthor.world.scene import Scene
from hthor.world.task import HouseTask


class Item:
    """One object. ``present`` is false for what this episode does not use."""

    __slots__ = ("dof", "geoms", "held_by", "id", "kind", "mass", "position", "present", "qpos", "size", "support", "tree")

    def __init__(self, movable: Movable, model: object, geoms: tuple[int, int]) -> None:
        self.id, self.kind, self.size, self.mass = movable.id, movable.kind, movable.size, movable.mass
        body = model.geom_bodyid[geoms[0]]  # type: ignore[attr-defined]
        joint = model.body_jntadr[body]  # type: ignore[attr-defined]
        self.qpos, self.dof = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])  # type: ignore[attr-defined]
        self.tree = int(model.body_treeid[body])  # type: ignore[attr-defined]
        self.geoms = slice(*geoms)
        self.present, self.held_by, self.support = False, "", ""
        self.position: Vec3 = (0.0, 0.0, 0.0)

    def state(self) -> ThingState:
        """Its true state now."""
        return ThingState(
            id=self.id, kind=self.kind, position=self.position, support=self.support, held_by=self.held_by
        )
