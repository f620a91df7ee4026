"""The composer task of a house: arena, props, doors and bodies in one model."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from hthor import catalog, rules
from hthor.types import BodySpec, HouseSpec, Joint, Vec3
from hthor.world.model import door_geometry, geoms
from hthor.world.model.arena import HouseArena
from hthor.world.model.bodies.bodies import Body
from hthor.world.model.composer_env import QPose
from hthor.world.model.door_geometry import Openable
from hthor.world.model.engine import Entity, mjcf, mujoco
from hthor.world.model.inventory import Contents, MovableSpec
from hthor.world.model.trial_control import ControlledTask

PHYSICS_STEP_S = 0.02
"""[s] The longest step at which everything on a table falls asleep (with a sleep tolerance of 5e-3)."""
_CONTACT_TIME_CONSTANT_S = 0.001
"""[s] Time constant of contacts; the engine raises it to two steps, so it affects only fast things (short steps)."""
_CONTACT_IMPEDANCE = (0.95, 0.99)
"""Impedance of contacts, lightly and firmly pressed: resting things overlap by a millimetre at most."""
_ROTATION_DAMPING_NMS = 1e-5
"""[N m s] Damping of rotations by the air."""
_PARK: Vec3 = (-500.0, 0.0, 1.0)
_PARK_STEP_M = 2.0

GRIP = {"friction": (0.8, 0.01, 0.001)}
"""Sliding, torsional [m] and rolling [m] friction of flat things, as MuJoCo counts them; our choice."""
ROLLING = {"friction": (0.8, 0.01, 0.003), "condim": 6}
"""Friction of round things: the rolling friction lets balls and cups come to rest."""
THIN_M = 0.006
"""[m] Thinner parts, such as a key or a screen, are only drawn: objects that fall on them would rest inside them."""

_MASS_KG = 4.0
"""[kg] Mass of all moving parts of one joint; our choice."""
_STIFF = {"damping": 50.0, "frictionloss": 500.0, "armature": 1000.0}
"""So stiff that objects that hit a door or drawer do not move it; only hands do."""


class Door(Entity):
    """The moving parts of a thing that opens; the rest of the thing is part of the arena.

    Its frame is the thing's local frame. ``joints`` are its `hthor.types.Joint` records in order, ``elements`` the
    engine's joints for them: 0 is closed, ``travel`` is open. A doorway's door is open in the model's initial pose, so
    that it needs no change when an episode begins.
    """

    def _build(self, opens: Openable) -> None:
        self.id, self.opens, self.thing, self.joints = opens.id, opens, opens.thing, opens.joints
        self._root = mjcf.RootElement(model=f"door|{opens.id.replace('/', '|')}")
        self.leaves = tuple(self._leaf(joint) for joint in self.joints)
        self.elements = tuple(leaf.joint[0] for leaf in self.leaves)

    def _leaf(self, joint: Joint) -> mjcf.Element:
        start = joint.travel if self.opens.opening is not None else 0.0
        leaf = self._root.worldbody.add("body", name=joint.name, gravcomp=1.0, **_leaf_frame(joint, start))
        back = (-joint.anchor[0], -joint.anchor[1], -joint.anchor[2])
        parts = [part for part in self.opens.parts if part.moves == joint.name]
        for index, part in enumerate(parts):
            mass = _MASS_KG / len(parts)
            bits = geoms.LEAF if joint.kind == "hinge" else geoms.STATIC
            geoms.add_part(leaf, f"{joint.name}:{index}", part, back, mass=mass, group=geoms.FURNITURE, **bits)
        leaf.add("joint", name=joint.name, type=joint.kind, axis=joint.axis, ref=start, **_STIFF)
        return leaf

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        return self._root


def _leaf_frame(joint: Joint, start: float) -> dict[str, object]:
    """The frame of a moving part: of a hinged door turned by ``start`` [rad], or closed."""
    turn = geoms.quaternion(start * joint.axis[2]) if joint.kind == "hinge" and start else (1.0, 0.0, 0.0, 0.0)
    return {"pos": joint.anchor, "quat": turn}


class Prop(Entity):
    """An object that can be carried; the origin of its frame is the centre of its bounding box."""

    def _build(self, item: MovableSpec) -> None:
        self.id, self.mass = item.id, item.mass
        self._root = mjcf.RootElement(model=f"object|{item.id.replace('/', '|')}")
        parts = catalog.kind(item.kind).parts(item.size, item.variant)
        total = sum(geoms.volume(part) for part in parts)
        for index, part in enumerate(parts):
            surface = GRIP if part.shape == "box" else ROLLING
            share = self.mass * geoms.volume(part) / total
            bits = geoms.GHOST if len(parts) > 1 and 2 * min(part.half) < THIN_M else geoms.MOVABLE
            name = f"part:{index}"
            geoms.add_part(self._root.worldbody, name, part, mass=share, group=geoms.OBJECTS, **surface, **bits)

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        return self._root


class HouseTask(ControlledTask):
    """The whole house in one model, compiled once; an episode only writes poses.

    Attributes:
        props, doors, bodies: the entities, with the attributes that their classes document.
        starts: object id -> (position [m], yaw [rad]) at the next reset; other objects start where the house has them,
            or are parked outside the house.
    """

    def __init__(self, house: HouseSpec, contents: Contents, seats: Mapping[str, BodySpec]) -> None:
        super().__init__()
        self._arena = HouseArena(house, contents.statics)
        self.props = tuple(Prop(item) for item in contents.movables)
        opening = (
            *(door_geometry.openable_thing(thing) for thing in contents.doors),
            *door_geometry.doorway_leaves(house),
        )
        self.doors = tuple(Door(one) for one in opening)
        self.bodies = tuple(Body(seat, spec) for seat, spec in seats.items())
        self.starts: dict[str, tuple[Vec3, float]] = {}
        homes = [
            self.parking(number) if item.home is None else _pose(item.home, item.yaw)
            for number, item in enumerate(contents.movables)
        ]
        self._homes = np.array(homes).reshape(-1, 7)
        for index, prop in enumerate(self.props):
            self._arena.add_free_entity(prop).pos = self.parking(index)[:3]
        for door in self.doors:
            frame = self._arena.attach(door)
            frame.pos, frame.quat = door.thing.centre, geoms.quaternion(door.thing.yaw)
        for body in self.bodies:
            self._arena.attach(body).mocap = "true"
        self.set_timesteps(control_timestep=rules.TICK_S, physics_timestep=PHYSICS_STEP_S)

    @property
    def root_entity(self) -> HouseArena:
        return self._arena

    @staticmethod
    def parking(index: int) -> QPose:
        """The pose at which the object with number ``index`` is kept while it is not in the episode."""
        return _pose((_PARK[0] - _PARK_STEP_M * index, _PARK[1], _PARK[2]), 0.0)

    def after_compile(self, physics: Any, random_state: Any) -> None:  # noqa: ARG002
        """Let everything start asleep, which composer's frames cannot express in the model."""
        policy = physics.model.ptr.tree_sleep_policy
        allowed, start = mujoco.mjtSleepPolicy.mjSLEEP_AUTO_ALLOWED, mujoco.mjtSleepPolicy.mjSLEEP_INIT
        policy[policy == int(allowed)] = int(start)
        model = physics.model.ptr
        model.geom_solref[:, 0], model.geom_solimp[:, :2] = _CONTACT_TIME_CONSTANT_S, _CONTACT_IMPEDANCE
        free = model.jnt_dofadr[model.jnt_type == int(mujoco.mjtJoint.mjJNT_FREE)]
        model.dof_damping[free[:, None] + np.arange(3, 6)] = _ROTATION_DAMPING_NMS
        bodies = [physics.bind(prop.root_body).element_id for prop in self.props]
        first = np.array([model.jnt_qposadr[model.body_jntadr[body]] for body in bodies], int)
        self._addresses = first[:, None] + np.arange(7)
        self._numbers = {prop.id: number for number, prop in enumerate(self.props)}

    def initialize_episode(self, physics: Any, random_state: Any) -> None:  # noqa: ARG002
        """Make the starting poses the model's initial poses, so that a plain reset puts everything there, asleep."""
        model, data = physics.model.ptr, physics.data.ptr
        model.qpos0[self._addresses] = self._homes
        for id, (position, yaw) in self.starts.items():
            model.qpos0[self._addresses[self._numbers[id]]] = _pose(position, yaw)
        mujoco.mj_resetData(model, data)


def _pose(position: Vec3, yaw: float) -> QPose:
    return (*position, *geoms.quaternion(yaw))
