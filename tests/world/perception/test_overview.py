"""Overviews: a camera of no seat, with square pixels, that sees over low walls and changes nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest
import world_house as tiny
from hypothesis import given
from hypothesis import strategies as st
from world_house import TABLE, on, task

from hthor.types import Pose
from hthor.world import World
from hthor.world.rendering.ray_renderer import LOW_WALL_M
from hthor.world.rendering.viewpoint import Viewpoint

SIZE = (160, 120)
metres = st.floats(-20.0, 20.0)


@pytest.fixture(scope="module")
def world() -> World:
    made = World(tiny.house(), robots=("scout",))
    made.reset(task(on(TABLE, "apple"), human=Pose(x=8.0, y=1.2), robots=(Pose(x=6.0, y=3.0),)))
    return made


@given(st.tuples(metres, metres, st.floats(5.0, 20.0)), st.tuples(metres, metres), st.floats(0.2, 1.5))
def test_pixels_are_square_and_the_target_is_in_the_middle(eye, flat, fov: float) -> None:
    if math.dist(eye[:2], flat) < 0.5:
        return
    viewpoint = Viewpoint(eye=eye, target=(*flat, 0.0), fov=fov)
    ahead, left, up = viewpoint.axes
    assert viewpoint.axes @ viewpoint.axes.T == pytest.approx(np.eye(3), abs=1e-9)
    target = np.array(viewpoint.target)
    middle, aside, above = viewpoint.project(np.stack([target, target + 0.1 * left, target + 0.1 * up]), SIZE)[:, :2]
    assert middle == pytest.approx(((SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2), abs=1e-6)
    assert middle[0] - aside[0] == pytest.approx(middle[1] - above[1])
    assert middle[0] > aside[0], "left is left"
    top = target + math.tan(fov / 2) * float(ahead @ (target - np.array(eye))) * up
    assert viewpoint.project(top[None], SIZE)[0, 1] == pytest.approx(-0.5)


def test_what_is_projected_to_a_pixel_is_drawn_there(world: World) -> None:
    apple = world.position("apple")
    viewpoint = Viewpoint(eye=(apple[0] + 2.0, apple[1] + 1.0, 4.0), target=(apple[0], apple[1] + 0.3, 0.5))
    size = (640, 480)
    column, row, depth = viewpoint.project(np.array([apple]), size)[0]
    measured = world.overview(viewpoint, "depth", size)[round(row), round(column)]
    assert depth - 0.06 < measured < depth, "the front of the apple"
    red, green, blue = (int(part) for part in world.overview(viewpoint, "rgb", size)[round(row), round(column)])
    assert red > green + 40
    assert red > blue + 40


def test_walls_are_low_ceilings_are_away_and_nothing_is_changed(world: World) -> None:
    before = world.look("robot")
    viewpoint = Viewpoint(eye=(5.0, -6.0, 8.0), target=(5.0, 2.0, 0.0), fov=1.0)
    size = (320, 240)
    depth = world.overview(viewpoint, "depth", size)
    columns, rows = np.meshgrid(np.arange(size[0]), np.arange(size[1]))
    wide, high = viewpoint.tangents(size)
    across = (1.0 - (columns + 0.5) * 2 / size[0]) * wide
    up = (1.0 - (rows + 0.5) * 2 / size[1]) * high
    ahead, left, above = viewpoint.axes
    points = np.array(viewpoint.eye) + depth[..., None] * (ahead + across[..., None] * left + up[..., None] * above)
    walls = [wall.a for wall in world.house.walls]
    south = min(y for _, y in walls)
    at_wall = np.abs(points[..., 1] - south) < 0.15
    assert at_wall.any()
    assert points[at_wall][:, 2].max() <= LOW_WALL_M + 0.01
    assert np.array_equal(before.rgb, world.look("robot").rgb)


@pytest.mark.parametrize(("mode", "size"), [("segmentation", SIZE), ("rgb", (0, 10))])
def test_what_cannot_be_drawn_is_refused(world: World, mode: str, size: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match="must be"):
        world.overview(Viewpoint(eye=(0.0, 0.0, 5.0), target=(3.0, 3.0, 0.0)), mode, size)
