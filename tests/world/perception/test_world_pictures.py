"""Pictures of a world in the profile fast: what they show, where, at which moment; no OpenGL anywhere."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path

import msgspec
import numpy as np
import pytest
import world_house as tiny
from world_house import COFFEE, FRIDGE, TABLE, do, on, task

from hthor.errors import RenderingUnavailable
from hthor.types import Camera, Open, Pick, Pose, Rotate
from hthor.world import World
from hthor.world.model.bodies import avatar, bodies
from hthor.world.model.bodies.primitives import HEAD
from hthor.world.rendering import opengl_context

TESTS = Path(__file__).parent


@pytest.fixture(scope="module")
def world() -> World:
    return World(tiny.house(), robots=("scout",))


@pytest.fixture(autouse=True)
def _again(world: World) -> None:
    robot = Pose(x=6.2, y=2.0, yaw=math.pi)
    human = Pose(x=4.0, y=2.0, yaw=math.atan2(0.6, -1.5), pitch=-0.3)
    world.reset(task(on(TABLE, "apple"), on(COFFEE, "lettuce"), human=human, robots=(robot,)))


def project(camera: Camera, point: tuple[float, float, float]) -> tuple[float, float, float]:
    """Column, row and depth [m] of a point of the house frame."""
    x, y, z, _ = np.linalg.inv(camera.pose) @ (*point, 1.0)
    column, row, _ = camera.matrix @ (x / z, y / z, 1.0)
    return column, row, z


def lift(camera: Camera, depth: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """(N, 3) points [m] of the house frame that the marked pixels show."""
    rows, columns = np.nonzero(mask)
    flat = np.linalg.inv(camera.matrix) @ np.stack((columns, rows, np.ones(len(rows))))
    return (camera.pose @ np.vstack((flat * depth[mask], np.ones(len(rows)))))[:3].T


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


@pytest.mark.parametrize("size", [(300, 300), (320, 200), (97, 240)])
@pytest.mark.parametrize("pitch", [-0.3, -0.6])
def test_the_camera_projects_points_to_where_the_pictures_show_them(
    world: World, size: tuple[int, int], pitch: float
) -> None:
    world.parts.seats["human"].pose = Pose(x=3.4, y=1.9, yaw=math.atan2(0.7, -0.9) + 0.2, pitch=pitch)
    view, apple = world.look("human", size), (2.5, 2.6, 0.78)
    assert view.camera.size == size
    column, row, depth = project(view.camera, apple)
    assert world.names[view.segmentation[round(row), round(column)]] == "apple"
    assert depth - view.depth[round(row), round(column)] == pytest.approx(0.03, abs=0.0101)  # its near side
    mask = view.segmentation == world.names.index("apple")
    points = lift(view.camera, view.depth, mask)
    assert np.abs(np.linalg.norm(points - apple, axis=1) - 0.04).max() < 0.02
    floor = lift(view.camera, view.depth, view.segmentation == world.names.index("floor of room|1"))
    assert np.abs(floor[:, 2]).max() < 1e-3
    assert floor[:, 0].min() > 0.0
    assert floor[:, 1].max() < 4.0


def test_an_observation_s_camera_is_that_of_its_pictures(world: World) -> None:
    senses = world.senses("robot")
    camera = senses.camera()
    assert camera.size == senses.rgb().shape[1::-1] == (160, 104)  # of the shape of its field of view
    place = world.pose("robot")
    assert camera.pose[:3, 3] == pytest.approx((place.x, place.y, world.bodies["robot"].eye))
    assert camera.pose[:3, :3] @ camera.pose[:3, :3].T == pytest.approx(np.eye(3))
    assert np.linalg.det(camera.pose[:3, :3]) == pytest.approx(1.0)
    assert camera.matrix[0, 0] == camera.matrix[1, 1], "pixels are square"
    for side, angle in zip(camera.size, world.bodies["robot"].fov, strict=True):
        assert side / 2 / camera.matrix[0, 0] == pytest.approx(math.tan(angle / 2), rel=0.02)
        assert side / 2 / camera.matrix[0, 0] <= math.tan(angle / 2) * (1 + 1e-9)


def test_glass_is_seen_through_but_seen(world: World) -> None:
    world.teleport("human", Pose(x=3.0, y=1.8, yaw=math.pi))
    view = world.look("human")
    column, row, _ = (round(part) for part in project(view.camera, (0.0, 1.8, 1.5)))
    assert view.segmentation[row, column] in (-1, world.names.index("outdoors"))
    assert view.depth[row, column] > 5.0
    tracer = world.pictures._images._fast()
    panes, tracer._glass = tracer._glass, tracer._glass[:0]
    bare = world.picture("human")
    tracer._glass = panes
    changed = (bare != view.rgb).any(axis=-1)
    assert changed[row, column]
    assert 0.01 < changed.mean() < 0.3


def test_what_is_in_a_closed_fridge_is_in_no_picture(world: World) -> None:
    human = Pose(x=0.75, y=2.6, yaw=math.pi / 2)
    world.reset(task(on(FRIDGE, "tomato", surface=1), human=human))
    tomato = world.names.index("tomato")
    assert tomato not in world.picture("human", "segmentation")
    do(world, "human", Open(thing=FRIDGE))
    assert tomato in world.picture("human", "segmentation")


def test_what_is_carried_is_drawn_in_the_hand(world: World) -> None:
    human = Pose(x=2.5, y=3.4, yaw=-math.pi / 2)
    world.reset(task(on(TABLE, "apple"), human=human, robots=(Pose(x=6.2, y=2.0, yaw=math.pi),)))
    do(world, "human", Pick(object="apple"))
    world.teleport("human", Pose(x=4.0, y=2.0))
    view = world.look("robot", (256, 256))
    points = lift(view.camera, view.depth, view.segmentation == world.names.index("apple"))
    held = next(state.position for state in world.truth() if state.id == "apple")
    assert len(points) > 0
    assert np.linalg.norm(points - held, axis=1).max() < 0.06


@pytest.mark.parametrize("pitch", [0.0, 0.5, -0.5])
def test_a_head_tilts_with_its_camera(world: World, pitch: float) -> None:
    world.teleport("human", Pose(x=3.6, y=2.0, yaw=0.3, pitch=pitch))
    world.teleport("robot", Pose(x=6.0, y=2.0, yaw=math.pi))
    nose = max((part for part in avatar.look() if part.moves == HEAD), key=lambda part: part.centre[0] + part.half[0])
    turn, offset = bodies.head_transform(world.bodies["human"], pitch)
    x, y, z = turn @ nose.centre + offset
    tip = (3.6 + math.cos(0.3) * x - math.sin(0.3) * y, 2.0 + math.sin(0.3) * x + math.cos(0.3) * y, z)
    view = world.look("robot", (400, 400))
    column, row, depth = project(view.camera, tip)
    assert world.names[view.segmentation[round(row), round(column)]] == "human"
    assert depth - view.depth[round(row), round(column)] == pytest.approx(nose.half[0], abs=0.007)


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
    before = world.snapshot(), world.env.data.qpos.copy()
    world.top_view()
    world.picture("robot", "depth")
    assert world.snapshot() == before[0]
    assert np.array_equal(world.env.data.qpos, before[1])


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

    monkeypatch.setattr(opengl_context, "_open", fail)
    monkeypatch.setattr(opengl_context, "_forget", lambda loaded: None)
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    with pytest.raises(RenderingUnavailable, match=r"egl: no libegl; osmesa: no libosmesa; glfw.*libegl1"):
        opengl_context.context(8, 8)


def test_everyone_s_place_is_known_and_drawn_from_above(world: World) -> None:
    places = world.poses()
    assert list(places) == ["human", "robot"]
    assert places["robot"] == world.pose("robot")
    x0, _, _, y1 = world.top_view_bounds
    row, column = round((y1 - places["robot"].y) * 50), round((places["robot"].x - x0) * 50)
    with_robot = world.top_view()
    world.teleport("robot", Pose(x=8.6, y=1.2))
    changed = np.argwhere((world.top_view() != with_robot).any(axis=-1))
    near = np.linalg.norm(changed - (row, column), axis=1) < 50 * world.bodies["robot"].radius * 1.3
    assert 100 < near.sum() < len(changed)


def test_wrong_arguments_are_named(world: World) -> None:
    with pytest.raises(ValueError, match="rgb, depth, segmentation"):
        world.picture("human", "normals")
    with pytest.raises(ValueError, match="fast, nice, got 'pretty'"):
        world.picture("human", profile="pretty")  # type: ignore[arg-type]
    for size in ((0, 10), (10, 10, 10), (64.5, 64), 128):
        with pytest.raises(ValueError, match="whole pixels"):
            world.look("human", size)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="pixels_per_metre"):
        world.top_view(0.0)


WITHOUT = """
import sys
class Blind:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("OpenGL", "glfw") or name in ("mujoco.egl", "mujoco.osmesa", "mujoco.glfw"):
            raise ImportError(f"{name}: there is no OpenGL here")
