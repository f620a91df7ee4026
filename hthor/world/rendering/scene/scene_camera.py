"""Cameras of the drawn scene: a seat's eye and the view from above."""

from typing import Any

from hthor.types import BodySpec, Pose, Vec2
from hthor.world.perception import view_frustum

NEAR_M, FAR_M = 0.02, 120.0
ABOVE_M = 20.0


def place_at_eye(camera: Any, pose: Pose, spec: BodySpec, lens: Vec2) -> None:
    """Put the camera where the body's eye is; ``lens`` are the tangents of half its fields of view."""
    view = view_frustum.view_vector(pose, spec)
    camera.pos, camera.forward, camera.up = view[:3], view[3:6], view[9:12]
    camera.orthographic, camera.frustum_center = 0, 0.0
    camera.frustum_near, camera.frustum_far = NEAR_M, FAR_M
    top = NEAR_M * lens[1]
    camera.frustum_bottom, camera.frustum_top = -top, top
    camera.frustum_width = NEAR_M * lens[0]


def place_above(camera: Any, bounds: tuple[float, float, float, float]) -> None:
    """Look straight down on the area x0, y0, x1, y1 [m], north up."""
    x0, y0, x1, y1 = bounds
    camera.pos, camera.forward, camera.up = ((x0 + x1) / 2, (y0 + y1) / 2, ABOVE_M), (0, 0, -1), (0, 1, 0)
    camera.orthographic = 1
    camera.frustum_center, camera.frustum_width = 0.0, (x1 - x0) / 2
    camera.frustum_bottom, camera.frustum_top = -(y1 - y0) / 2, (y1 - y0) / 2
    camera.frustum_near, camera.frustum_far = NEAR_M, FAR_M
