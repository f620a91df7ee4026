"""Laws of what is too heavy for one: who lifts it, where it goes, and that nothing is torn, lost or in a wall."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import numpy as np
import pytest
import world_house as tiny
from event_fakes import fields
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from world_house import do, reason, wait

from hthor import catalog, rules
from hthor.errors import HthorError
from hthor.houses.space import free_space
from hthor.types import Drop, Move, Pick, Place, Placement, Pose, Rotate, TaskSpec
from hthor.world import World
from hthor.world.carrying import trailer_kernel

TRUNK = catalog.kind("trunk")
ROWS = free_space.obstacle_rectangles(tiny.house(), 1.0)
HALF = np.array(TRUNK.size[:2]) / 2


def lying(x: float = 6.0, y: float = 2.0, yaw: float = 0.0, id: str = "trunk") -> Placement:
    return Placement(id=id, kind="trunk", position=(x, y, TRUNK.size[2] / 2 + 1e-3), yaw=yaw, support="room|2")


def start(human: Pose, *robots: Pose, trunk: Placement | None = None) -> TaskSpec:
    return tiny.task(trunk or lying(), human=human, robots=robots)


AT_LEFT = Pose(x=5.3, y=2.0)
AT_RIGHT = Pose(x=6.7, y=2.0, yaw=math.pi)
AWAY = Pose(x=6.0, y=3.2, yaw=-math.pi / 2)


@pytest.fixture(scope="module")
def built() -> World:
    return World(tiny.house(), robots=("tender", "porter", "puck"), objects=[("trunk", "trunk"), ("apple", "apple")])


@pytest.fixture
def world(built: World) -> World:
    built.reset(start(AT_LEFT, AT_RIGHT, AWAY, Pose(x=9.5, y=1.0)))
    return built


def state(world: World) -> Any:
    return world.state("trunk")


def lift(world: World) -> None:
    assert reason(world, "human", Pick(object="trunk")) == ""
    assert reason(world, "robot", Pick(object="trunk")) == ""


def footprint(world: World) -> Any:
    item = world.parts.objects.get("trunk")
    return np.array((*item.position[:2], item.yaw))


def sound(world: World) -> None:
    """Nothing is in anything, and no arm is too long."""
    at = footprint(world)
    strangers = np.array(
        [(pose.x, pose.y, world.bodies[seat].radius) for seat, pose in world.poses().items()], dtype=float
    )
    walls, bodies = trailer_kernel.deepest_contacts(at, HALF, ROWS, strangers)
    assert walls <= 0.003
    assert bodies <= 0.003
    for seat, pose in world.poses().items():
        assert world.space[seat].is_free(pose.x, pose.y)
        if world.holding(seat) == "trunk":
            ends = [(at[0] + s * HALF[0] * math.cos(at[2]), at[1] + s * HALF[0] * math.sin(at[2])) for s in (1, -1)]
            assert min(math.dist((pose.x, pose.y), end) for end in ends) <= world.bodies[seat].reach + 1e-9


def test_a_trunk_is_too_heavy_for_anybody_alone_and_not_for_two() -> None:
    from hthor import plugins
    from hthor.world.model.bodies.avatar import HUMAN
    from hthor.world.model.bodies.bodies import load_robot

    strengths = [
        body.strength for body in (HUMAN, *(load_robot(name) for name in plugins.names("robot"))) if body.strength
    ]
    assert max(strengths) * rules.HANDLE_STRENGTH < TRUNK.mass
    for strength in strengths:
        if strength != HUMAN.strength:
            assert (strength + HUMAN.strength) * rules.HANDLE_STRENGTH >= TRUNK.mass


def test_one_holds_on_two_lift(world: World) -> None:
    events = do(world, "human", Pick(object="trunk"))
    assert [(event.kind, fields(event)) for event in events] == [("held", {"object": "trunk"})]
    assert world.holding("human") == "trunk"
    assert (state(world).bearers, state(world).held_by) == (("human",), "")
    assert state(world).position[2] == pytest.approx(0.2, abs=0.01)
    assert reason(world, "human", Move(forward=0.1)) == (
        "trunk weighs 26.0 kg; human lifts 20.0 kg by its handles: wait until somebody helps, or let go"
    )
    assert reason(world, "human", Rotate(yaw=0.3)) == ""
    with pytest.raises(HthorError, match="trunk is in the hand of human"):
        world.remove_object("trunk")
    events = do(world, "robot", Pick(object="trunk"))
    assert [event.kind for event in events] == ["held", "lifted"]
    assert fields(events[-1]) == {"object": "trunk", "bearers": ("human", "robot")}
    assert (state(world).bearers, state(world).held_by) == (("human", "robot"), "human")
    assert state(world).position[2] == pytest.approx(0.5)
    assert world.snapshot().holding["robot"] == "trunk"
    seen = next(seen for seen in world.detections("robot2") if seen.id == "trunk")
    assert (seen.held_by, seen.bearers) == ("human", ("human", "robot"))


def test_the_last_millimetre_of_a_move_is_not_blocked(world: World) -> None:
    """A move that is a little longer than the way of a whole number of ticks."""
    lift(world)
    tick_m = rules.HANDLE_PACE * world.bodies["robot"].speed * rules.TICK_S
    for extra in (1e-4, 5e-4, 1.5e-3):
        assert reason(world, "human", Move(forward=-(2.0 * tick_m + extra))) == ""
    sound(world)


def test_those_who_are_too_weak_together_do_not_lift_it() -> None:
    world = World(tiny.house(), robots=("tender", "tender"), objects=[("trunk", "trunk")])
    world.reset(start(AWAY, AT_RIGHT, AT_LEFT))
    assert reason(world, "robot", Pick(object="trunk")) == ""
    assert reason(world, "robot2", Pick(object="trunk")) == ""
    assert state(world).held_by == ""
    assert "robot and robot2 together lift 16.0 kg" in reason(world, "robot2", Move(forward=0.1))
    wait(world, 20)
    assert state(world).position[:2] == pytest.approx((6.0, 2.0), abs=0.01)


def test_who_cannot_take_hold_is_told_why(world: World) -> None:
    assert reason(world, "robot3", Pick(object="trunk")) == "puck cannot pick things up"
    world.teleport("human", Pose(x=4.0, y=2.0))
    assert "the handle of trunk is 1.60 m away" in reason(world, "human", Pick(object="trunk"))
    world.teleport("human", Pose(x=5.3, y=2.0, yaw=math.pi))
    assert reason(world, "human", Pick(object="trunk")) == "the handle of trunk is behind human; turn towards it"
    world.teleport("human", Pose(x=6.0, y=2.0))
    assert reason(world, "human", Pick(object="trunk")) == "human stands on trunk; step back from it"
    world.teleport("human", AT_LEFT)
    lift(world)
    world.teleport("robot2", Pose(x=6.0, y=2.9, yaw=-math.pi / 2))
    assert reason(world, "robot2", Pick(object="trunk")) == "both handles of trunk are taken, by human and robot"
    assert "drop it, or place it on 'floor'" in reason(world, "robot", Place(on="sofa|1"))


def test_letting_go_before_it_is_up_frees_one_hand_only(world: World) -> None:
    do(world, "human", Pick(object="trunk"))
    events = do(world, "human", Drop())
    assert [(event.kind, fields(event)) for event in events] == [("released", {"object": "trunk"})]
    assert (state(world).bearers, world.holding("human")) == ((), "")
    lift(world)


@pytest.mark.parametrize("way", [Drop(), Place(on="floor")])
def test_whoever_lets_go_puts_it_down_for_both(world: World, way: Any) -> None:
    lift(world)
    events = do(world, "robot", way)
    assert [(event.kind, event.bearers) for event in events] == [("lowered", ("human", "robot"))]
    assert (world.holding("human"), world.holding("robot"), state(world).bearers) == ("", "", ())
    wait(world, 20)
    before = state(world).position
    assert before[2] == pytest.approx(0.2, abs=0.005)
    wait(world, 50)
    assert state(world).position == before
    assert world.still
    sound(world)


def test_it_is_put_down_on_what_lies_there_and_never_into_it(world: World) -> None:
    world.put_object("apple", (6.0, 2.0, 0.5))
    world.remove_object("apple")
    lift(world)
    world.put_object("apple", (6.0, 2.0, 0.05))
    do(world, "human", Drop())
    for _ in range(100):
        world.advance()
        low = state(world).position[2]
        assert low > 0.19
    assert world.position("apple")[2] > 0.0


def test_a_follower_comes_through_a_doorway_and_round_a_corner(world: World) -> None:
    world.reset(start(AT_LEFT, AT_RIGHT, AWAY, Pose(x=9.5, y=1.0), trunk=lying()))
    lift(world)
    do(world, "human", Rotate(yaw=math.pi))
    for turn, moves in ((0.0, 3), (math.pi / 2, 2)):
        do(world, "human", Rotate(yaw=turn))
        for _ in range(moves):
            assert reason(world, "human", Move(forward=0.5)) == ""
            sound(world)
    assert world.room("human") == "room|1"
    assert footprint(world)[0] < 4.8
    assert world.pose("human").y < 1.2
    assert math.sin(footprint(world)[2]) != pytest.approx(0.0, abs=0.2)  # it has turned after its leader


def test_both_go_at_the_pace_of_the_slower_and_less(world: World) -> None:
    lift(world)
    do(world, "human", Rotate(yaw=math.pi))
    world.start("human", Move(forward=0.5))
    here = world.pose("human").x
    wait(world, 1)
    assert here - world.pose("human").x == pytest.approx(rules.HANDLE_PACE * 0.8 * rules.TICK_S)


def test_a_shut_door_stops_it() -> None:
    whole = tiny.house()
    openings = tuple(msgspec.structs.replace(opening, openable=opening.id == "door|1|2") for opening in whole.openings)
    world = World(msgspec.structs.replace(whole, openings=openings), robots=("tender",), objects=[("trunk", "trunk")])
    world.reset(start(Pose(x=5.45, y=2.0), AT_RIGHT, trunk=lying(6.05)))
    world.set_open("door|1|2", False)
    lift(world)
    do(world, "human", Rotate(yaw=math.pi))
    world.start("human", Move(forward=0.5))
    wait(world, 20)
    outcome = world.outcome("human")
    assert outcome is not None
    assert (outcome.ok, outcome.reason, outcome.by) == (False, "blocked", "door|1|2")
    sound(world)


def test_nobody_is_run_over(world: World) -> None:
    world.teleport("robot2", Pose(x=4.3, y=2.0))
    lift(world)
    do(world, "human", Rotate(yaw=math.pi))
    outcome = world.outcome("human")
    for _ in range(3):
        do(world, "human", Move(forward=0.5))
        outcome = world.outcome("human")
        sound(world)
    assert outcome is not None
    assert (outcome.ok, outcome.reason, outcome.by) == (False, "robot2 is in the way", "robot2")


def test_no_arm_gets_longer_than_it_is(world: World) -> None:
    lift(world)
    do(world, "human", Rotate(yaw=math.pi))
    do(world, "human", Move(forward=0.4))
    world.parts.seats["robot3"].pose = Pose(x=5.2, y=2.0)  # between them, in the doorway: the trunk cannot come along
    for _ in range(4):
        do(world, "human", Move(forward=0.5))
        sound(world)
    outcome = world.outcome("human")
    assert outcome is not None
    assert (outcome.ok, outcome.by) == (False, "robot3")
    assert 1.0 < footprint(world)[0] - HALF[0] - world.pose("human").x <= world.bodies["human"].reach


def test_whoever_turns_is_drawn_along_all_the_same(world: World) -> None:
    lift(world)
    do(world, "human", Rotate(yaw=math.pi))
    world.start("human", Move(forward=0.5))
    world.start("robot", Rotate(yaw=1.0))
    before = world.pose("robot")
    wait(world, 10)
    do(world, "human", Move(forward=0.5))
    after = world.pose("robot")
    assert after.x < before.x - 0.5
    assert after.yaw == pytest.approx(before.yaw + 1.0 - 2 * math.pi, abs=1e-6)


def test_of_two_that_move_the_first_seat_leads(world: World) -> None:
    lift(world)
    do(world, "human", Rotate(yaw=math.pi))
    world.start("human", Move(forward=0.4))
    world.start("robot", Move(forward=-0.4))
    before = world.pose("human").x
    while not (world.idle("human") and world.idle("robot")):
        wait(world, 1)
        sound(world)
    assert world.pose("human").x == pytest.approx(before - 0.4, abs=0.01)
    assert world.outcome("robot").ok


def test_a_robot_can_lead_a_person_who_waits(world: World) -> None:
    up, down = Pose(x=5.9, y=2.4, yaw=-math.pi / 2), Pose(x=5.9, y=1.0, yaw=math.pi / 2)
    world.reset(start(down, up, Pose(x=4.0, y=2.0), Pose(x=9.5, y=1.0), trunk=lying(5.9, 1.7, math.pi / 2)))
    lift(world)
    do(world, "robot", Rotate(yaw=math.pi))
    for _ in range(2):
        assert reason(world, "robot", Move(forward=0.5)) == ""
        sound(world)
    assert world.pose("human").y > 1.4


def test_teleporting_and_resetting_let_go(world: World) -> None:
    lift(world)
    world.teleport("robot", Pose(x=9.0, y=1.2))
    assert (world.holding("human"), state(world).bearers) == ("", ())
    wait(world, 20)
    assert state(world).position[2] == pytest.approx(0.2, abs=0.005)
    world.teleport("robot", AT_RIGHT)
    lift(world)
    world.reset(start(AT_LEFT, AT_RIGHT, AWAY))
    assert (world.holding("human"), state(world).bearers, state(world).held_by) == ("", (), "")
    lift(world)


def test_what_one_is_strong_enough_for_goes_in_hand() -> None:
    from hthor.types import RobotSpec
    from hthor.world.model.bodies.bodies import load_robot

    porter = load_robot("porter")
    data = {name: getattr(porter, name) for name in RobotSpec.__struct_fields__}
    strong = RobotSpec(**(data | {"name": "giant", "title": "giant", "strength": 30.0}))
    world = World(tiny.house(), robots=(strong,), objects=[("trunk", "trunk")])
    world.reset(start(AWAY, AT_RIGHT))
    events = do(world, "robot", Pick(object="trunk"))
    assert [event.kind for event in events] == ["picked"]
    assert (state(world).held_by, state(world).bearers) == ("robot", ())


MOVES = st.lists(
    st.tuples(st.sampled_from(["human", "robot"]), st.floats(-1.5, 1.5), st.integers(1, 5)),
    min_size=3,
    max_size=6,
)


@settings(max_examples=cases(12))
@given(MOVES, st.floats(-math.pi, math.pi))
def test_wherever_it_is_carried_it_is_in_no_wall_in_nobody_and_in_reach(built: World, moves: Any, yaw: float) -> None:
    grip = (math.cos(yaw), math.sin(yaw))
    human, tender = (
        Pose(x=6.0 + s * 0.72 * grip[0], y=2.0 + s * 0.72 * grip[1], yaw=yaw + (math.pi if s > 0 else 0.0))
        for s in (1, -1)
    )
    built.reset(start(human, tender, Pose(x=4.0, y=3.2), Pose(x=9.5, y=1.0), trunk=lying(yaw=yaw)))
    if reason(built, "human", Pick(object="trunk")) or reason(built, "robot", Pick(object="trunk")):
        return
    traces = []
    for again in range(2):
        if again:
            built.reset(start(human, tender, Pose(x=4.0, y=3.2), Pose(x=9.5, y=1.0), trunk=lying(yaw=yaw)))
            lift(built)
        trace = []
        for seat, turn, steps in moves:
            do(built, seat, Rotate(yaw=turn))
            before = built.poses()
            for _ in range(9 * steps):  # half a metre takes nine ticks
                if built.idle(seat):
                    built.start(seat, Move(forward=0.5))
                built.advance()
                sound(built)
                for one, pose in built.poses().items():
                    way = math.dist((pose.x, pose.y), (before[one].x, before[one].y))
                    assert way <= built.bodies[one].speed * rules.TICK_S + 1e-9
                before = built.poses()
            while not built.idle(seat):
                built.advance()
            trace.append((built.poses(), state(built).position))
        do(built, "robot", Drop())
        for _ in range(100):
            built.advance()
            if built.still:
                break
        assert state(built).position[2] == pytest.approx(0.2, abs=0.006)
        sound(built)
        trace.append(state(built).position)
        traces.append(trace)
    assert traces[0] == traces[1]
