"""Laws of driving: where it goes, what stops it, what it says, and how it goes together with other motions."""

from __future__ import annotations

import itertools
import math

import msgspec
import pytest
import world_house as tiny
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from msgspec import UNSET
from world_house import TABLE, do, on, task, wait

from hthor import rules
from hthor.geometry.plane import wrap
from hthor.types import SUBTICKS, Drive, Move, Outcome, Pick, Placement, Pose, Rotate, Wait
from hthor.types.events import Blocked, Event, InWay
from hthor.world import World

STEP_M = 1.0 * rules.TICK_S / SUBTICKS
"""[m] A step of a person who drives at full speed."""
MIDDLE = Pose(x=2.5, y=2.0)
angles = st.floats(-math.pi, math.pi)
ANY = st.floats(allow_nan=True, allow_infinity=True) | st.sampled_from((1e308, -1e308, 5e-324, 10**400, "far", None))


@pytest.fixture(scope="module")
def empty() -> World:
    """Two rooms without furniture."""
    house = msgspec.structs.replace(tiny.house(), id="empty", sha256="empty", things=())
    return World(house, robots=("tender", "scout"), people=2)


@pytest.fixture(scope="module")
def built() -> World:
    return World(tiny.house(), robots=("tender", "puck"), people=2, objects=[("apple", "apple"), ("trunk", "trunk")])


def begin(world: World, *places: Pose) -> None:
    """Every body at a place of its own; those without one far away from the others."""
    world.reset()
    disperse(world)
    for seat, pose in zip(world.seats, places, strict=False):
        world.teleport(seat, pose)


def disperse(world: World, *staying: str) -> None:
    """All bodies but some into the far corner."""
    corner = (Pose(x=9.5, y=0.4), Pose(x=9.5, y=1.0), Pose(x=8.9, y=0.4), Pose(x=8.9, y=1.0))
    for seat, pose in zip(world.seats, corner, strict=False):
        if seat not in staying:
            world.teleport(seat, pose)


def drive(world: World, seat: str, ticks: int, **given: float) -> list[Event]:
    """Drive by one set-point; what happened."""
    world.start(seat, Drive(**given))
    return [event for _ in range(ticks) for event in world.advance()]


def place(world: World, seat: str) -> tuple[float, float]:
    return (world.pose(seat).x, world.pose(seat).y)


# ---------------------------------------------------------------------------------------------------- where it goes


@settings(max_examples=cases(60))
@given(st.sampled_from(("human", "human2", "robot")), angles, st.integers(1, 20), st.floats(0.05, 1.0), angles)
def test_a_walk_by_drive_and_one_by_move_end_in_one_place(empty, seat, way, ticks, share, heading) -> None:
    speed = share * min(empty.bodies[seat].speed, 1.4 / (ticks * rules.TICK_S))
    length = speed * ticks * rules.TICK_S
    begin(empty)
    empty.teleport(seat, msgspec.structs.replace(MIDDLE, yaw=heading))
    drive(empty, seat, ticks, forward=speed, yaw=way)
    driven = place(empty, seat)
    begin(empty)
    empty.teleport(seat, msgspec.structs.replace(MIDDLE, yaw=heading))
    for part in [length / 3] * 3:
        turned = wrap(way - heading)
        do(empty, seat, Move(forward=part * math.cos(turned), left=part * math.sin(turned)))
    assert math.dist(driven, place(empty, seat)) < 0.01
    assert math.dist(driven, (2.5 + length * math.cos(way), 2.0 + length * math.sin(way))) < 1e-9


def test_left_is_left_of_the_head_and_too_fast_is_shortened(empty: World) -> None:
    begin(empty, MIDDLE)
    drive(empty, "human", 10, left=100.0, yaw=math.pi / 2)
    assert place(empty, "human") == pytest.approx((1.5, 2.0))
    begin(empty, MIDDLE)
    drive(empty, "human", 10, forward=30.0, left=40.0)
    assert place(empty, "human") == pytest.approx((3.1, 2.8))


