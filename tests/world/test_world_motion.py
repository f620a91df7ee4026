"""Laws of going and turning: nobody passes through walls, furniture or one another."""

from __future__ import annotations

import math

import pytest
import world_house as tiny
from event_fakes import fields
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from world_house import do, on, reason, task, wait

from hthor.types import Move, Outcome, Pose, Rotate, Wait
from hthor.types.events import Refused
from hthor.world import World


@pytest.fixture(scope="module")
def built() -> World:
    return World(tiny.house(), robots=("scout",))


@pytest.fixture
def world(built: World) -> World:
    built.reset(task(human=Pose(x=4.0, y=2.0), robots=(Pose(x=6.0, y=3.0),)))
    return built


def test_moving_takes_its_time(world: World) -> None:
    world.start("human", Move(forward=0.25))
    poses = []
    while not world.idle("human"):
        world.advance()
        poses.append(world.pose("human").x)
    assert poses == pytest.approx([4.1, 4.2, 4.25])
    assert world.outcome("human") == Outcome(motion="move", ok=True)


def test_a_move_is_a_vector_of_the_body_s_frame(world: World) -> None:
    world.teleport("human", Pose(x=4.0, y=2.0, yaw=math.pi / 2))
    do(world, "human", Move(forward=0.3, left=-0.4))
    pose = world.pose("human")
    assert (pose.x, pose.y, pose.yaw) == pytest.approx((4.4, 2.3, math.pi / 2))


def test_turning_is_exact_and_takes_its_time(world: World) -> None:
    do(world, "human", Rotate(yaw=1.0, pitch=-0.3))
    assert world.tick == 4  # 1 rad at 2.5 rad/s
    assert (world.pose("human").yaw, world.pose("human").pitch) == pytest.approx((1.0, -0.3))
    do(world, "human", Rotate(yaw=math.pi))
    assert world.pose("human").yaw == pytest.approx(1.0 - math.pi)


@pytest.mark.parametrize(
    ("motion", "expected"),
    [
        (Move(forward=0.8), "move is 0.80 m long; at most 0.50 m"),
        (Move(forward=0.4, left=0.4), "move is 0.57 m long; at most 0.50 m"),
        (Move(forward=math.nan), "forward must be a finite number, got nan"),
        (Move(forward="far"), "forward must be a finite number, got 'far'"),
        (Rotate(yaw=math.inf), "yaw must be a finite number, got inf"),
        (Rotate(yaw=7.0), "rotation is 7.00 rad; at most one full turn, 6.28 rad"),
        (Rotate(pitch=1.2), "camera pitch would be 1.20 rad; at most 1.05 rad up or down"),
        (Wait(seconds=math.nan), "seconds must be a finite number, got nan"),
        ("hop", "str is not a motion; valid: Move, Rotate, Drive, Pick, Place, Drop, Open, Close, Wait"),
    ],
)
def test_impossible_motions_are_refused_with_a_reason(world: World, motion, expected: str) -> None:
    before = world.pose("human")
    assert reason(world, "human", motion) == expected
    assert world.pose("human") == before
    assert world.idle("human")


def test_a_refusal_is_an_event(world: World) -> None:
    events = do(world, "human", Move(forward=0.8))
    verb, why = "move", "move is 0.80 m long; at most 0.50 m"
    assert events == [Refused(tick=0, seat="human", motion=verb, reason=why)]


def test_furniture_and_walls_block_and_are_named(world: World) -> None:
    world.teleport("human", Pose(x=4.0, y=1.1, yaw=-math.pi / 2))
    events = do(world, "human", Move(forward=0.5))
    assert (events[-1].kind, fields(events[-1])) == ("blocked", {"by": "counter_top|1"})
    assert world.outcome("human") == Outcome(motion="move", ok=False, reason="blocked", by="counter_top|1")
    world.teleport("human", Pose(x=4.6, y=3.0))
    do(world, "human", Move(forward=0.5))
    assert world.outcome("human").by == "wall"


def test_a_slanted_move_slides_along_a_wall(world: World) -> None:
    world.teleport("human", Pose(x=4.5, y=2.9, yaw=0.9))
    for _ in range(2):
        do(world, "human", Move(forward=0.5))
    pose = world.pose("human")
    assert pose.y > 3.4
    assert world.space["human"].is_free(pose.x, pose.y)


def test_bodies_block_each_other_and_may_part(world: World) -> None:
    world.teleport("human", Pose(x=6.0, y=2.5))
    world.teleport("robot", Pose(x=6.6, y=2.5, yaw=math.pi))
    events = do(world, "human", Move(forward=0.5))
    assert [(event.seat, event.kind, fields(event)) for event in events] == [("human", "in_way", {"by": "robot"})]
    outcome = Outcome(motion="move", ok=False, reason="robot is in the way", by="robot")
    assert world.outcome("human") == outcome
    world.parts.seats["robot"].pose = Pose(x=6.25, y=2.5)  # inside the person's disc
    assert reason(world, "human", Move(forward=0.3)) == "robot is in the way"
    assert reason(world, "human", Move(forward=-0.3)) == ""


def test_through_the_door_and_into_the_next_room(world: World) -> None:
    assert world.room("human") == "room|1"
    for _ in range(4):
        assert reason(world, "human", Move(forward=0.5)) == ""
    assert world.room("human") == "room|2"
    assert world.pose("human").x == pytest.approx(6.0)


def test_waiting(world: World) -> None:
    do(world, "human", Wait(seconds=0.35))
    assert world.tick == 4
    do(world, "human", Wait(seconds=-1.0))
    assert world.tick == 5


def test_bodies_start_on_free_floor_clear_of_each_other() -> None:
    world = World(tiny.house(), robots=("scout", "tender", "scout"))
    assert world.seats == ("human", "robot", "robot2", "robot3")
    world.reset(task(human=Pose(x=2.5, y=2.6), robots=(Pose(x=4.0, y=2.0, pitch=1.0),)))
    for seat in world.seats:
        pose = world.pose(seat)
        assert world.space[seat].is_free(pose.x, pose.y)
        assert abs(pose.pitch) <= world.bodies[seat].pitch_limit
    places = [(world.pose(seat).x, world.pose(seat).y) for seat in world.seats[1:]]
    assert places[0] == (4.0, 2.0)
    assert min(math.dist(a, b) for i, a in enumerate(places) for b in places[:i]) >= 0.36


moves = st.tuples(st.sampled_from(["human", "robot"]), st.floats(-math.pi, math.pi), st.floats(0.0, 0.5))


@settings(max_examples=cases(30))
@given(st.lists(moves, min_size=1, max_size=40))
def test_nobody_ever_enters_what_is_not_free(built: World, plan) -> None:
    built.reset(task(on(tiny.TABLE, "apple"), human=Pose(x=4.0, y=2.0), robots=(Pose(x=4.5, y=2.0),)))
    least = built.bodies["human"].radius + built.bodies["robot"].radius
    for seat, angle, length in plan:
        if built.idle(seat):
            built.start(seat, Move(forward=length * math.cos(angle), left=length * math.sin(angle)))
        wait(built, 2)
        human, robot = built.pose("human"), built.pose("robot")
        for name, pose in (("human", human), ("robot", robot)):
            assert built.space[name].is_free(pose.x, pose.y)
        assert math.hypot(human.x - robot.x, human.y - robot.y) >= least - 1e-6
