"""Pictures of a world; they need an OpenGL back end and are skipped, with its complaint, where there is none."""

from __future__ import annotations

import math

import numpy as np
import pytest
import world_house as tiny
from world_house import COFFEE, TABLE, do, on, task

from hthor.errors import RenderingUnavailable
from hthor.types import Pose, Rotate
from hthor.world import World, opengl


@pytest.fixture(scope="module")
def world() -> World:
    world = World(tiny.house(), robots=("scout",))
    world.reset(task(on(TABLE, "apple"), on(COFFEE, "lettuce")))
    try:
        world.picture("human")
    except RenderingUnavailable as error:
        pytest.skip(str(error))
    return world


@pytest.fixture(autouse=True)
def _again(world: World) -> None:
    robot = Pose(x=6.2, y=2.0, yaw=math.pi)
    human = Pose(x=4.0, y=2.0, yaw=math.atan2(0.6, -1.5), pitch=-0.3)
    world.reset(task(on(TABLE, "apple"), on(COFFEE, "lettuce"), human=human, robots=(robot,)))


def test_the_three_pictures_fit_together(world: World) -> None:
    senses = world.senses("human")
    rgb, depth, owner = senses.rgb(), senses.depth(), senses.segmentation()
    assert (rgb.shape, rgb.dtype) == ((128, 128, 3), np.uint8)
    assert (depth.shape, depth.dtype) == ((128, 128), np.float32)
    assert (owner.shape, owner.dtype) == ((128, 128), np.int32)
    apple = owner == world.names.index("apple")
    assert apple.sum() >= 4
    _, columns = np.nonzero(apple)
    assert abs(columns.mean() - 64) < 3  # the camera looks towards it
    ahead = math.dist((4.0, 2.0, 1.6), (2.5, 2.6, 0.78))
    assert depth[apple].mean() == pytest.approx(ahead, abs=0.15)
    red, green, _ = rgb[apple].astype(int).T
    assert (red > green + 40).mean() > 0.8
    assert set(np.unique(owner)) <= set(range(-1, len(world.names)))


def test_a_body_is_not_in_its_own_picture_but_in_others(world: World) -> None:
    names = world.names
    assert names.index("human") not in world.picture("human", "segmentation")
    assert names.index("human") in world.picture("robot", "segmentation")


def test_what_is_drawn_is_what_is_detected(world: World) -> None:
    drawn = {world.names[index] for index in np.unique(world.picture("human", "segmentation")) if index >= 0}
    for detection in world.senses("human").detections():
        assert detection.family == "doorway" or detection.id in drawn


def test_a_frame_is_of_its_moment(world: World) -> None:
    now = world.picture("human", size=(64, 48))
    assert now.shape == (48, 64, 3)
    frame = world.frame("human", size=(64, 48))
    do(world, "human", Rotate(yaw=1.5))
    assert not np.array_equal(world.picture("human", size=(64, 48)), now)
    assert np.array_equal(frame(), now)


def test_drawing_leaves_the_world_alone(world: World) -> None:
    before = world.snapshot(), world._env.data.qpos.copy()
    world.top_view()
    world.picture("robot", "depth")
    assert world.snapshot() == before[0]
    assert np.array_equal(world._env.data.qpos, before[1])


def test_the_top_view_is_to_scale(world: World) -> None:
    x0, y0, x1, y1 = world.top_view_bounds
    image = world.top_view(pixels_per_metre=40.0)
    assert image.shape == (round((y1 - y0) * 40), round((x1 - x0) * 40), 3)

    def pixel(x: float, y: float) -> list[int]:
        return image[int((y1 - y) * 40), int((x - x0) * 40)].tolist()

    red, green, blue = pixel(7.5, 1.9)  # the lettuce
    assert green > red > blue
    red, green, blue = pixel(9.0, 2.7)  # the bed's blanket
    assert blue > red
    assert pixel(1.5, 1.5) != pixel(6.0, 3.0)  # two floors


def test_without_any_back_end_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(name: str, width: int, height: int) -> None:
        raise ImportError(f"no lib{name}")

    monkeypatch.setattr(opengl, "_open", fail)
    monkeypatch.setattr(opengl, "_forget", lambda: None)
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    with pytest.raises(RenderingUnavailable, match=r"egl: no libegl; osmesa: no libosmesa; glfw.*libegl1"):
        opengl.context(8, 8)


def test_wrong_modes_are_named(world: World) -> None:
    with pytest.raises(ValueError, match="rgb, depth, segmentation"):
        world.picture("human", "normals")
