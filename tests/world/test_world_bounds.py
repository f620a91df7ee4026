"""Whatever a caller gives, the world stays sound: nothing in one another, nothing too fast, no number unchecked."""

from __future__ import annotations

import itertools
import math
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import world_house as tiny
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from world_house import COFFEE, FRIDGE, TABLE, on, task

from hthor import catalog, houses
from hthor.errors import HthorError, PhysicsError, TaskError, UnknownName
from hthor.types import Pick, Place, Pose, Wait
from hthor.world import World, numbers
from hthor.world.model import composer_env
from hthor.world.model.inventory import DEFAULT_OBJECTS
from hthor.world.state.overlap_test import OverlapTest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from benchmarks import reaching

ROBOTS = (Pose(x=2.9, y=3.3, yaw=-math.pi / 2), Pose(x=2.0, y=3.3, yaw=-math.pi / 2))
TARGETS = tuple(id for id, _ in DEFAULT_OBJECTS)


@pytest.fixture(scope="module")
def built() -> World:
    return World(tiny.house(), robots=("tender", "tender"))


@pytest.fixture
def world(built: World) -> World:
    built.reset(task(human=Pose(x=4.0, y=2.0), robots=ROBOTS))
    return built


def inside(world: World, id: str) -> str:
    """What an object is in."""
    item = world.parts.objects.get(id)
    assert item is not None
    return OverlapTest(world.env, world.parts.geoms).inside(item)


# ------------------------------------------------------------------------------------- two things in one place


@pytest.mark.parametrize(("one", "two"), list(itertools.permutations(("apple", "mug", "book"), 2)))
def test_what_was_put_in_the_same_tick_is_in_the_way(world: World, one: str, two: str) -> None:
    world.put_object(one, on=COFFEE)
    world.put_object(two, on=COFFEE)
    assert inside(world, one) == inside(world, two) == ""
    with pytest.raises(HthorError, match="lettuce would be inside"):
        world.put_object("lettuce", world.position(two))
    world.remove_object(two)
    world.put_object("lettuce", on=COFFEE, position=world.position(one))
    assert inside(world, "lettuce") == ""


def test_six_things_on_one_table_stay_there(world: World) -> None:
    before = {}
    for id in TARGETS:
        world.put_object(id, on=COFFEE)
        before[id] = world.position(id)
    assert world.settle()
    for id in TARGETS:
        assert world.state(id).support == COFFEE
        assert math.dist(world.position(id), before[id]) < 0.02


def test_two_robots_place_on_one_spot_in_one_tick(world: World) -> None:
    world.reset(task(on(TABLE, "apple", 0.3, 0.1), on(TABLE, "mug", -0.3, 0.1), robots=ROBOTS))
    world.teleport("human", Pose(x=1.0, y=1.0))
    assert world.robot.pick("apple").ok
    assert world.actor("robot2").pick("mug").ok
    for seat in ("robot", "robot2"):
        world.start(seat, Place(on=TABLE, position=(2.5, 2.7, 0.8)))
    while not (world.idle("robot") and world.idle("robot2")):
        world.step()
    placed = {id: world.position(id) for id in ("apple", "mug")}
    assert inside(world, "apple") == inside(world, "mug") == ""
    assert world.settle()
    for id, position in placed.items():
        assert world.state(id).support == TABLE
        assert math.dist(world.position(id), position) < 0.02


# ---------------------------------------------------------------------------------------------------- too fast


@settings(max_examples=cases(60))
@given(
    st.sampled_from(TARGETS),
    st.tuples(st.floats(0.3, 9.7), st.floats(0.3, 3.7), st.floats(0.3, 2.3)),
    st.floats(3.0, composer_env.SPEED_MAX_M_S),
    st.floats(-math.pi, math.pi),
    st.floats(-1.5, 1.5),
    st.floats(-math.pi, math.pi),
)
def test_whatever_is_thrown_lands_in_the_house(built: World, id, place, speed, heading, climb, yaw) -> None:
    built.reset()
    flat = 0.999 * speed * math.cos(climb)
    velocity = (flat * math.cos(heading), flat * math.sin(heading), 0.999 * speed * math.sin(climb))
    try:
        built.put_object(id, place, velocity=velocity, yaw=yaw)
    except HthorError:
        return
    assert built.settle(20.0)
    x, y, z = built.position(id)
    assert (0.0 < x < 10.0, 0.0 < y < 4.0, 0.0 < z < 2.6) == (True, True, True)


