"""What the eyes of a world see: range, field of view, walls, doors, glass, and what moves."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import numpy as np
import pytest
import world_house as tiny
from world_house import COFFEE, FRIDGE, TABLE, do, on, task, wait

from hthor import rules
from hthor.errors import StaleObservation
from hthor.navigation.grid_map import OCCUPIED, UNKNOWN, GridMap
from hthor.types import Close, Observation, Open, Pick, Pose, Rotate
from hthor.types.sensors import READINGS
from hthor.world import World
from hthor.world.model.bodies import bodies

AT_FRIDGE = Pose(x=0.75, y=2.6, yaw=math.pi / 2)


@pytest.fixture(scope="module")
def built() -> World:
    return World(tiny.house(), robots=("scout",))


@pytest.fixture
def world(built: World) -> World:
    objects = (on(TABLE, "apple"), on(FRIDGE, "tomato", surface=1), on(COFFEE, "lettuce"))
    built.reset(task(*objects, human=Pose(x=4.0, y=2.0, yaw=math.pi), robots=(Pose(x=8.5, y=1.4, yaw=math.pi),)))
    return built


def seen(world: World, seat: str = "human"):
    return {detection.id: detection for detection in world.senses(seat).detections()}


def test_detections_are_sorted_and_say_what_is_true(world: World) -> None:
    found = world.senses("human").detections()
    assert [detection.id for detection in found] == sorted(detection.id for detection in found)
    apple = seen(world)["apple"]
    assert (apple.kind, apple.family, apple.support, apple.held_by) == ("apple", "object", TABLE, "")
    assert apple.position == pytest.approx((2.5, 2.6, 0.78))
    assert apple.distance == pytest.approx(math.dist((4.0, 2.0, 1.6), (2.5, 2.6, 0.78)))
    table = seen(world)[TABLE]
    assert (table.family, table.state, table.size) == ("furniture", "", (1.5, 0.9, 0.74))
    assert seen(world)[FRIDGE].state == "closed"


def test_walls_hide_and_doorways_show(world: World) -> None:
    assert "lettuce" not in seen(world)  # behind the back
    world.teleport("human", Pose(x=4.0, y=3.4))
    assert {"lettuce", COFFEE} & set(seen(world)) == set()  # behind the wall
    world.teleport("human", Pose(x=4.4, y=2.0))
    assert {"lettuce", COFFEE, "door|1|2", "robot"} <= set(seen(world))
    doorway = seen(world)["door|1|2"]
    assert (doorway.family, doorway.position) == ("doorway", (5.0, 2.0, 1.0))


def test_a_closed_fridge_hides_and_an_open_one_shows(world: World) -> None:
    world.teleport("human", AT_FRIDGE)
    assert "tomato" not in seen(world)
    do(world, "human", Open(thing=FRIDGE))
    assert seen(world)[FRIDGE].state == "open"
    tomato = seen(world)["tomato"]
    assert tomato.support == FRIDGE
    assert "tomato" in world.snapshot().in_view["human"]
    do(world, "human", Close(thing=FRIDGE))
    assert "tomato" not in seen(world)
    assert world.snapshot().in_view["human"] == ()


def test_the_field_of_view_is_the_camera_s(world: World) -> None:
    half = world.bodies["human"].fov[0] / 2
    towards = math.atan2(0.6, -1.5)
    for turn, visible in ((0.0, True), (half - 0.02, True), (half + 0.02, False), (math.pi, False)):
        world.teleport("human", Pose(x=4.0, y=2.0, yaw=towards + turn))
        assert ("apple" in seen(world)) == visible
    world.teleport("human", Pose(x=4.0, y=2.0, yaw=towards, pitch=0.9))
    assert "apple" not in seen(world)


def test_the_robot_s_detector_ends_at_its_range(world: World) -> None:
    for gap, visible in ((rules.DETECTOR_RANGE_M - 0.02, True), (rules.DETECTOR_RANGE_M + 0.02, False)):
        across = math.sqrt(gap**2 - (0.9 - 0.505) ** 2)
        world.teleport("robot", Pose(x=7.5 - across, y=1.9))
        assert ("lettuce" in seen(world, "robot")) == visible
    assert "tomato" not in seen(world, "robot")


def test_people_are_noticed_farther_than_things(world: World) -> None:
    world.teleport("human", Pose(x=6.2, y=2.6))
    world.teleport("robot", Pose(x=8.4, y=1.4, yaw=math.atan2(1.2, -2.2)))
    person = seen(world, "robot")["human"]
    assert (person.family, person.kind) == ("person", "person")
    world.teleport("human", Pose(x=5.45, y=2.6))
    assert "human" not in seen(world, "robot")


def test_bodies_hide_nothing(world: World) -> None:
    world.teleport("human", Pose(x=9.6, y=1.2, yaw=math.pi))
    before = set(seen(world)) - {"robot"}
    for x in (9.1, 8.6, 6.5):
        world.teleport("robot", Pose(x=x, y=1.2))
        assert set(seen(world)) - {"robot"} == before


def test_what_is_held_is_seen_at_the_hand_and_hides_nothing(world: World) -> None:
    world.teleport("human", Pose(x=2.5, y=3.4, yaw=-math.pi / 2))
    do(world, "human", Pick(object="apple"))
    world.teleport("human", Pose(x=6.2, y=1.4, yaw=0.0))
    world.teleport("robot", Pose(x=7.3, y=1.35, yaw=math.pi))
    apple = seen(world, "robot")["apple"]
    hand = bodies.hand(world.bodies["human"])
    assert apple.held_by == "human"
    assert apple.position[:2] == pytest.approx((6.2 + hand[0], 1.4 + hand[1]))


def test_in_view_is_near_and_before_the_eyes(world: World) -> None:
    assert world.snapshot().in_view == {"human": ("vase|1",)}  # the apple is 1.8 m away
    world.teleport("human", Pose(x=2.5, y=3.4, yaw=-math.pi / 2))
    assert world.snapshot().in_view == {"human": ("apple", "vase|1")}
    do(world, "human", Rotate(yaw=math.pi))
    assert world.snapshot().in_view == {"human": ()}


def test_the_scan_meets_walls_and_furniture_only(world: World) -> None:
    world.teleport("human", Pose(x=4.0, y=3.2, yaw=0.0))
    scan = world.senses("human").scan()
    assert scan.bearings.shape == scan.ranges.shape == (49,)
    assert scan.bearings[0] == -scan.bearings[-1] == pytest.approx(-world.bodies["human"].fov[0] / 2)
    assert scan.ranges[24] == pytest.approx(0.95, abs=0.06)  # the wall's face, on a raster of 5 cm
    do(world, "human", Rotate(yaw=math.pi))
    assert world.senses("human").scan().ranges[24] == pytest.approx(4.0 - 0.975, abs=0.06)  # the fridge's side
    world.teleport("human", Pose(x=1.2, y=2.0))
    assert world.senses("human").scan().limit == 8.0
    world.teleport("robot", Pose(x=4.0, y=1.0, yaw=math.pi))
    before = world.senses("robot").scan().ranges
    world.teleport("human", Pose(x=3.4, y=1.1))
    assert np.array_equal(world.senses("robot").scan().ranges, before)


def test_people_see_walls_over_tables_and_robots_do_not(world: World) -> None:
    world.teleport("human", Pose(x=1.2, y=2.6, yaw=0.0))  # the table lies between them and the wall at 5 m
    scan = world.senses("human").scan()
    assert scan.tops[24] < world.bodies["human"].eye
    assert scan.ranges[24] < scan.beyond[24] == pytest.approx(5.0 - 1.2, abs=0.12)
    assert np.all(scan.beyond >= scan.ranges)
    walls = np.isinf(scan.tops)
    assert np.array_equal(scan.beyond[walls], scan.ranges[walls])
    assert world.senses("robot").scan().beyond is None
    grid = GridMap(1.2, 2.6)
    grid.integrate(scan)
    assert OCCUPIED in (grid.at(4.9, 2.6), grid.at(4.95, 2.6), grid.at(5.0, 2.6))
    assert grid.at(4.0, 2.6) == UNKNOWN, "the floor behind the table was not seen"


def test_scans_agree_with_the_free_space_grid(world: World) -> None:
    space = world.space["robot"]
    world.teleport("human", Pose(x=1.2, y=2.0))
    for yaw in np.linspace(-math.pi, math.pi, 9):
        world.teleport("robot", Pose(x=4.2, y=1.9, yaw=float(yaw)))
        scan = world.senses("robot").scan()
        for bearing, reach in zip(scan.bearings, scan.ranges, strict=True):
            ux, uy = math.cos(yaw + bearing), math.sin(yaw + bearing)
            along = np.arange(0.0, reach - 1e-6, 0.01)
            cells = {space.cell_of(4.2 + t * ux, 1.9 + t * uy) for t in along}
            assert all(space.raw[cell] for cell in cells)
            if reach < scan.limit:
                t = reach + 1e-6
                assert not space.raw[space.cell_of(4.2 + t * ux, 1.9 + t * uy)]


@pytest.mark.parametrize("sensor", READINGS)
def test_a_sensor_reads_what_it_declares_once_a_tick(world: World, sensor: str) -> None:
    for seat in world.seats:
        read = getattr(world.senses(seat), sensor)
        assert read() is read()
        assert isinstance(read(), np.ndarray) if READINGS[sensor] is Any else msgspec.convert(read(), READINGS[sensor])
        assert isinstance(getattr(Observation, sensor), property)
        wait(world, 1)
        with pytest.raises(StaleObservation, match=f"seat '{seat}' was made at tick {world.tick - 1} "):
            read()
