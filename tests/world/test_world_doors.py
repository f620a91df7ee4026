"""Drawers, flaps and the leaves of doorways: what they hide, hold, stop and refuse."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest
import world_house as tiny
from world_house import COUNTER, do, reason, task, wait

from hthor import catalog
from hthor.types import Close, HouseSpec, Move, Open, Pick, Place, Placement, Pose, Thing
from hthor.world import World
from hthor.world.model import door_geometry

DOOR, DRESSER, STOVE, OVEN = "door|1|2", "dresser|1", "stove|1", "microwave|1"
AT_DRESSER = Pose(x=6.0, y=2.6, yaw=math.pi / 2)


def house() -> HouseSpec:
    """The tiny house with a leaf in its doorway and more that opens."""
    whole = tiny.house()
    openings = tuple(msgspec.structs.replace(opening, openable=opening.id == DOOR) for opening in whole.openings)
    more = (
        tiny.thing(DRESSER, "dresser", 6.0, 3.6, math.pi),
        tiny.thing(STOVE, "stove", 0.45, 0.5, -math.pi / 2),
        tiny.thing(OVEN, "microwave", 3.05, 0.42, 0.0, low=0.9, parent=COUNTER),
        tiny.thing("pen|1", "pen", 6.2, 3.6, 0.0, low=0.82, parent=DRESSER),
    )
    return msgspec.structs.replace(whole, openings=openings, things=(*whole.things, *more))


def within(thing: Thing, kind: str, name: str) -> Placement:
    """An object in the middle of one of the thing's surfaces."""
    surface = next(surface for surface in catalog.kind(thing.kind).surfaces(thing.size) if surface.name == name)
    from hthor.geometry.plane import to_house

    x, y, z = to_house(surface.centre, thing.centre, thing.yaw)
    height = catalog.kind(kind).size[2]
    return Placement(id=kind, kind=kind, position=(x, y, z + height / 2), support=thing.id, relation="in")


@pytest.fixture(scope="module")
def built() -> World:
    return World(house(), robots=("scout",))


@pytest.fixture
def world(built: World) -> World:
    things = {thing.id: thing for thing in built.house.things}
    inside = (
        within(things[DRESSER], "remote_control", "drawer"),
        within(things[STOVE], "lettuce", "oven"),
        within(things[OVEN], "mug", "inside"),
        within(things[COUNTER], "tomato", "cupboard"),
    )
    built.reset(task(*inside, human=AT_DRESSER, robots=(Pose(x=9.0, y=0.6),)))
    return built


def seen(world: World, seat: str = "human") -> set[str]:
    return {detection.id for detection in world.detections(seat)}


def state(world: World, id: str):
    return next(state for state in world.truth() if state.id == id)


FRONTS = {
    "remote_control": (DRESSER, AT_DRESSER, -0.7),
    "lettuce": (STOVE, Pose(x=1.4, y=0.5, yaw=math.pi), -0.7),
    "mug": (OVEN, Pose(x=3.0, y=1.2, yaw=-math.pi / 2), -0.6),
    "tomato": (COUNTER, Pose(x=3.35, y=1.5, yaw=-math.pi / 2), -0.8),
}


@pytest.mark.parametrize("object", FRONTS)
def test_what_is_behind_a_door_is_seen_and_taken_only_when_it_is_open(world: World, object: str) -> None:
    thing, place, pitch = FRONTS[object]
    world.teleport("human", msgspec.structs.replace(place, pitch=pitch))
    assert not state(world, thing).open
    assert object not in seen(world)
    assert reason(world, "human", Pick(object=object)) == f"{object} is out of sight"
    assert reason(world, "human", Open(thing=thing)) == ""
    assert state(world, thing).open
    assert object in seen(world)
    assert reason(world, "human", Pick(object=object)) == ""
    spot = state(world, object).position
    assert reason(world, "human", Place(on=thing, position=(spot[0], spot[1], 0.0))) == ""
    wait(world, 40)
    assert world.still
    assert state(world, object).support == thing


