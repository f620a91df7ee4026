"""The composer task of a house: arena, props, doors and bodies in one model; knows nothing of goals or time limits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from hthor import rules
from hthor.types import BodySpec, HouseSpec, Vec3
from hthor.world import geoms
from hthor.world.arena import HouseArena
from hthor.world.bodies import Body
from hthor.world.contents import Contents
from hthor.world.engine import composer, mujoco
from hthor.world.openables import Door
from hthor.world.props import Prop

PHYSICS_STEP_S = 0.02
"""The longest step at which everything on a table falls asleep (with a sleep tolerance of 5e-3)."""
_PARK: Vec3 = (-500.0, 0.0, 1.0)
_PARK_STEP_M = 2.0


class HouseTask(composer.Task):
    """Everything in one model, compiled once; an episode only writes poses.

    Attributes:
        props, doors, bodies: the entities, each with the attributes its class documents.
        starts: object id -> (position [m], yaw [rad]) at the next reset; what is missing is parked out of the world.
    """

    def __init__(self, house: HouseSpec, contents: Contents, seats: Mapping[str, BodySpec]) -> None:
        self._arena = HouseArena(house, contents.statics)
        self.props = tuple(Prop(item.id, item.kind, item.size) for item in contents.movables)
        self.doors = tuple(Door(thing) for thing in contents.doors)
        self.bodies = tuple(Body(seat, spec) for seat, spec in seats.items())
        self.starts: dict[str, tuple[Vec3, float]] = {}
        for index, prop in enumerate(self.props):
            self._arena.add_free_entity(prop).pos = self._parking(index)
        for door in self.doors:
            frame = self._arena.attach(door)
            frame.pos, frame.quat = door.thing.centre, geoms.quaternion(door.thing.yaw)
        for body in self.bodies:
            self._arena.attach(body).mocap = "true"
        self.set_timesteps(control_timestep=rules.TICK_S, physics_timestep=PHYSICS_STEP_S)

    @property
    def root_entity(self) -> HouseArena:
        return self._arena

    def get_reward(self, physics: Any) -> float:  # noqa: ARG002 - composer's signature
        """Always zero: success is the umpire's to judge."""
        return 0.0

    @staticmethod
    def _parking(index: int) -> Vec3:
        return (_PARK[0] - _PARK_STEP_M * index, _PARK[1], _PARK[2])

    def after_compile(self, physics: Any, random_state: Any) -> None:  # noqa: ARG002
        """Let everything start asleep; composer's frames cannot say so in the model itself."""
        policy = physics.model.ptr.tree_sleep_policy
        allowed, start = mujoco.mjtSleepPolicy.mjSLEEP_AUTO_ALLOWED, mujoco.mjtSleepPolicy.mjSLEEP_INIT
        policy[policy == int(allowed)] = int(start)
        self._addresses = [physics.bind(prop.root_body).element_id for prop in self.props]

    def initialize_episode(self, physics: Any, random_state: Any) -> None:  # noqa: ARG002
        """Write the starting poses as the model's own, so that a plain reset puts everything there, asleep."""
        model, data = physics.model.ptr, physics.data.ptr
        for index, (prop, body) in enumerate(zip(self.props, self._addresses, strict=True)):
            position, yaw = self.starts.get(prop.id, (self._parking(index), 0.0))
            address = model.jnt_qposadr[model.body_jntadr[body]]
            model.qpos0[address : address + 7] = np.array([*position, *geoms.quaternion(yaw)])
        mujoco.mj_resetData(model, data)
