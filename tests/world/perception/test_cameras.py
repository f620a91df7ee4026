"""Robots' cameras: how they are named, how they project, that runs know them; and what a segmentation's numbers say."""

from __future__ import annotations

import math
from pathlib import Path

import msgspec
import numpy as np
import pytest
import world_house as tiny
from eval_fakes import people, suite
from hypothesis import given
from hypothesis import strategies as st
from world_house import TABLE, on, task

from hthor import jsonio, plugins
from hthor.console import completion
from hthor.errors import HthorError, UnknownName
from hthor.eval.config import cli_command, run_config, task_selection
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning import run_teams
from hthor.guest.host.info import GuestConfig
from hthor.leaderboard.entries import overrides
from hthor.trials import robot_team, sessions
from hthor.types import Pose, RobotSeat, cameras
from hthor.world import World
from hthor.world.model.bodies import avatar
from hthor.world.rendering import camera
from hthor.world.rendering.lazy_images import LabelKey, SegmentationLabels

BODIES = [avatar.HUMAN, *(plugins.load("robot", name) for name in ("scout", "tender", "puck", "porter"))]
sides = st.integers(1, 2000)


@pytest.fixture(scope="module")
def world() -> World:
    return World(tiny.house(), robots=("scout", "tender"), cameras=("thor:90x60",))


def begin(world: World, seed: int = 0) -> World:
    robots = (Pose(x=4.0, y=3.0, yaw=math.atan2(-0.4, -1.5)), Pose(x=6.0, y=3.0))
    world.reset(task(on(TABLE, "apple"), human=Pose(x=8.0, y=1.2), robots=robots), seed)
    return world


# ------------------------------------------------------------------------------------------------------- names


@pytest.mark.parametrize(
    ("name", "size", "tidied", "pixels", "degrees"),
    [
        ("own", "", "own", None, None),
        ("own", "320x240", "own:320x240", (320, 240), None),
        ("320x240", "", "own:320x240", (320, 240), None),
        ("thor", "", "thor", (300, 300), 90.0),
        ("thor", "224x224", "thor:224x224", (224, 224), 90.0),
        ("realsense:64x36", "", "realsense:64x36", (64, 36), 69.4),
    ],
)
def test_a_camera_is_named_in_one_spelling(name, size, tidied, pixels, degrees) -> None:
    assert cameras.canonical_name(name, size) == tidied == cameras.canonical_name(tidied)
    spec = cameras.parse(tidied)
    assert (spec.name, spec.size) == (tidied, pixels)
    assert (spec.fov is None) == (degrees is None)
    assert spec.fov is None or spec.fov == pytest.approx(math.radians(degrees))


@pytest.mark.parametrize(
    ("name", "size", "words"),
    [
        ("thr", "", "unknown camera 'thr'. Did you mean 'thor'? Valid: own, square, thor, habitat, realsense"),
        ("own", "0x10", "'0x10' is not a picture size. Expected WIDTHxHEIGHT in pixels, such as 320x240"),
        ("own", "10", "'10' is not a picture size"),
        ("thor", "5000x10", "pictures of 5000x10 are too large: at most 4096 pixels a side"),
        ("thor:", "", "'' is not a picture size"),
        ("thor:10x10", "20x20", "the camera 'thor:10x10' has a size already; leave out the size '20x20'"),
    ],
)
def test_what_is_no_camera_is_refused(name: str, size: str, words: str) -> None:
    with pytest.raises(HthorError) as caught:
        cameras.canonical_name(name, size)
    assert words in str(caught.value)


def test_all_names_are_offered() -> None:
    assert sorted((cameras.OWN, *cameras.NAMED)) == completion.CAMERAS


# --------------------------------------------------------------------------------------------------- projection


@given(st.sampled_from(BODIES), sides, sides, st.sampled_from(("own", *cameras.NAMED)))
def test_pixels_are_square(body, width: int, height: int, name: str) -> None:
    chosen = cameras.parse(name)
    taken = camera.camera_record(Pose(x=1.0, y=2.0, yaw=0.3, pitch=0.1), body, (width, height), chosen)
    assert taken.matrix[0, 0] == pytest.approx(taken.matrix[1, 1], rel=1e-12)
    across, up = (math.atan(side / 2 / taken.matrix[0, 0]) * 2 for side in (width, height))
    if chosen.fov is None:  # never more than the body's field of view, and one side of it whole
        assert across <= body.fov[0] + 1e-9
        assert up <= body.fov[1] + 1e-9
        assert min(body.fov[0] - across, body.fov[1] - up) == pytest.approx(0.0, abs=1e-9)
    else:
        assert across == pytest.approx(chosen.fov)


@pytest.mark.parametrize("body", BODIES, ids=lambda body: body.name)
def test_own_pictures_have_the_shape_of_the_field_of_view(body) -> None:
    width, height = camera.image_size(body)
    assert width % 8 == height % 8 == 0
    assert 0.9 < width * height / camera.SIDE**2 < 1.1
    for half, angle in zip(camera.image_tangents(body, (width, height)), body.fov, strict=True):
        assert half == pytest.approx(math.tan(angle / 2), rel=0.02)