def test_content_rides_with_its_drawer_and_sleeps(world: World) -> None:
    before = state(world, "remote_control").position
    do(world, "human", Open(thing=DRESSER))
    out = state(world, "remote_control").position
    (drawer,) = catalog.kind("dresser").joints()
    assert before[1] - out[1] == pytest.approx(drawer.travel, abs=0.005)
    assert state(world, "remote_control").support == DRESSER
    assert state(world, "pen|1").position == pytest.approx((6.2, 3.6, 0.825), abs=1e-3)
    wait(world, 20)
    assert world.still
    assert reason(world, "human", Close(thing=DRESSER)) == ""
    wait(world, 20)
    assert world.still
    assert state(world, "remote_control").position == pytest.approx(before, abs=0.005)
    assert "remote_control" not in seen(world)


def test_what_is_placed_in_an_open_drawer_goes_in_with_it(world: World) -> None:
    do(world, "human", Pick(object="pen|1"))
    assert reason(world, "human", Place(on=DRESSER, position=(6.0, 3.3, 0.0))) == ""
    wait(world, 20)
    assert state(world, "pen|1").position[2] > 0.8, "a closed drawer takes nothing"
    do(world, "human", Open(thing=DRESSER))
    do(world, "human", Pick(object="pen|1"))
    assert reason(world, "human", Place(on=DRESSER, position=(6.2, 3.1, 0.0))) == ""
    wait(world, 20)
    lying = state(world, "pen|1").position
    assert lying[2] < 0.65
    do(world, "human", Close(thing=DRESSER))
    wait(world, 20)
    assert state(world, "pen|1").position[1] == pytest.approx(lying[1] + 0.85 * 0.44, abs=0.03)
    assert state(world, "pen|1").support == DRESSER


def test_without_a_position_things_go_on_top_not_into_a_drawer(world: World) -> None:
    do(world, "human", Open(thing=DRESSER))
    do(world, "human", Pick(object="pen|1"))
    assert reason(world, "human", Place(on=DRESSER)) == ""
    wait(world, 10)
    assert state(world, "pen|1").position[2] > 0.8


def test_a_drawer_needs_its_way_free(world: World) -> None:
    world.put_object("book", position=(6.0, 3.2, 0.0 + 0.016))
    wait(world, 10)
    assert reason(world, "human", Open(thing=DRESSER)) == ""  # the book lies far below
    do(world, "human", Close(thing=DRESSER))
    world.put_object("book", position=(6.0, 3.2, 0.62))
    assert reason(world, "human", Open(thing=DRESSER)) == "book is in the way"


def test_doorways_start_open_and_close_from_both_sides(world: World) -> None:
    assert state(world, DOOR).open
    assert (state(world, DOOR).kind, state(world, DOOR).position) == ("door", pytest.approx((5.0, 2.0, 1.05)))
    for x, yaw in ((4.2, 0.0), (5.8, math.pi)):
        world.teleport("human", Pose(x=x, y=1.9, yaw=yaw))
        assert reason(world, "human", Open(thing=DOOR)) == f"{DOOR} is already open"
        assert reason(world, "human", Close(thing=DOOR)) == ""
        assert not state(world, DOOR).open
        found = {detection.id: detection for detection in world.detections("human")}
        assert (found[DOOR].family, found[DOOR].state) == ("doorway", "closed")
        assert reason(world, "human", Close(thing=DOOR)) == f"{DOOR} is already closed"
        assert reason(world, "human", Open(thing=DOOR)) == ""
    world.teleport("human", Pose(x=3.0, y=3.4, yaw=0.0))
    assert "reach is" in reason(world, "human", Close(thing=DOOR))


def test_a_closed_doorway_stops_bodies_sight_and_scans(world: World) -> None:
    world.teleport("human", Pose(x=4.3, y=2.0))
    assert world.scan("human").ranges[24] > 2.0
    grid = world.space["human"]
    assert "coffee_table|1" in seen(world)
    do(world, "human", Close(thing=DOOR))
    assert "coffee_table|1" not in seen(world)
    assert world.scan("human").ranges[24] == pytest.approx(0.68, abs=0.06)
    assert world.space["human"] is not grid
    assert not world.space["human"].segment_free((4.3, 2.0), (5.7, 2.0))
    assert world.space["robot"].label(9.0, 0.6) != world.space["robot"].label(4.0, 2.0)
    for _ in range(2):
        do(world, "human", Move(forward=0.5))
    outcome = world.outcome("human")
    assert (outcome.reason, outcome.by) == ("blocked", DOOR)
    assert world.pose("human").x < 4.8
    do(world, "human", Open(thing=DOOR))
    assert world.space["human"] is grid
    for _ in range(3):
        do(world, "human", Move(forward=0.5))
    assert world.pose("human").x > 5.5