steered = st.tuples(st.integers(0, 3), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(-10.0, 10.0))


@settings(max_examples=cases(40))
@given(st.lists(st.tuples(st.lists(steered, max_size=4), st.integers(1, 12)), min_size=1, max_size=8))
def test_nobody_drives_into_anything(built: World, script) -> None:
    begin(built, Pose(x=4.0, y=2.0), Pose(x=3.4, y=1.6), Pose(x=6.0, y=2.0), Pose(x=6.2, y=2.8))
    for steering, ticks in script:
        for seat, forward, left, yaw in steering:
            built.start(built.seats[seat], Drive(forward=forward, left=left, yaw=yaw))
        for _ in range(ticks):
            before = built.poses()
            for _ in range(SUBTICKS):
                built.substep()
                for seat, pose in built.poses().items():
                    assert built.space[seat].is_free(pose.x, pose.y)
                for one, two in itertools.combinations(built.seats, 2):
                    least = built.bodies[one].radius + built.bodies[two].radius - 1e-6
                    assert math.dist(place(built, one), place(built, two)) >= least
            built.advance()
            for seat, pose in before.items():
                most = built.bodies[seat].speed * rules.TICK_S + 1e-9
                assert math.dist((pose.x, pose.y), place(built, seat)) <= most


@settings(max_examples=cases(30))
@given(st.floats(0.1, 1.0), st.floats(-0.4, 0.4))
def test_two_people_who_meet_are_alike(empty: World, speed: float, aside: float) -> None:
    begin(empty, Pose(x=1.5, y=2.0 + aside), Pose(x=3.5, y=2.0 - aside, yaw=math.pi))
    empty.start("human", Drive(forward=speed))
    empty.start("human2", Drive(forward=speed, yaw=math.pi))
    wait(empty, 30)
    (x, y), (u, v) = place(empty, "human"), place(empty, "human2")
    assert abs((x - 2.5) + (u - 2.5)) <= 2 * STEP_M
    assert abs((y - 2.0) + (v - 2.0)) <= 2 * STEP_M


def test_those_who_drive_go_before_those_who_move(empty: World) -> None:
    begin(empty, Pose(x=1.0, y=2.0), Pose(x=3.0, y=2.0), Pose(x=2.0, y=2.0))
    apart = empty.bodies["human"].radius + empty.bodies["robot"].radius
    empty.teleport("robot", Pose(x=1.0 + apart + 0.05, y=2.0))
    empty.start("human", Move(forward=0.1))
    empty.start("robot", Drive(forward=0.8))
    empty.advance()
    assert empty.outcome("human") == Outcome(motion="move", ok=True)


# ------------------------------------------------------------------------------------------------ steps of a tick


@settings(max_examples=cases(25))
@given(st.lists(st.tuples(steered, st.integers(0, 7)), min_size=1, max_size=10))
def test_who_makes_the_steps_does_not_matter(built: World, script) -> None:
    def play(steps_by_hand: bool) -> list[object]:
        built.reset(task(on(TABLE, "apple"), human=Pose(x=4.0, y=2.0)))
        seen: list[object] = []
        for (seat, forward, left, yaw), steps in script:
            built.start(built.seats[seat], Drive(forward=forward, left=left, yaw=yaw))
            for _ in range(steps if steps_by_hand else 0):
                built.substep()
            seen += [built.advance(), built.poses(), built.outcome(built.seats[seat])]
        return [*seen, built.save_state()]

    assert play(True) == play(False)


def test_a_set_point_holds_from_its_step_on(empty: World) -> None:
    begin(empty, MIDDLE)
    empty.start("human", Drive(forward=1.0))
    for _ in range(2):
        empty.substep()
    assert place(empty, "human") == pytest.approx((2.5 + 2 * STEP_M, 2.0))
    empty.start("human", Drive(forward=1.0, yaw=math.pi / 2))
    empty.advance()
    assert place(empty, "human") == pytest.approx((2.5 + 2 * STEP_M, 2.0 + 4 * STEP_M))
    for _ in range(10):
        empty.substep()
    assert place(empty, "human") == pytest.approx((2.5 + 2 * STEP_M, 2.0 + 10 * STEP_M))
    here = place(empty, "human")
    empty.advance()
    assert place(empty, "human") == here


