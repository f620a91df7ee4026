"""A detection says that the place of a thing is in view, which the pictures of the same moment confirm."""

from __future__ import annotations

import numpy as np
import pytest

from hthor.types import Detection, Pose, View
from hthor.world import World
from hthor.world.rendering import camera

MARGIN_M = 0.03
"""Points at which visibility is tested are up to 2 cm outside the box of a thing."""


def place_in_view(view: View, found: Detection) -> bool:
    """Whether any pixel's ray gets to the box of a detection before it gets to what the pixel shows."""
    height, width = view.depth.shape
    rows, columns = np.mgrid[0:height, 0:width]
    flat = np.linalg.inv(view.camera.matrix) @ np.stack((columns.ravel(), rows.ravel(), np.ones(width * height)))
    rays, eye = (view.camera.pose[:3, :3] @ flat).T, view.camera.pose[:3, 3] - found.position
    cos, sin = np.cos(found.yaw), np.sin(found.yaw)
    frame = np.array(((cos, sin, 0.0), (-sin, cos, 0.0), (0.0, 0.0, 1.0)))
    half = np.array(found.size) / 2 + MARGIN_M
    with np.errstate(divide="ignore", invalid="ignore"):
        first, second = (-half - frame @ eye) / (rays @ frame.T), (half - frame @ eye) / (rays @ frame.T)
    near, far = np.fmin(first, second).max(axis=1), np.fmax(first, second).min(axis=1)
    return bool(((near <= far) & (far > 0.0) & (view.depth.ravel() >= near - 1e-3)).any())


def unseen(scene: str, poses: int) -> list[tuple[str, str, Pose]]:
    """The detections from random free poses whose place is neither in the picture nor in one four times as fine."""
    world, rng, found = World(scene, robots=["tender"]), np.random.default_rng(len(scene)), []
    x0, y0, x1, y1 = world.top_view_bounds
    for number in range(poses):
        seat, other = ("human", "robot")[:: 1 if number % 2 else -1]
        place = world.space[seat].nearest_free(float(rng.uniform(x0, x1)), float(rng.uniform(y0, y1)))
        pose = Pose(x=place[0], y=place[1], yaw=float(rng.uniform(-3.1, 3.1)), pitch=float(rng.uniform(-0.5, 0.4)))
        world.parts.seats[other].pose = Pose(x=-1e3, y=-1e3)  # bodies hide nothing from detectors, but do in pictures
        world.parts.seats[seat].pose = pose
        world.parts.mocap.rewrite()
        view, (width, height) = world.look(seat), camera.image_size(world.bodies[seat])
        for one in world.detections(seat):
            if not place_in_view(view, one) and not place_in_view(world.look(seat, (4 * width, 4 * height)), one):
                found.append((seat, one.id, pose))
    return found


@pytest.mark.parametrize("scene", ["elder", "willow"])
def test_the_place_of_whatever_is_detected_is_in_view(scene: str) -> None:
    assert unseen(scene, 60) == []


@pytest.mark.nightly  # at each commit, the test above does it in two scenes
@pytest.mark.parametrize("scene", World.scenes())
def test_the_place_of_whatever_is_detected_is_in_view_in_all_scenes(scene: str) -> None:
    assert unseen(scene, 400) == []