def test_no_door_closes_on_a_body(world: World) -> None:
    world.teleport("human", Pose(x=4.3, y=2.0))
    world.teleport("robot", Pose(x=5.1, y=1.9))
    assert reason(world, "human", Close(thing=DOOR)) == "robot stands in the doorway"
    world.teleport("robot", Pose(x=9.0, y=0.6))
    world.start("human", Close(thing=DOOR))
    world.advance()
    world.teleport("robot", Pose(x=5.0, y=2.0))
    wait(world, 6)
    assert world.outcome("human").reason == "robot stands in the doorway"
    assert state(world, DOOR).open
    assert world.space["robot"].is_free(5.0, 2.0)


def test_no_door_closes_on_an_object_and_a_closed_one_stops_them(world: World) -> None:
    world.teleport("human", Pose(x=4.3, y=2.0))
    world.put_object("apple", position=(5.0, 2.0, 0.05))
    wait(world, 10)
    assert reason(world, "human", Close(thing=DOOR)) == "apple is in the way"
    world.remove_object("apple")
    do(world, "human", Close(thing=DOOR))
    world.put_object("apple", position=(5.4, 2.0, 0.9), velocity=(-4.0, 0.0, 0.5))
    wait(world, 30)
    assert state(world, "apple").position[0] > 5.0
    do(world, "human", Open(thing=DOOR))
    world.put_object("apple", position=(5.4, 2.0, 0.9), velocity=(-4.0, 0.0, 0.5))
    wait(world, 30)
    assert state(world, "apple").position[0] < 4.95


def test_what_touches_a_door_is_woken_when_it_moves(world: World) -> None:
    """A thing that leans on it has nothing to lean on any more; the engine itself wakes only what something hits."""
    world.teleport("human", Pose(x=4.3, y=2.0))
    do(world, "human", Close(thing=DOOR))
    book = world.parts.objects.known("book")
    world.put_object("book", position=(5.0 + door_geometry.LEAF_M / 2 + book.size[0] / 2 + 0.001, 2.0, 0.02))
    world.teleport("human", AT_DRESSER)
    assert world.settle()
    assert world.env.asleep[book.tree] >= 0
    world.set_open(DOOR)
    assert world.env.asleep[book.tree] < 0


def test_reset_opens_all_doorways(world: World) -> None:
    world.teleport("human", Pose(x=4.3, y=2.0))
    before = world.snapshot().things[DOOR]
    pose = np.array(world.env.data.geom_xpos)
    do(world, "human", Close(thing=DOOR))
    world.reset(task(human=Pose(x=4.3, y=2.0)))
    assert world.snapshot().things[DOOR] == before
    assert world.space["human"].segment_free((4.3, 2.0), (5.7, 2.0))
    leaf = slice(*world.parts.geoms.span[DOOR])
    world.advance()
    assert np.allclose(world.env.data.geom_xpos[leaf], pose[leaf])


def test_a_leaf_opens_into_the_first_room_clear_of_the_wall() -> None:
    (leaf,) = door_geometry.doorway_leaves(house())
    (joint,) = leaf.joints
    world = World(house())
    first, end = world.parts.geoms.span[DOOR]
    x, y, _ = world.env.data.geom_xpos[first]
    assert end - first == 2
    assert (x, y) == pytest.approx((5.0 - 0.02 - 0.48, 1.5 + 0.02 + 0.02), abs=1e-3)  # the kitchen is on the west
    assert joint.travel == pytest.approx(math.pi / 2)
    wide = msgspec.structs.replace(leaf.opening, b=(5.0, 3.1))
    spec = house()
    spec = msgspec.structs.replace(spec, openings=(wide,))
    (double,) = door_geometry.doorway_leaves(spec)
    assert [joint.name for joint in double.joints] == ["left door", "right door"]
    assert double.joints[0].axis == tuple(-axis for axis in double.joints[1].axis)
