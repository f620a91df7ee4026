"""Light things in a body's way are pushed, heavy and jammed ones stop it, and nothing ends up in anything else."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import pytest
import world_house as tiny
from hypothesis import given
from hypothesis import strategies as st

from hthor.geometry import convex, plane
from hthor.types import Drive, Move, Pose
from hthor.types.events import Blocked
from hthor.world import World
from hthor.world.motion.push_plan import LIGHT_KG, TOUCH_M, PushPlan
from hthor.world.state.footprint import footprint
from hthor.world.state.objects import Objects
from hthor.world.state.overlap_test import OVERLAP_M, OverlapTest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from benchmarks import loose_things as benchmark

OBJECTS = tuple((kind, kind) for kind in ("apple", "box", "book", "dumbbell", "trunk"))


@pytest.fixture(scope="module")
def made() -> World:
    return World(tiny.house(), robots=("scout", "puck"), objects=OBJECTS)


@pytest.fixture
def world(made: World) -> World:
    """The tiny house, everybody out of the way: the scout looks along a free lane of the kitchen."""
    made.reset()
    made.teleport("human", Pose(x=6.0, y=3.0))
    made.teleport("robot2", Pose(x=0.6, y=0.6))
    made.teleport("robot", Pose(x=1.2, y=1.1))
    return made


def lay(world: World, id: str, x: float, y: float) -> None:
    """Put an object on the floor and wait until it rests."""
    world.put_object(id, (x, y, world.parts.objects.known(id).size[2] / 2 + 0.005))
    assert world.settle()


def gap(world: World, seat: str, id: str) -> float:
    """How far [m] a body is from the outline of an object, negative inside it."""
    pose, item = world.pose(seat), world.parts.objects.get(id)
    return -footprint(item, world.env, world.parts.geoms).depth((pose.x, pose.y), world.bodies[seat].radius)


def test_an_apple_is_pushed_and_never_entered(world: World) -> None:
    lay(world, "apple", 1.8, 1.1)
    for _ in range(4):
        world.start("robot", Move(forward=0.5))
        while not world.idle("robot"):
            world.step()
            assert gap(world, "robot", "apple") >= -TOUCH_M
    assert world.pose("robot").x == pytest.approx(3.2)
    assert world.position("apple")[0] > 3.2 + world.bodies["robot"].radius
    assert world.settle()
    assert world.state("apple").support == ""


def test_a_thing_hit_off_centre_leaves_beside_the_body(world: World) -> None:
    lay(world, "apple", 1.8, 1.24)
    assert world.robot.move(1.5).ok
    assert world.position("apple")[1] > 1.24 + 0.03


@pytest.mark.parametrize("kind", ["trunk", "dumbbell"])
def test_what_is_heavy_stops_a_body_and_is_named(world: World, kind: str) -> None:
    assert world.parts.objects.known(kind).mass > LIGHT_KG
    lay(world, kind, 2.3, 1.1)
    before = world.position(kind)
    outcome = world.robot.move(2.0)
    assert (outcome.ok, outcome.reason, outcome.by) == (False, "blocked", kind)
    assert world.position(kind) == before
    assert [event.by for event in world.events if isinstance(event, Blocked)] == [kind]
    assert gap(world, "robot", kind) >= -TOUCH_M


@pytest.mark.parametrize(("x", "y", "yaw"), [(1.5, 3.2, 0.8), (1.4, 3.0, 1.2), (1.3, 2.8, 1.6)])
def test_who_is_stopped_where_the_thing_can_be_used_has_arrived(world: World, x: float, y: float, yaw: float) -> None:
    world.teleport("human", Pose(x=6.475, y=2.375))
    world.put_object("trunk", (x, y, 0.21), yaw=yaw)
    assert world.settle()
    assert world.human.go_to(tiny.FRIDGE).ok
    assert any(event.kind == "blocked" for event in world.events)
    assert world.human.open(tiny.FRIDGE).ok


def test_a_thing_jammed_at_a_wall_stops_the_body(world: World) -> None:
    lay(world, "box", 4.6, 3.4)
    world.teleport("robot", Pose(x=3.6, y=3.4))
    outcome = world.robot.move(2.0)
    assert (outcome.ok, outcome.by) == (False, "box")
    assert world.settle()
    assert gap(world, "robot", "box") >= -TOUCH_M


def test_two_bodies_cannot_push_a_thing_into_each_other(world: World) -> None:
    world.teleport("robot2", Pose(x=2.4, y=1.1, yaw=math.pi))
    lay(world, "box", 1.9, 1.1)
    for _ in range(6):
        for seat in ("robot", "robot2"):
            if world.idle(seat):
                world.start(seat, Move(forward=0.4))
        world.step()
        assert min(gap(world, seat, "box") for seat in ("robot", "robot2")) >= -TOUCH_M


def test_a_person_who_drives_kicks_an_apple_ahead(world: World) -> None:
    world.teleport("robot", Pose(x=0.6, y=2.0))
    world.teleport("human", Pose(x=1.2, y=1.1))
    lay(world, "apple", 1.8, 1.1)
    world.start("human", Drive(forward=1.0))
    for _ in range(15):
        for _ in range(4):
            world.substep()
            assert gap(world, "human", "apple") >= -TOUCH_M
        world.step()
        assert gap(world, "human", "apple") >= -TOUCH_M
    assert world.position("apple")[0] > world.pose("human").x > 2.3


def test_what_rolls_at_a_body_stops_there(world: World) -> None:
    world.put_object("apple", (2.2, 1.1, 0.06), velocity=(-3.0, 0.0, 0.0))
    for _ in range(30):
        world.step()
        assert gap(world, "robot", "apple") >= -TOUCH_M
    assert world.position("apple")[0] > world.pose("robot").x


@pytest.mark.parametrize(
    ("follower", "gap_m", "x", "speed", "behind", "follower_speed"),
    [
        ("apple", 0.485, 1.767, 2.663, 0.278, 3.374),
        ("apple", 0.656, 1.895, 3.220, 0.370, 3.945),
        ("book", 0.560, 1.779, 2.444, 0.344, 3.727),
        ("book", 0.623, 1.704, 3.723, 0.401, 2.582),
    ],
)
def test_what_goes_back_is_not_put_into_what_followed_it(
    world: World, follower: str, gap_m: float, x: float, speed: float, behind: float, follower_speed: float
) -> None:
    """A box that flies between two bodies gets stuck, and goes back to where its follower is by then."""
    world.teleport("robot2", Pose(x=1.2, y=1.1 + gap_m))
    middle, box = 1.1 + gap_m / 2, world.parts.objects.known("box")
    world.put_object("box", (x, middle, 0.2), velocity=(-speed, 0.0, 0.0))
    world.put_object(follower, (x + behind, middle, 0.2), velocity=(-follower_speed, 0.0, 0.0))
    for _ in range(10):
        world.step()
        assert not OverlapTest(world.env, world.parts.geoms).depths(box, 0.01)


def test_a_body_does_not_touch_what_lies_on_furniture_or_is_held(world: World) -> None:
    world.put_object("apple", on=tiny.TABLE)
    assert world.settle()
    assert not world.parts.objects.low
    assert world.human.go_to("apple").ok
    before = world.position("apple")
    world.human.move(0.3)
    assert world.position("apple") == before
    assert world.human.pick("apple").ok
    assert not world.parts.objects.low


def test_a_teleported_body_pushes_what_lies_there_aside(world: World) -> None:
    lay(world, "apple", 1.8, 1.1)
    world.teleport("robot", Pose(x=1.75, y=1.1))
    assert gap(world, "robot", "apple") >= -TOUCH_M


def test_a_thing_is_not_dropped_where_it_would_stay_in_a_body(world: World, monkeypatch: pytest.MonkeyPatch) -> None:
    """A box in hand is partly within the person's own disc: dropped, it goes ahead, if there is room."""
    lay(world, "box", 3.6, 1.7)
    world.teleport("human", Pose(x=4.2, y=1.7, yaw=math.pi))
    assert world.human.pick("box").ok
    world.env.touch()  # the engine's shapes follow the hand
    assert gap(world, "human", "box") < -0.02
    with monkeypatch.context() as jammed:
        jammed.setattr(PushPlan, "_shift_all", lambda *_: False)
        assert world.human.drop().reason == "box would be inside human"
    assert world.holding("human") == "box"
    assert world.human.drop().ok
    for _ in range(20):
        assert gap(world, "human", "box") >= -TOUCH_M
        world.step()