# ------------------------------------------------------------------------------------------------------------ heads


@settings(max_examples=cases(60))
@given(st.lists(st.tuples(st.floats(-20.0, 20.0), st.floats(-1.5, 1.5)), min_size=1, max_size=12))
def test_a_measured_head_is_taken_as_it_is(empty: World, heads) -> None:
    begin(empty, MIDDLE)
    most = empty.bodies["human"].turn_rate * rules.TICK_S + 1e-9
    for yaw, pitch in heads:
        before = empty.pose("human")
        empty.start("human", Drive(yaw=yaw, pitch=pitch))
        empty.advance()
        now = empty.pose("human")
        assert abs(wrap(now.gaze - yaw)) < 1e-9
        assert now.pitch == pitch
        assert abs(wrap(now.yaw - before.yaw)) <= most
        assert now.head is UNSET or abs(wrap(now.yaw - before.yaw)) == pytest.approx(most)
    wait(empty, 15)
    assert empty.pose("human").head is UNSET
    assert abs(wrap(empty.pose("human").yaw - heads[-1][0])) < 1e-9


@settings(max_examples=cases(40))
@given(angles, st.floats(-1.5, 1.5))
def test_a_robot_turns_whole_at_its_rate(empty: World, yaw: float, pitch: float) -> None:
    begin(empty, Pose(x=1.0, y=1.0), Pose(x=1.0, y=3.0), MIDDLE)
    body = empty.bodies["robot"]
    empty.start("robot", Drive(yaw=yaw, pitch=pitch))
    most, before = body.turn_rate * rules.TICK_S + 1e-9, empty.pose("robot")
    for _ in range(30):
        empty.advance()
        now = empty.pose("robot")
        assert now.head is UNSET
        assert abs(wrap(now.yaw - before.yaw)) <= most
        assert abs(now.pitch - before.pitch) <= most
        before = now
    assert wrap(before.yaw - yaw) == pytest.approx(0.0, abs=1e-6)  # -pi and pi are the same
    assert before.pitch == pytest.approx(max(-body.pitch_limit, min(body.pitch_limit, pitch)))


def test_a_turned_head_keeps_its_angle_in_other_motions(empty: World) -> None:
    begin(empty, MIDDLE)
    empty.start("human", Drive(yaw=2.0, pitch=1.3))
    empty.substep()
    turned = empty.pose("human")
    assert turned.head is not UNSET
    do(empty, "human", Move(forward=0.2))
    assert empty.pose("human").head == turned.head
    do(empty, "human", Rotate(yaw=0.7))
    now = empty.pose("human")
    assert (now.head, now.pitch) == (turned.head, 1.3)
    assert now.yaw == pytest.approx(turned.yaw + 0.7)
    assert now.gaze == pytest.approx(turned.gaze + 0.7)
    do(empty, "human", Rotate(pitch=-1.0))
    assert empty.pose("human").pitch == pytest.approx(0.3)
    assert empty.human.look_at((4.0, 3.0, 1.6)).ok
    now = empty.pose("human")
    assert abs(wrap(now.gaze - math.atan2(3.0 - now.y, 4.0 - now.x))) < 1e-6
    empty.teleport("human", MIDDLE)
    assert empty.pose("human") == MIDDLE


