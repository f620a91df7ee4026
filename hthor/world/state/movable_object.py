"""The state of one movable object in an episode."""

import math
from collections.abc import Sequence
from typing import Any

from hthor.geometry.plane import wrap
from hthor.types import ThingState, Vec3
from hthor.world.model.inventory import MovableSpec

ABSENT_POSITION: Vec3 = (-500.0, 0.0, 0.0)
"""[m] The position reported for objects that are not in the episode."""


class MovableObject:
    """One object. ``present`` is false if the object is not in this episode.

    ``held_by`` is the seat that has it in hand, ``bearers`` all seats that hold it by a handle, lifted or not.
    ``number`` is its row in `Objects.positions`.
    """

    def __init__(self, movable: MovableSpec, number: int, model: Any, span: tuple[int, int]) -> None:
        self.id, self.kind, self.size, self.mass = movable.id, movable.kind, movable.size, movable.mass
        self.number, self.clutter = number, movable.clutter
        body = model.geom_bodyid[span[0]]
        joint = model.body_jntadr[body]
        self.qpos, self.dof = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        self.tree = int(model.body_treeid[body])
        self.geoms = slice(*span)
        self.clear()

    def clear(self) -> None:
        """Take the object out of the episode."""
        self.present, self.held_by, self.support = False, "", ""
        self.bearers: tuple[str, ...] = ()
        self.position, self.yaw = ABSENT_POSITION, 0.0
        self._state: ThingState | None = None

    def at(self, qpos: Sequence[float]) -> None:
        """Set position and heading from a pose (x, y, z, quaternion)."""
        x, y, z, w, _, _, k = qpos
        self.position, self.yaw = (x, y, z), wrap(2.0 * math.atan2(k, w))
        self._state = None

    def state(self) -> ThingState:
        """The object's true state now; the same record until it changes."""
        known = self._state
        if known is None or known.support != self.support or known.held_by != self.held_by:
            self._state = known = ThingState(
                id=self.id,
                kind=self.kind,
                position=self.position,
                support=self.support,
                held_by=self.held_by,
                bearers=self.bearers,
            )
        return known