@pytest.mark.parametrize(
    ("yaw", "velocity"),
    [(2.9, (2.0, -9.0, 4.0)), (0.3, (15.0, 11.0, 6.0)), (-1.1, (0.0, 0.0, -19.9)), (1.7, (-12.0, 9.0, -12.0))],
)
def test_a_thin_thing_that_hits_an_edge_does_not_spin_up_without_end(world: World, yaw, velocity) -> None:
    world.put_object("remote_control", (3.2, 1.4, 1.2), velocity=velocity, yaw=yaw)
    fastest = 0.0
    for _ in range(60):
        world.step()
        fastest = max(fastest, float(np.abs(world.env.data.qvel).max()))
    assert fastest <= composer_env.SPIN_MAX_RAD_S


def test_faster_than_anything_flies_is_refused(world: World) -> None:
    with pytest.raises(HthorError, match="velocity must be at most 20 m/s, got 30 m/s"):
        world.put_object("apple", (4.0, 2.0, 1.0), velocity=(30.0, 0.0, 0.0))


def test_an_engine_that_breaks_down_says_so_and_goes_on(world: World) -> None:
    world.put_object("apple", on=TABLE)
    world.put_object("mug", (4.0, 3.0, 1.0))
    world.step(2)
    lying, falling = world.position("apple"), world.position("mug")
    item = world.parts.objects.get("mug")
    assert item is not None
    world.env.data.qvel[item.dof] = 1e12
    with pytest.raises(PhysicsError, match=r"lost the state of house 'tiny' at tick 3 \(mjWARN_BADQVEL at mug\)"):
        world.step()
    assert world.position("apple") == lying
    assert world.position("mug") == falling
    assert world.settle()
    assert world.position("mug")[2] < 0.1
    assert world.env.warnings() == {}


def test_what_happened_in_the_tick_of_a_breakdown_is_not_lost(world: World) -> None:
    world.put_object("apple", on=TABLE)
    world.settle()
    tick = world.tick
    world.start("human", Pick(object="nothing"))
    world.env.data.qvel[0] = np.nan
    world.env.touch()
    with pytest.raises(PhysicsError):
        world.advance()
    assert [(event.kind, event.tick) for event in world.advance()] == [("refused", tick)]


# ------------------------------------------------------------------------------------------------- what bears it


@pytest.mark.parametrize("over", [-0.06, 0.0, 0.03, 0.06])
def test_a_book_over_the_edge_lies_on_the_table(world: World, over: float) -> None:
    coffee = next(thing for thing in world.house.things if thing.id == COFFEE)
    width, _, height = catalog.kind("book").size
    edge = coffee.centre[0] + coffee.size[0] / 2
    world.put_object("book", (edge + over - width / 2, 1.9, coffee.size[2] + height / 2 + 0.003))
    assert world.settle()
    assert world.position("book")[2] > coffee.size[2]
    assert world.state("book").support == COFFEE


def test_what_lies_on_the_floor_beside_a_table_lies_on_nothing(world: World) -> None:
    coffee = next(thing for thing in world.house.things if thing.id == COFFEE)
    world.put_object("book", (coffee.centre[0] + coffee.size[0] / 2 + 0.1, 1.9, 0.02))
    assert world.settle()
    assert world.state("book").support == ""


# ------------------------------------------------------------------------------------------------------- numbers


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda world: world.robot.teleport(6.2, 1.2, yaw=math.inf), "yaw must be a finite number of radians, got inf"),
        (lambda world: world.robot.teleport(6.2, 1.2, pitch=math.nan), "pitch must be a finite number of radians"),
        (lambda world: world.robot.teleport(6.2, 1.2, pitch=2.0), "pitch must be from -0.52 to 0.52 rad for robot"),
        (lambda world: world.robot.teleport(math.nan, 1.2), "x must be a finite number of metres, got nan"),
        (lambda world: world.robot.teleport(1e300, 1.2), r"\(1e\+300, 1.20\) is not free for robot"),
        (
            lambda world: world.robot.teleport(4.1, 2.1),
            r"human is in the way at \(4.10, 2.10\): robot must stay",
        ),
        (lambda world: world.robot.look_at((0.0, math.nan, 0.0)), r"target\[1\] must be a finite number of metres"),
        (lambda world: world.robot.go_to(("a", 0.0)), r"target\[0\] must be a finite number of metres, got 'a'"),
        (lambda world: world.robot.go_to((10**400, 0.0)), r"target\[0\] must be a finite number of metres"),
        (lambda world: world.put_object("apple", (4.0, 3.0)), "position must be 3 numbers of metres"),
        (lambda world: world.put_object("apple", (4.0, 3.0, 1e300)), r"\(4.00, 3.00, 1e\+300\) is in no room"),
        (lambda world: world.put_object("apple", on=TABLE, yaw=math.nan), "yaw must be a finite number of radians"),
        (lambda world: world.put_object("apple", (4.0, 3.0, 1.0), velocity=(1e308,) * 3), "at most 20 m/s"),
        (lambda world: world.step(-1), "ticks must be a whole number from 0 to 864000, got -1"),
        (lambda world: world.step(1.5), "ticks must be a whole number"),
        (lambda world: world.step(10**400), "ticks must be a whole number from 0 to 864000, got 1000"),
        (lambda world: world.settle(math.inf), "seconds must be a finite number of seconds, got inf"),
        (lambda world: world.hidden("apple", (0.0, math.nan, 0.0)), r"eye\[1\] must be a finite number of metres"),
    ],
)
def test_numbers_that_are_none_are_refused_by_name(world: World, call, words: str) -> None:
    before = world.poses(), world.truth()
    with pytest.raises(HthorError, match=words):
        call(world)
    assert (world.poses(), world.truth()) == before