def test_a_world_s_robots_have_the_cameras_that_it_was_given(world: World) -> None:
    begin(world)
    view = world.look("robot")
    assert view.camera.size == (90, 60) == view.rgb.shape[1::-1]
    assert view.camera.matrix[0, 0] == pytest.approx(45.0)
    assert world.picture("robot2", "depth").shape == (128, 128)
    assert world.frame("robot")().shape == (60, 90, 3)
    assert world.senses("robot").depth().shape == (60, 90)
    assert world.camera("robot", (30, 30)).matrix[0, 0] == pytest.approx(15.0), "its field of view stays"
    column, row, depth = (view.camera.matrix @ (np.linalg.inv(view.camera.pose) @ (2.5, 2.6, 0.78, 1.0))[:3]).tolist()
    number = view.segmentation[round(row / depth), round(column / depth)]
    assert world.names[number] == "apple"


def test_what_is_detected_does_not_depend_on_the_camera() -> None:
    seen = []
    for given_cameras in ((), ("square:16x16",)):
        one = World(tiny.house(), robots=("scout",), cameras=given_cameras)
        one.reset(task(on(TABLE, "apple"), human=Pose(x=8.0, y=1.2), robots=(Pose(x=3.5, y=1.8, yaw=2.5),)))
        seen.append(one.detections("robot"))
    assert seen[0] == seen[1] != ()


def test_more_cameras_than_robots_are_refused() -> None:
    with pytest.raises(HthorError, match="there are 2 cameras and 1 robots"):
        World(tiny.house(), robots=("scout",), cameras=("own", "thor"))
    with pytest.raises(UnknownName, match="unknown camera 'thro'"):
        World(tiny.house(), robots=("scout",), cameras=("thro",))


# --------------------------------------------------------------------------------------------------------- runs


def plan(camera: str) -> run_config.RunConfig:
    crew = robot_team.form_team(["scout"], ["frontier"], camera=camera)
    return run_config.build_config(suite(30), crew, humans=people(), seed=0, participants=None)


def test_a_run_knows_its_camera(tmp_path: Path) -> None:
    usual, other = plan("own"), plan("thor:64x48")
    assert b"camera" not in jsonio.pretty(usual)
    assert msgspec.json.decode(jsonio.pretty(other), type=run_config.RunConfig).seats[0].camera == "thor:64x48"
    assert other.sha256 != usual.sha256
    assert overrides.overridden_settings(other) == {"camera": "thor:64x48"}
    assert overrides.overridden_settings(usual) == {}
    assert "--camera thor --camera-size 64x48" in cli_command.resume_command(tmp_path, other)
    assert "--camera" not in cli_command.resume_command(tmp_path, usual)
    assert "--camera-size 64x48" in cli_command.resume_command(tmp_path, plan("own:64x48"))


def test_every_trial_s_key_knows_the_camera() -> None:
    trials = [
        sessions.make_sessions(suite(10), agent=robot_team.form_team(["scout"], ["frontier"], camera=camera))[0].trials[
            0
        ]
        for camera in ("own", "own:64x48")
    ]
    assert [trial.robots[0].camera for trial in trials] == [msgspec.UNSET, "own:64x48"]
    assert jsonio.sha256(trials[0]) != jsonio.sha256(trials[1])


def test_the_options_reach_the_seats() -> None:
    options = EvalOptions(agent=("frontier",), camera="thor", camera_size="32x32")
    (team,) = run_teams.choose_teams(options, task_selection.select_tasks("smoke", ""), GuestConfig())
    assert [seat.camera for seat in team.seats] == ["thor:32x32"]
    (team,) = robot_team.parse_teams("tall:oracle,small:frontier", (), camera="square")
    assert [seat.camera for seat in team.seats] == ["square", "square"]
    assert isinstance(team.listed[0], RobotSeat)


# ----------------------------------------------------------------------------------------- numbers of a segmentation


def test_numbers_are_dealt_by_the_episode_s_seed(world: World) -> None:
    names = {}
    for seed in (1, 2, 1):
        begin(world, seed)
        assert sorted(world.names) == sorted(set(world.names))
        assert names.setdefault(seed, world.names) == world.names
        segmentation, apple = world.picture("robot", "segmentation"), world.names.index("apple")
        assert (segmentation == apple).any()
        assert segmentation.dtype == np.int32
        assert (world.senses("robot").segmentation() == segmentation).all()
    assert names[1] != names[2]


@given(st.integers(0, 2**60), st.integers(2, 300))
def test_a_number_tells_neither_name_nor_order(seed: int, count: int) -> None:
    labels = SegmentationLabels([f"thing {number:03}" for number in range(count)])
    labels.draw(LabelKey(seed))
    shown = labels.of(np.arange(-1, count))
    assert shown[0] == -1
    assert sorted(shown[1:].tolist()) == list(range(count))
    assert [labels.names[number] for number in shown[1:]] == [f"thing {number:03}" for number in range(count)]
    if count > 50:
        assert abs(float(np.corrcoef(np.arange(count), shown[1:])[0, 1])) < 0.75


def test_the_same_thing_has_another_number_in_another_trial() -> None:
    labels = SegmentationLabels([f"thing {number}" for number in range(200)])
    found = []
    for seed in range(40):
        labels.draw(LabelKey(seed))
        found.append(int(labels.of(np.array([7]))[0]))
    assert len(set(found)) > 25