sys.meta_path.insert(0, Blind())
import test_world_pictures as t
print(t.trial_with_pictures())
"""


def trial_with_pictures() -> str:
    """Play a short trial in which the robot looks, and sends what it sees; what it saw and what the person got."""
    from hthor import episode, tasks
    from hthor.types import Action, AgentRef, HumanSeat, RobotSeat, Send, TrialSpec

    seen = []

    class Mind:
        def begin(self, briefing):
            pass

        def act(self, observation):
            seen.append((observation.rgb.std() > 1.0, observation.depth.min() > 0.02))
            seen.extend(message.image().shape for message in observation.inbox if message.image)  # people send none
            return Action(motion=Rotate(yaw=0.5), say=Send(text="Look.") if observation.tick == 0 else None)

        def rate(self, met, ticks):
            return 4

    short = task(on(TABLE, "apple"), human=Pose(x=8.0, y=1.4), robots=(Pose(x=4.0, y=2.0),))
    kind = next(one.kind for one in tasks.load_suite("smoke").tasks if one.goal.relation == "find")
    short = msgspec.structs.replace(short, kind=kind, time_limit=1.0)
    agent = AgentRef(name="a", source="a", sha256="0")
    hashes = dict.fromkeys(("suite_sha256", "rules_sha256", "code_sha256"), "0")
    humans = (HumanSeat(seat="human", model="x", sha256="0", participant=0),)
    robots = (RobotSeat(seat="robot", robot="scout", agent=agent),)
    trial = TrialSpec(task=short, robots=robots, humans=humans, session=0, index=0, seed=0, **hashes)
    log = episode.play(trial, World(tiny.house(), robots=("scout",)), {"human": Mind()}, {"robot": Mind()})
    assert not log.faults, log.faults
    assert (104, 160, 3) in seen
    assert all(all(one) for one in seen)
    return f"{len(seen)} looks"


def test_a_trial_with_pictures_needs_no_opengl() -> None:
    environment = os.environ | {"MUJOCO_GL": "disable"}
    environment["PYTHONPATH"] = os.pathsep.join([str(TESTS), str(TESTS.parent), *sys.path])
    command = [sys.executable, "-W", "error", "-c", WITHOUT]
    out = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert out.stderr == ""
    assert out.stdout.endswith("looks\n")
