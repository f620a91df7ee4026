"""Poses of everything that moves, computed on a private copy of the physics model.

The *rest* pose of a moving body is its pose with every door and drawer closed; meshes are attached in that pose.
"""

import copy
import math
from typing import Any

import numpy as np

from hthor.types import BodySpec, Pose, Vec3
from hthor.world.model import geoms
from hthor.world.model.bodies import bodies
from hthor.world.model.engine import mujoco
from hthor.world.model.geom_index import GeomIndex
from hthor.world.model.geoms import Quaternion


class PoseSync:
    """Poses of the physics model's moving bodies, by owner.

    Attributes:
        free: id of each movable object -> its body.
        hung: (id of a thing or opening, joint's name) -> the body that the joint moves.
    """

    def __init__(self, model: Any, scene: GeomIndex) -> None:
        self._model = copy.copy(model)
        self._model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
        self._data = mujoco.MjData(self._model)
        self._data.qpos[:] = np.nan  # no pose is computed yet
        self.free: dict[str, int] = {}
        self.hung: dict[tuple[str, str], int] = {}
        owners: dict[int, str] = {}
        for geom, owner in enumerate(scene.owner):
            owners.setdefault(int(model.geom_bodyid[geom]), owner)
        rest = np.array(model.qpos0)
        for joint in range(model.njnt):
            body = int(model.jnt_bodyid[joint])
            if model.jnt_type[joint] == int(mujoco.mjtJoint.mjJNT_FREE):
                self._note_free(model, body, owners)
                continue
            name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, joint).rpartition("/")[2]
            if body in owners:
                self.hung[owners[body], name] = body
            rest[model.jnt_qposadr[joint]] = 0.0
        position, turn = self.at(rest)
        self._rest = position.copy(), turn.copy()

    def _note_free(self, model: Any, body: int, owners: dict[int, str]) -> None:
        for inner in range(body, model.nbody):
            if inner in owners and model.body_rootid[inner] == model.body_rootid[body]:
                self.free[owners[inner]] = inner
                return

    def at(self, qpos: Any) -> tuple[Any, Any]:
        """Positions (B, 3) and quaternions (B, 4) of all bodies for the engine's ``qpos``."""
        if not np.array_equal(qpos, self._data.qpos):  # mostly only people and robots move
            self._data.qpos[:] = qpos
            mujoco.mj_kinematics(self._model, self._data)
        return self._data.xpos, self._data.xquat

    def rest(self, body: int) -> tuple[Any, Any]:
        """The position (3,) and the quaternion (4,) of ``body`` at rest."""
        return self._rest[0][body], self._rest[1][body]

    def relative(self, body: int, frame: tuple[Vec3, Quaternion]) -> tuple[Vec3, Quaternion]:
        """A frame given in the house frame, relative to ``body`` at rest."""
        position, turn = self.rest(body)
        back, quat, pos = np.empty(4), np.empty(4), np.empty(3)
        mujoco.mju_negQuat(back, turn)
        mujoco.mju_mulQuat(quat, back, np.array(frame[1]))
        mujoco.mju_rotVecQuat(pos, np.array(frame[0]) - position, back)
        (x, y, z), (w, i, j, k) = pos.tolist(), quat.tolist()
        return (x, y, z), (w, i, j, k)


def seat_frames(pose: Pose, spec: BodySpec) -> tuple[tuple[Vec3, Quaternion], tuple[Vec3, Quaternion]]:
    """The frames of a seat's two puppets, its body and its head, at a pose."""
    turn, shift = bodies.head_transform(spec, pose.pitch, pose.head or 0.0)
    about, cos, sin = geoms.quaternion(pose.yaw), math.cos(pose.yaw), math.sin(pose.yaw)
    x, y, z = shift
    tilt, head = np.empty(4), np.empty(4)
    mujoco.mju_mat2Quat(tilt, np.asarray(turn, float).ravel())
    mujoco.mju_mulQuat(head, np.array(about), tilt)
    w, i, j, k = head.tolist()
    return ((pose.x, pose.y, 0.0), about), ((pose.x + cos * x - sin * y, pose.y + sin * x + cos * y, z), (w, i, j, k))
