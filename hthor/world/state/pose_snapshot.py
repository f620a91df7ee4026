"""The poses that a picture of one moment needs, cheap enough to be kept with every message."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from hthor.types import BodySpec, Pose
from hthor.world.model import geoms
from hthor.world.model.engine import mujoco

FAR_AWAY = (0.0, 0.0, -100.0)
"""[m] Where a viewer's own body is put while a picture is taken through its eyes."""


class PoseSnapshot(NamedTuple):
    """``qpos``: the engine's positions. ``seats``: each seat's pose and body, in the order of the seats."""

    qpos: Any
    seats: Mapping[str, tuple[Pose, BodySpec]]

    def restore(self, model: Any, data: Any, without: str = "") -> None:
        """Set ``data``, a copy that is never stepped, to these poses, with the body ``without`` far away."""
        data.qpos[:] = self.qpos
        for index, (name, (pose, _)) in enumerate(self.seats.items()):
            data.mocap_pos[index] = FAR_AWAY if name == without else (pose.x, pose.y, 0.0)
            data.mocap_quat[index] = geoms.quaternion(pose.yaw)
        mujoco.mj_kinematics(model, data)