@settings(max_examples=cases(80))
@given(ANY, ANY, ANY, ANY, st.sampled_from(("human", "robot")))
def test_no_number_does_harm(empty: World, forward, left, yaw, pitch, seat: str) -> None:
    begin(empty, MIDDLE, Pose(x=1.0, y=1.0), Pose(x=4.0, y=2.0))
    empty.start(seat, Drive(forward=forward, left=left, yaw=yaw, pitch=pitch))
    before = place(empty, seat)
    wait(empty, 3)
    pose = empty.pose(seat)
    assert all(math.isfinite(number) for number in (pose.x, pose.y, pose.yaw, pose.pitch, pose.gaze))
    assert math.dist(before, (pose.x, pose.y)) <= 0.3 * empty.bodies[seat].speed + 1e-9
    assert empty.space[seat].is_free(pose.x, pose.y)
    assert abs(pose.pitch) <= math.pi / 2
    assert empty.idle(seat)
    empty.save_state()


def test_what_is_no_number_counts_as_nothing(empty: World) -> None:
    begin(empty, MIDDLE)
    drive(empty, "human", 5, forward=math.nan, left=math.inf, yaw=math.nan, pitch=math.nan)
    assert empty.pose("human") == MIDDLE


# ----------------------------------------------------------------------------------------------- what it says


def test_a_person_who_leans_on_a_wall_is_told_once(empty: World) -> None:
    begin(empty, Pose(x=1.0, y=2.0, yaw=math.pi))
    events = []
    for tick in range(100):  # the head sways, the stick trembles
        sway = math.pi + 0.2 * math.sin(tick)
        events += drive(empty, "human", 1, forward=0.9 + 0.1 * math.cos(tick), yaw=sway)
    assert events == [Blocked(tick=events[0].tick, seat="human", by="wall")]
    drive(empty, "human", 1, forward=1.0, yaw=math.pi)
    assert empty.outcome("human") == Outcome(motion="drive", ok=False, reason="blocked", by="wall")
    drive(empty, "human", 10, forward=1.0)
    assert empty.outcome("human") == Outcome(motion="drive", ok=True)
    assert [event.kind for event in drive(empty, "human", 30, forward=1.0, yaw=math.pi)] == ["blocked"]
    drive(empty, "human", 1, yaw=math.pi)
    assert [event.kind for event in drive(empty, "human", 30, forward=1.0, yaw=math.pi)] == ["blocked"]


def test_who_is_in_the_way_is_told_once_and_passed(empty: World) -> None:
    begin(empty, Pose(x=1.0, y=2.0), Pose(x=2.5, y=2.1))
    events = drive(empty, "human", 40, forward=1.0, yaw=0.3)
    assert events == [InWay(tick=events[0].tick, seat="human", by="human2")]
    assert empty.outcome("human") is None, "it has slid past"
    assert place(empty, "human")[0] > 3.0
    begin(empty, Pose(x=1.0, y=2.0), Pose(x=2.5, y=2.0))
    events = drive(empty, "human", 40, forward=1.0)
    assert [event.kind for event in events] == ["in_way"]
    assert empty.outcome("human") == Outcome(motion="drive", ok=False, reason="human2 is in the way", by="human2")
    empty.teleport("human2", Pose(x=2.5, y=3.5))
    wait(empty, 3)
    assert empty.outcome("human") == Outcome(motion="drive", ok=True)


# --------------------------------------------------------------------------------------- together with other motions


def test_other_motions_replace_it(empty: World) -> None:
    for motion in (Move(forward=0.1), Rotate(yaw=0.2), Wait(seconds=0.2)):
        begin(empty, MIDDLE)
        drive(empty, "human", 2, forward=0.5)
        assert empty.idle("human")
        assert do(empty, "human", motion) == []
        here = empty.pose("human")
        wait(empty, 3)
        assert empty.pose("human") == here
    begin(empty, MIDDLE)
    drive(empty, "human", 2, forward=0.5)
    do(empty, "human", Move(forward=9.0))  # what is refused replaces nothing
    assert place(empty, "human") == pytest.approx((2.65, 2.0))


def test_it_replaces_a_motion_that_is_under_way(empty: World) -> None:
    begin(empty, MIDDLE)
    empty.start("human", Move(forward=0.5))
    empty.advance()
    drive(empty, "human", 1, forward=1.0, yaw=math.pi / 2)
    assert empty.idle("human")
    assert place(empty, "human") == pytest.approx((2.6, 2.1))