def test_a_quiet_world_looks_at_no_object(world: World, monkeypatch: pytest.MonkeyPatch) -> None:
    """With nothing loose a step asks one set whether it is empty, and looks at no object."""

    def never(*_: object) -> None:
        raise AssertionError("objects were looked at")

    assert world.settle()
    assert not world.parts.objects.low
    monkeypatch.setattr("hthor.world.motion.loose_things.PushPlan", never)
    monkeypatch.setattr("hthor.world.motion.loose_things.LooseThings._near", never)
    monkeypatch.setattr(Objects, "_sort", never)
    assert world.robot.move(1.0).ok


def test_a_saved_state_goes_on_with_pushed_things_byte_for_byte(world: World) -> None:
    lay(world, "apple", 1.8, 1.1)
    lay(world, "box", 2.4, 1.15)
    world.start("robot", Move(forward=0.5))
    world.step(2)
    state = world.save_state()

    def go_on() -> list[bytes]:
        states = []
        for _ in range(6):
            if world.idle("robot"):
                world.start("robot", Move(forward=0.5, left=0.05))
            world.step()
            states.append(world.save_state())
        return states

    one = go_on()
    world.reset()
    world.load_state(state)
    assert go_on() == one


def test_the_flat_robot_passes_under_a_table_and_the_scout_does_not(world: World) -> None:
    x0, y0 = 1.3, 2.6
    world.teleport("robot2", Pose(x=x0, y=y0))
    assert world.actor("robot2").move(1.2).ok  # now below the table's top
    table = next(thing for thing in world.house.things if thing.id == tiny.TABLE)
    pose = world.pose("robot2")
    assert plane.distance_to_rectangle((pose.x, pose.y), table.centre[:2], table.size[:2], table.yaw) == 0.0
    world.teleport("robot", Pose(x=x0, y=y0))
    outcome = world.robot.move(1.2)
    assert (outcome.ok, outcome.by) == (False, tiny.TABLE)


