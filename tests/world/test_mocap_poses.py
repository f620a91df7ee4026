"""The engine has the pose of every person and robot at every tick, whatever moved them."""

from __future__ import annotations

import math

import pytest
import world_house as tiny
from world_house import TABLE, on, task

from hthor.errors import PhysicsError
from hthor.types import SUBTICKS, Drive, Move, Pose, Rotate
from hthor.world import World


@pytest.fixture(scope="module")
def world() -> World:
    return World(tiny.house(), robots=("scout", "tender"), people=2)


def in_engine(world: World) -> dict[str, tuple[float, ...]]:
    """Place and heading of each body, as the engine has them."""
    data = world.env.data
    assert not data.mocap_pos[:, 2].any()
    assert not data.mocap_quat[:, 1:3].any()
    turns = [2.0 * math.atan2(z, w) for w, _, _, z in data.mocap_quat.tolist()]
    places = [(x, y) for x, y, _ in data.mocap_pos.tolist()]
    return {seat: (*place, turn) for seat, place, turn in zip(world.seats, places, turns, strict=True)}


def check(world: World) -> None:
    for seat, (x, y, yaw) in in_engine(world).items():
        pose = world.pose(seat)
        assert (x, y) == (pose.x, pose.y)
        assert math.cos(yaw - pose.yaw) == pytest.approx(1.0, abs=1e-12)


def test_a_world_and_a_task_begin_with_their_poses(world: World) -> None:
    check(World(tiny.house(), robots=("scout",)))
    world.reset(task(on(TABLE, "apple"), human=Pose(x=4.0, y=2.0, yaw=2.0), robots=(Pose(x=9.0, y=1.0, yaw=-1.0),)))
    check(world)
    world.reset()
    check(world)


def test_poses_follow_every_motion(world: World) -> None:
    world.reset()
    starts = {"human": Rotate(yaw=-0.5), "human2": Rotate(yaw=2.0), "robot": Rotate(yaw=-1.0)}
    for seat, motion in starts.items():
        world.start(seat, motion)
    before = in_engine(world)
    for _ in range(15):
        world.advance()
        check(world)
    moved = {seat for seat, pose in in_engine(world).items() if pose != before[seat]}
    assert moved == set(starts)


def test_a_turned_head_does_not_turn_the_body(world: World) -> None:
    world.reset()
    world.start("human", Drive(forward=0.3, yaw=2.5))
    for _ in range(SUBTICKS):
        world.substep()
        check(world)
    world.advance()
    assert world.pose("human").head
    check(world)


def test_poses_are_right_after_a_teleport_and_a_loaded_state(world: World) -> None:
    world.reset()
    state, poses = world.save_state(), in_engine(world)
    x, y = world.space["robot"].nearest_free(8.5, 1.2)
    world.teleport("robot", Pose(x=x, y=y, yaw=1.0))
    check(world)
    elsewhere = world.save_state()
    world.load_state(state)
    assert in_engine(world) == poses
    world.load_state(elsewhere)
    check(world)
    assert in_engine(world) != poses


def test_poses_are_right_after_the_engine_lost_its_state(world: World, monkeypatch: pytest.MonkeyPatch) -> None:
    world.reset(task(on(TABLE, "apple")))
    world.put_object("apple", (4.0, 3.0, 1.5))
    monkeypatch.setattr(world.env, "warnings", lambda: {"mjWARN_BADQACC": 0})
    world.start("human", Move(forward=-0.1))
    with pytest.raises(PhysicsError):
        world.advance()
    check(world)


def test_bodies_that_are_pulled_along_are_in_the_engine_too() -> None:
    world = World("hazel", robots=["porter"], objects=[("trunk", "trunk")])
    world.put_object("trunk", (7.8, 10.3, 0.21))
    world.settle()
    world.human.teleport(8.65, 10.4, yaw=math.pi)
    world.robot.teleport(6.85, 10.2, yaw=0.0)
    assert world.human.pick("trunk").ok
    assert world.robot.pick("trunk").ok
    before = world.robot.pose
    assert world.human.rotate(math.pi).ok
    assert world.human.move(0.5).ok
    assert world.robot.pose != before
    check(world)


def test_only_bodies_that_moved_are_written(world: World) -> None:
    world.reset()
    data = world.env.data
    data.mocap_pos[:, 2] = 7.0  # a mark that a write of x, y and yaw leaves, and a reset removes
    data.mocap_pos[1, 0] = -3.0
    world.start("human", Rotate(yaw=1.0))
    world.advance()
    assert data.mocap_pos[1, 0] == -3.0
    world.reset()
    check(world)