@pytest.mark.parametrize("wanted", ["no", 0, 1, None, np.float64(1.0), [True]])
def test_what_opens_is_open_or_not(world: World, wanted: object) -> None:
    with pytest.raises(HthorError, match="wanted must be True or False, got"):
        world.set_open(FRIDGE, wanted)  # type: ignore[arg-type]
    world.set_open(FRIDGE, np.bool_(True))  # type: ignore[arg-type]
    world.load_state(world.save_state())
    assert world.state(FRIDGE).open is True


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"house": 3}, "house must be a name, the path of a house file or a HouseSpec, got 3"),
        ({"house": None}, "house must be a name"),
        ({"robots": [3]}, "a robot must be a name, the path of a file or a RobotSpec, got 3"),
        ({"robots": Path("nothing.py")}, "nothing.py"),
        ({"objects": ["apple"]}, "objects must be pairs of an id and a kind, .* got 'apple'"),
        ({"objects": [("mine", "apple", "red")]}, "objects must be pairs"),
        ({"objects": [(3, "apple")]}, "objects must be pairs"),
        ({"objects": [("", "apple")]}, "the id '' is empty"),
        ({"objects": [("a\n", "apple")]}, "characters that cannot be shown"),
        ({"objects": [("a" * 300, "apple")]}, "has 300 characters; use at most 200"),
        ({"objects": [("robot", "apple")]}, "the id 'robot' cannot be used"),
        ({"objects": [("human2", "apple")]}, "the id 'human2' cannot be used"),
        ({"objects": [("floor of kitchen", "apple")]}, "cannot be used"),
        ({"objects": [("mine", "apple"), ("mine", "mug")]}, "'mine' is taken"),
        ({"objects": [("my/apple", "apple"), ("my|apple", "mug")]}, "is taken"),
    ],
)
def test_a_world_is_made_of_what_it_can_name(given: dict[str, Any], words: str) -> None:
    with pytest.raises(HthorError, match=words):
        World(**{"house": tiny.house(), **given})


@pytest.mark.parametrize("sort", ["rooms", "walls", "openings", "things"])
def test_no_object_has_the_id_of_a_part_of_the_house(sort: str) -> None:
    id = getattr(tiny.house(), sort)[0].id
    with pytest.raises(HthorError, match=r"is taken by another thing of house|cannot be used"):
        World(tiny.house(), objects=[(id, "apple")])


def test_a_house_may_be_a_path(tmp_path: Path) -> None:
    copied = tmp_path / "mine.json"
    copied.write_bytes((Path(houses.__file__).parent / "data" / "alder.json").read_bytes())
    assert World(copied).house.sha256 == houses.load("alder").sha256


def test_a_task_of_another_house_is_named(world: World) -> None:
    other = msgspec.structs.replace(task(), house="elder", house_sha256="0" * 64)
    house = msgspec.structs.replace(tiny.house(), sha256="1" * 64)
    with pytest.raises(TaskError, match=f"house: made for house 'elder', and this is house '{house.id}'"):
        World(house).reset(other)
    with pytest.raises(HthorError, match="task must be a TaskSpec"):
        world.reset("smoke")  # type: ignore[arg-type]


def test_what_is_fixed_is_no_object_that_is_not_there(world: World) -> None:
    assert world.human.pick(TABLE).reason == f"{TABLE} is fixed, and cannot be picked up"
    assert world.human.pick("aple").reason == "there is no object 'aple' to pick up"
    assert world.human.pick(["mug"]).reason == "there is no object '['mug']' to pick up"  # type: ignore[arg-type]
    other = World("hazel")
    clock = "alarm_clock_1"
    other.remove_object(clock)
    assert other.human.pick(clock).reason == f"there is no object '{clock}' to pick up"


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda world: world.robot.move(1e308), "move is 1e+308 m long; at most 1000 m at once"),
        (lambda world: world.robot.move(1e308, 1e308), "move is 1.41e+308 m long; at most 1000 m at once"),
        (lambda world: world.robot.move("far"), "forward must be a finite number, got 'far'"),
        (lambda world: world.robot.move(10**400), "forward must be a finite number"),
        (lambda world: world.robot.wait(1e308), "wait is 1e+308 s long; at most 3600 s"),
        (lambda world: world.robot.do(Wait(seconds=10**400)), "seconds must be a finite number"),
        (lambda world: world.robot.rotate(10**400), "yaw must be a finite number"),
        (
            lambda world: world.robot.rotate(10**5000),
            "yaw must be a finite number, got a number of thousands of digits",
        ),
    ],
)
def test_motions_that_cannot_be_are_refused(world: World, call, words: str) -> None:
    outcome = call(world)
    assert not outcome.ok
    assert words in outcome.reason


