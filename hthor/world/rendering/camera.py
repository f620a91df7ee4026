"""Pose and projection of cameras, as records and as vectors for the rasterizer; this module draws nothing."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hthor.types import BodySpec, Camera, CameraSpec, Pose, Vec2
from hthor.world import numbers
from hthor.world.model import geoms
from hthor.world.model.engine import mujoco
from hthor.world.perception import view_frustum

OWN = CameraSpec()
SIDE, _ROUND = 128, 8
NEAR_M, FAR_M = 0.02, 80.0
"""[m] Nothing nearer or farther is in a picture."""
_UP_M = 1.0e5
"""[m] Height of a camera whose rays are nearly parallel: within a house they diverge by less than 0.01 mm."""

FAR_AWAY = (0.0, 0.0, -100.0)
"""[m] Where the viewer's own body is put while a picture is taken from its eye."""


class Images(NamedTuple):
    """A camera's pictures at one moment, all (H, W): colours with 3 channels, depth [m], numbers of owners."""

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    segmentation: NDArray[np.int32]


def image_size(spec: BodySpec, chosen: CameraSpec = OWN) -> tuple[int, int]:
    """Width and height [pixels] of the pictures that a camera takes unless a call gives another size.

    By default, a body's pictures have the shape of its field of view, about as many pixels as a square of `SIDE`, and
    sides that are multiples of `_ROUND`.
    """
    if chosen.size is not None:
        return chosen.size
    wide, high = view_frustum.half_fov_tangents(spec)
    width, height = (_ROUND * max(1, round(SIDE * stretch / _ROUND)) for stretch in _stretch(wide / high))
    return width, height


def image_tangents(spec: BodySpec, size: tuple[int, int], chosen: CameraSpec = OWN) -> Vec2:
    """Tangents of half the fields of view, horizontal and vertical, of pictures of ``size`` (width, height) [pixels].

    Pixels are square for every size. With the body's own field of view, a picture of another shape shows the middle of
    that field. With another camera's, a picture shows that camera's whole horizontal field of view.
    """
    wide, high = view_frustum.half_fov_tangents(spec)
    width, height = size
    pixel = 2.0 * math.tan(chosen.fov / 2) / width if chosen.fov else 2.0 * min(wide / width, high / height)
    return pixel * width / 2, pixel * height / 2


def camera_record(pose: Pose, spec: BodySpec, size: tuple[int, int], chosen: CameraSpec = OWN) -> Camera:
    """The camera of a body at a pose, for pictures of ``size`` (width, height) [pixels]."""
    view = view_frustum.view_vector(pose, spec)
    width, height = size
    wide, high = image_tangents(spec, size, chosen)
    matrix = np.array(
        (
            (width / (2.0 * wide), 0.0, (width - 1) / 2.0),
            (0.0, height / (2.0 * high), (height - 1) / 2.0),
            (0.0, 0.0, 1.0),
        )
    )
    place = np.eye(4)
    place[:3, 0], place[:3, 1], place[:3, 2], place[:3, 3] = -view[6:9], -view[9:12], view[3:6], view[:3]
    return Camera(size=size, matrix=matrix, pose=place, near=NEAR_M, far=FAR_M)


def projection_vector(pose: Pose, spec: BodySpec, size: tuple[int, int], chosen: CameraSpec = OWN) -> Any:
    """(16,) float64, a body's camera as `hthor.world.rendering.rasterizer.fill` takes it, for pictures of ``size``."""
    return np.concatenate(
        (view_frustum.view_vector(pose, spec)[:12], image_tangents(spec, size, chosen), (NEAR_M, FAR_M))
    )


def top_view_vector(bounds: tuple[float, float, float, float]) -> Any:
    """(16,) float64 for `hthor.world.rendering.rasterizer.fill`: a camera above x0, y0, x1, y1 [m], north up."""
    x0, y0, x1, y1 = bounds
    eye = ((x0 + x1) / 2, (y0 + y1) / 2, _UP_M)
    tangents = ((x1 - x0) / 2 / _UP_M, (y1 - y0) / 2 / _UP_M)
    return np.array((*eye, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0, *tangents, NEAR_M, 2.0 * _UP_M))


def check_size(size: tuple[int, int]) -> None:
    """Raise ValueError unless ``size`` is a width and a height of 1 to 4096 pixels."""
    try:
        width, height = size
        sides = (width, height)
        whole = all(isinstance(side, (int, np.integer)) and not isinstance(side, bool) for side in sides)
        fits = whole and all(1 <= side <= 4096 for side in sides)
    except (TypeError, ValueError):
        fits = False
    if not fits:
        given = numbers.quoted(size)
        raise ValueError(
            f"size must be (width, height) in whole pixels, 1 to 4096 each, such as (128, 128); got {given}"
        )


def _stretch(shape: float) -> Vec2:
    """Width and height of a rectangle of area 1 whose width over height is ``shape``."""
    return math.sqrt(shape), math.sqrt(1.0 / shape)


class PoseSnapshot(NamedTuple):
    """All poses at one moment: the engine's ``qpos``, and each seat's pose and body, in the order of the seats."""

    qpos: Any
    seats: Mapping[str, tuple[Pose, BodySpec]]

    def restore(self, model: Any, data: Any, without: str = "") -> None:
        """Write these poses to ``data``, a copy that is never stepped, with the body ``without`` far away."""
        data.qpos[:] = self.qpos
        for index, (name, (pose, _)) in enumerate(self.seats.items()):
            data.mocap_pos[index] = FAR_AWAY if name == without else (pose.x, pose.y, 0.0)
            data.mocap_quat[index] = geoms.quaternion(pose.yaw)
        mujoco.mj_kinematics(model, data)