def test_hands_are_busy_while_the_body_stands_and_the_head_moves(built: World) -> None:
    built.reset(task(on(TABLE, "apple", 0.0, -0.3), human=Pose(x=3.1, y=1.75, yaw=2.0)))
    disperse(built, "human")
    built.start("human", Drive(forward=0.5, yaw=2.0))
    built.start("human", Pick(object="apple"))
    here = place(built, "human")
    for tick in range(5):
        assert not built.idle("human")
        built.start("human", Drive(forward=0.5, yaw=2.0 - 0.1 * tick))
        built.advance()
        assert place(built, "human") == here
        assert built.pose("human").yaw == 2.0
        assert built.pose("human").gaze == pytest.approx(2.0 - 0.1 * tick)
    assert built.outcome("human") == Outcome(motion="pick", ok=True)
    assert built.idle("human")
    built.start("human", Drive(forward=0.5, yaw=-1.0))
    wait(built, 3)
    assert math.dist(here, place(built, "human")) == pytest.approx(0.15)
    assert math.dist(built.position("apple")[:2], place(built, "human")) < 0.5
    wait(built, 10)
    assert built.pose("human").yaw == -1.0


def test_what_is_held_follows_in_every_step(built: World) -> None:
    built.reset(task(on(TABLE, "apple", 0.0, -0.3), human=Pose(x=3.1, y=1.75, yaw=2.0)))
    disperse(built, "human")
    do(built, "human", Pick(object="apple"))
    built.start("human", Drive(forward=1.0, yaw=-0.8))
    for _ in range(3):
        before = built.position("apple")
        built.substep()
        assert 0.0 < math.dist(before, built.position("apple")) < 0.1
    built.advance()
    held = built.env.data.qpos[built.parts.objects.known("apple").qpos :][:3]
    assert tuple(held) == built.position("apple")


def test_a_load_is_driven_as_it_is_moved(built: World) -> None:
    trunk = Placement(id="trunk", kind="trunk", position=(6.0, 2.8, 0.211), support="room|2")

    def carry(driving: bool) -> tuple[tuple[float, float], ...]:
        built.reset(task(trunk, human=Pose(x=5.3, y=2.8), robots=(Pose(x=9.5, y=0.5), Pose(x=9.5, y=1.5))))
        built.teleport("human2", Pose(x=6.7, y=2.8, yaw=math.pi))
        do(built, "human", Pick(object="trunk"))
        if driving:
            drive(built, "human", 5, forward=1.0, yaw=2.0)
            assert built.outcome("human").reason.startswith("trunk weighs 26.0 kg; human lifts 20.0 kg")
            assert place(built, "human") == (5.3, 2.8)
        do(built, "human2", Pick(object="trunk"))
        if driving:
            built.start("human", Drive())
            drive(built, "human2", 8, forward=1.0, yaw=0.0)
        else:
            do(built, "human2", Move(forward=-0.56 + 0.21))
            do(built, "human2", Move(forward=-0.21))
        return (place(built, "human"), place(built, "human2"), built.position("trunk")[:2])

    for one, two in zip(carry(True), carry(False), strict=True):
        assert math.dist(one, two) < 0.02


def test_a_body_that_cannot_move_does_not_drive(empty: World) -> None:
    spec = msgspec.structs.replace(empty.bodies["robot"], capabilities=frozenset({"pick"}))
    world = World(empty.house, robots=(spec,))
    pose = world.pose("robot")
    drive(world, "robot", 5, forward=1.0, yaw=1.0, pitch=0.3)
    assert world.pose("robot") == pose


def test_a_teleport_ends_a_drive(empty: World) -> None:
    begin(empty, MIDDLE)
    drive(empty, "human", 2, forward=0.5)
    empty.teleport("human", MIDDLE)
    wait(empty, 3)
    assert empty.pose("human") == MIDDLE