def test_a_wait_of_less_than_nothing_is_one_tick(world: World) -> None:
    world.reset()
    for seconds in (0.0, -1.0, -1e308):
        before = world.tick
        assert world.robot.wait(seconds).ok
        assert world.tick == before + 1


def test_a_truth_value_is_no_number_of_pixels(world: World) -> None:
    for size in ((True, 24), (24, True)):
        with pytest.raises(ValueError, match=r"size must be \(width, height\) in whole pixels"):
            world.look("robot", size)


def test_a_task_with_positions_that_are_none_is_refused(world: World) -> None:
    lost = on(TABLE, "apple")
    lost = type(lost)(id="apple", kind="apple", position=(math.nan, 0.0, 0.0))
    with pytest.raises(TaskError, match=r"position of apple\[0\] must be a finite number of metres"):
        world.reset(task(lost))
    with pytest.raises(TaskError, match="yaw must be a finite number of radians"):
        world.reset(task(human=Pose(x=4.0, y=2.0, yaw=math.inf)))


def test_a_seat_that_there_is_not_is_named(world: World) -> None:
    for call in (world.look, world.picture, world.camera, world.scan, world.detections, world.pose, world.frame):
        with pytest.raises(UnknownName, match="unknown seat 'robot3'"):
            call("robot3")


def test_numbers_of_numpy_are_numbers() -> None:
    assert numbers.number("x", np.float32(0.5), "metres") == 0.5
    assert numbers.point3("p", np.array((1.0, 2.0, 3.0))) == (1.0, 2.0, 3.0)
    assert numbers.whole_number("n", np.int64(3), 0, 5) == 3


# ------------------------------------------------------------------------------------------------ going to objects


def test_going_to_an_object_is_ok_only_where_it_can_be_picked_up(world: World) -> None:
    world.reset(task(on(TABLE, "apple", 0.3, 0.1), on(tiny.FRIDGE, "mug", surface=0), human=Pose(x=4.0, y=2.0)))
    human = world.human
    assert human.go_to("apple").ok
    assert human.pick("apple").ok
    outcome = human.go_to("mug")
    assert (outcome.ok, outcome.reason) == (False, f"mug is out of sight; {tiny.FRIDGE} is closed")
    world.set_open(tiny.FRIDGE)
    assert human.go_to("mug").ok
    assert world.hindrance("human", "mug") == ""


@pytest.mark.parametrize(
    ("scene", "body"),
    [
        ("juniper", "human"),
        *(
            pytest.param(scene, body, marks=pytest.mark.nightly)
            for scene in World.scenes()
            for body in reaching.BODIES
            if (scene, body) != ("juniper", "human")
        ),
    ],
)
def test_the_promise_of_going_holds_all_over_a_house(scene: str, body: str) -> None:
    reasons: Counter[str] = Counter()
    found = reaching.measure(scene, body, reasons)
    assert found["ok"] > found["targets"] / 2
    assert reaching.broken(found) == 0, reasons


def test_no_picture_is_promised_of_a_door_from_inside_it() -> None:
    """Bodies pass through open doors; a picture does not show what is around the camera."""
    world, promised = World("willow", robots=["puck"]), 0
    for door in (state for state in world.truth() if state.kind == "door"):
        leaf = world.parts.geoms.drawn(door.id)[0]
        middle, axes = world.parts.geoms.pos[leaf][:2], world.parts.geoms.mat[leaf].reshape(3, 3)[:2, :2]
        for along, across in itertools.product((-0.4, -0.2, 0.0, 0.2, 0.4), (-0.02, 0.0, 0.02, 0.05)):
            x, y = (middle + axes @ (along, across)).tolist()
            if not world.space["robot"].is_free(x, y):
                continue
            for turn in range(8):
                world.robot.teleport(x, y, yaw=0.1 + turn * math.pi / 4)
                if world.in_sight("robot", door.id, picture=True):
                    promised += 1
                    assert (world.robot.segmentation() == world.names.index(door.id)).any(), (door.id, along, across)
    assert promised


def test_nothing_is_in_sight_under_a_wall() -> None:
    """What lies flat on the floor goes on below it for the engine, where no wall would hide it."""
    world = World("birch", robots=["puck"])
    world.robot.teleport(6.075, 2.525, yaw=-2.48)
    assert not world.in_sight("robot", "brush")
