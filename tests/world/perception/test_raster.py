"""The tracer's pictures against the engine's own rays: the same solid in every pixel, at the same depth."""

from __future__ import annotations

import math

import numpy as np
import pytest
import world_house as tiny
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from law_cases import cases
from world_house import COFFEE, TABLE, on, task

from hthor.types import Pose
from hthor.world import World
from hthor.world.model.engine import mujoco
from hthor.world.rendering import camera, rasterizer, ray_renderer

SIZE = (48, 36)


def rays(model, data, view, size, groups=6):
    """Geoms (H, W) and depths (H, W) [m] by `mj_ray` through the centre of every pixel; -1 for nothing."""
    width, height = size
    xs = ((np.arange(width) + 0.5) / width * 2 - 1) * view[12]
    ys = (1 - (np.arange(height) + 0.5) / height * 2) * view[13]
    x, y = np.meshgrid(xs, ys)
    along = view[3:6] - x[..., None] * view[6:9] + y[..., None] * view[9:12]
    length = np.linalg.norm(along, axis=-1)
    geom, far, one = np.zeros((height, width), np.int32), np.zeros((height, width)), np.zeros(1, np.int32)
    shown = np.array([index < groups for index in range(6)], np.uint8)
    eye, unit = view[:3].copy(), along / length[..., None]
    for pixel in np.ndindex(height, width):  # one by one: `mj_multiRay` overlooks what is close to the eye
        far[pixel] = mujoco.mj_ray(model, data, eye, unit[pixel], shown, 1, -1, one, None)
        geom[pixel] = one[0]
    depth = far / length
    missed = (geom < 0) | (depth > view[15])
    return np.where(missed, -1, geom), np.where(missed, view[15], depth)


def agree(model, data, view, hit, w, groups=6):
    """Assert that traced pixels are the rays', but for a few on edges; depths agree where both see the same solid."""
    geom, depth = rays(model, data, view, (w.shape[1], w.shape[0]), groups)
    same, off = (hit >> 3) == geom, np.abs(1.0 / w - depth)
    right = same | (off < 1e-9)  # where two solids meet in one point, either will do
    assert right.mean() >= 0.995, f"{(~right).sum()} of {right.size} pixels differ"
    assert off[same].max(initial=0.0) < 1e-3


@pytest.fixture(scope="module")
def world() -> World:
    world = World(tiny.house(), robots=("scout",))
    world.reset(task(on(TABLE, "apple"), on(TABLE, "mug", u=0.4), on(COFFEE, "lettuce"), human=Pose(x=4.0, y=2.0)))
    return world


@settings(max_examples=cases(25))
@given(x=st.floats(0.4, 9.6), y=st.floats(0.3, 3.7), yaw=st.floats(-3.14, 3.14), pitch=st.floats(-0.5, 0.5))
def test_a_house_is_traced_as_the_engine_s_rays_see_it(
    world: World, x: float, y: float, yaw: float, pitch: float
) -> None:
    world.parts.seats["robot"].pose = Pose(x=x, y=y, yaw=yaw, pitch=pitch)
    drawn = ray_renderer.RayRenderer(world.model, world.parts.geoms, world.house)
    view, w, hit = drawn._fill(world.pictures._images.moment(), "robot", SIZE, camera.OWN)
    offset = np.abs(np.einsum("nji,nj->ni", drawn._mat.reshape(-1, 3, 3), view[:3] - drawn._pos))
    assume(not (offset < drawn._half + 0.05).all(axis=1).any())  # what is inside or nearer than NEAR_M is not seen
    model = drawn._model
    model.geom_rgba[drawn._glass, 3] = 0.0  # what rays pass through
    agree(model, drawn._data, view, hit, w, groups=5)


SHAPES = """
<mujoco><worldbody>
  <geom type="plane" size="3 2 1" pos="0 0 -0.6" euler="6 3 20"/>
  <geom type="sphere" size="0.3" pos="1.5 -0.6 0"/>
  <geom type="box" size="0.2 0.3 0.25" pos="2 0.5 0" euler="20 30 40"/>
  <geom type="cylinder" size="0.2 0.35" pos="1.6 0 0.1" euler="50 10 0"/>
  <geom type="capsule" size="0.12 0.3" pos="1.9 -0.2 -0.4" euler="80 0 30"/>
  <geom type="ellipsoid" size="0.35 0.15 0.2" pos="1.4 0.2 -0.35" euler="10 20 30"/>
  <geom type="cylinder" size="0.3 0.02" pos="1.2 0.3 0.45"/>
  <geom type="box" size="4 0.05 0.05" pos="0.2 0.6 -0.2" euler="0 0 3"/>
</worldbody></mujoco>
"""


@settings(max_examples=cases(40))
@given(
    x=st.floats(-1.0, 0.9),
    y=st.floats(-0.4, 0.4),
    z=st.floats(-0.3, 1.0),
    yaw=st.floats(-0.6, 0.6),
    pitch=st.floats(-0.6, 0.3),
    tall=st.floats(0.3, 1.2),
)
def test_every_shape_is_traced_as_the_engine_s_rays_see_it(
    x: float, y: float, z: float, yaw: float, pitch: float, tall: float
) -> None:
    model = mujoco.MjModel.from_xml_string(SHAPES)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    cy, sy, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    axes = (cp * cy, cp * sy, sp, -sy, cy, 0.0, -sp * cy, -sp * sy, cp)
    view = np.array((x, y, z, *axes, 0.8, tall, camera.NEAR_M, camera.FAR_M))
    half = ray_renderer._halves(model)
    radius = np.linalg.norm(half, axis=1)
    w, hit = ray_renderer._blank(view, (64, 48))
    order = np.argsort(-radius, kind="stable")
    rasterizer.fill(
        view, order, np.array(model.geom_type), half, radius, data.geom_xpos, data.geom_xmat.reshape(-1, 9), w, hit
    )
    agree(model, data, view, hit, w)


def test_a_picture_is_the_same_every_time(world: World) -> None:
    world.parts.seats["robot"].pose = Pose(x=4.0, y=1.2, yaw=2.4)
    first, second = world.look("robot"), world.look("robot")
    assert np.array_equal(first.rgb, second.rgb)
    assert np.array_equal(first.depth, second.depth)
    again = World(tiny.house(), robots=("scout",))
    again.reset(task(on(TABLE, "apple"), on(TABLE, "mug", u=0.4), on(COFFEE, "lettuce"), human=Pose(x=4.0, y=2.0)))
    again.parts.seats["robot"].pose = Pose(x=4.0, y=1.2, yaw=2.4)
    assert np.array_equal(again.look("robot").rgb, first.rgb)


def test_one_glance_is_the_three_pictures(world: World) -> None:
    view = world.look("robot", (64, 40))
    for mode in ("rgb", "depth", "segmentation"):
        picture = world.picture("robot", mode, (64, 40))
        assert picture.shape[:2] == (40, 64)
        assert np.array_equal(getattr(view, mode), picture)