def test_what_a_flat_robot_s_scan_shows_free_is_free_to_drive(world: World) -> None:
    world.teleport("robot2", Pose(x=1.3, y=2.6))
    scan, space = world.scan("robot2"), world.space["robot2"]
    for bearing, far in zip(scan.bearings.tolist(), scan.ranges.tolist(), strict=True):
        if far > 0.3:
            point = (1.3 + (far - 0.05) * math.cos(bearing), 2.6 + (far - 0.05) * math.sin(bearing))
            assert space.raw[space.cell_of(*point)]
    assert scan.ranges[len(scan.ranges) // 2] > 1.5, "it looks through below the table"


@pytest.mark.parametrize("actions", [50, pytest.param(1000, marks=pytest.mark.nightly)])
def test_random_actions_among_loose_things_leave_nothing_in_anything(actions: int) -> None:
    report = benchmark.Report()
    benchmark.run("hazel", ("scout", "puck", "tender"), 1, actions, "test", report)
    assert sum(report.actions.values()) == actions
    assert report.moved > actions / 10
    assert report.findings == []


COORDINATE = st.floats(-2.0, 2.0)


@given(st.lists(st.tuples(COORDINATE, COORDINATE), min_size=3, max_size=9), st.tuples(COORDINATE, COORDINATE))
def test_an_outline_contains_its_points_and_leaves_a_disc_along_the_way(
    points: list[tuple[float, float]], centre: tuple[float, float]
) -> None:
    outline = convex.hull(points)
    assert all(convex.disc_overlap(point, 0.0, outline)[0] > -1e-6 for point in points)
    deep, (x, y) = convex.disc_overlap(centre, 0.5, outline)
    if deep > 0.0:
        moved = [(px + (deep + 1e-6) * x, py + (deep + 1e-6) * y) for px, py in outline]
        assert convex.disc_overlap(centre, 0.5, moved)[0] <= 1e-6


@pytest.fixture(scope="module")
def carpeted() -> World:
    return World("birch", objects=(("telephone", "phone"), ("pencil", "pen"), ("carton", "box"), ("cup", "mug")))


def test_what_falls_on_the_edge_of_a_rug_lies_on_it_or_beside_it(carpeted: World) -> None:
    carpeted.reset()
    overlap = OverlapTest(carpeted.env, carpeted.parts.geoms)
    rug = next(thing for thing in carpeted.house.things if thing.id == "rug_2")
    edge = rug.centre[1] + rug.size[0] / 2  # it is turned by a right angle
    for turn in range(12):
        for id in ("telephone", "pencil"):
            size = carpeted.parts.objects.known(id).size
            x, y = rug.centre[0] + (-0.2 if id == "pencil" else 0.2), edge + 0.01 * (turn - 6)
            carpeted.put_object(id, (x, y, size[2] / 2 + 0.05), yaw=0.5 * turn)
        assert carpeted.settle()
        for id in ("telephone", "pencil"):
            item = carpeted.parts.objects.known(id)
            assert not overlap.inside(item, OVERLAP_M), (id, turn, item.position)


def test_a_rug_is_floor_also_for_what_leans_on_furniture(carpeted: World) -> None:
    """It is pushed like what lies on the bare floor."""
    carpeted.reset()
    stand = next(thing for thing in carpeted.house.things if thing.id == "tv_stand")
    size = carpeted.parts.objects.known("carton").size
    x = stand.centre[0] + stand.size[1] / 2 + size[0] / 2 + 0.001
    carpeted.put_object("carton", (x, stand.centre[1], size[2] / 2 + 0.012))
    assert carpeted.settle()
    carton = carpeted.parts.objects.known("carton")
    assert {"rug_2", "tv_stand"} <= set(OverlapTest(carpeted.env, carpeted.parts.geoms).touched(carton))
    assert carpeted.state("carton").support == ""
    assert carton.number in carpeted.parts.objects.low


def test_nothing_is_dropped_out_of_a_window(carpeted: World) -> None:
    carpeted.reset()
    human, reasons = carpeted.human, []
    for window in (opening for opening in carpeted.house.openings if opening.kind == "window"):
        (ax, ay), (bx, by) = window.a, window.b
        length = math.dist(window.a, window.b)
        for side in (1.0, -1.0):
            out = (side * (by - ay) / length, side * (ax - bx) / length)
            x, y = (ax + bx) / 2 - 0.25 * out[0], (ay + by) / 2 - 0.25 * out[1]
            if not carpeted.space["human"].is_free(x, y):
                continue
            human.teleport(x, y, yaw=math.atan2(-out[1], -out[0]))
            carpeted.put_object("cup", (x - 0.4 * out[0], y - 0.4 * out[1], 1.2))
            assert human.pick("cup").ok
            human.teleport(x, y, yaw=math.atan2(out[1], out[0]))
            dropped = human.drop()
            assert not dropped.ok, window
            reasons.append(dropped.reason)
            human.teleport(x, y, yaw=math.atan2(-out[1], -out[0]))
            assert human.drop().ok
    assert "window|2|0 is between human and cup" in reasons
