"""A hand-made house of two rooms for the tests of the world, with a task in it and a few short cuts."""

from __future__ import annotations

import math
from typing import Any

from hthor import catalog
from hthor.types import Goal, HouseSpec, Motion, Opening, Placement, Pose, Room, TaskSpec, Thing, Vec3, Wall
from hthor.types.events import Event
from hthor.world import World

KITCHEN = ((0.0, 0.0), (5.0, 0.0), (5.0, 4.0), (0.0, 4.0))
LIVING = ((5.0, 0.0), (10.0, 0.0), (10.0, 4.0), (5.0, 4.0))
OUTSIDE = ((0.0, 0.0), (10.0, 0.0), (10.0, 4.0), (0.0, 4.0))
FRIDGE, TABLE, COFFEE, COUNTER = "fridge|1", "dining_table|1", "coffee_table|1", "counter_top|1"
SHELF = "side_table|1"


def house() -> HouseSpec:
    rooms = (
        Room(id="room|1", kind="kitchen", name="kitchen", polygon=KITCHEN, floor="WoodFloor"),
        Room(id="room|2", kind="living_room", name="living room", polygon=LIVING, floor="WhiteTile"),
    )
    faces = [("room|1", KITCHEN), ("room|2", LIVING), ("exterior", OUTSIDE)]
    walls = tuple(
        Wall(id=f"wall|{room}|{side}", room=room, a=ring[side], b=ring[(side + 1) % 4], height=2.6)
        for room, ring in faces
        for side in range(4)
    )
    openings = (
        _opening("door|1|2", "door", ("room|1", "room|2"), (5.0, 1.5), (5.0, 2.5), 0.0, 2.1, True),
        _opening("window|1", "window", ("room|1", "room|1"), (0.0, 1.2), (0.0, 2.4), 0.9, 2.0, False),
        _opening("door|1|out", "door", ("room|1", "room|1"), (2.0, 0.0), (2.9, 0.0), 0.0, 2.1, False),
    )
    things = (
        thing(FRIDGE, "fridge", 0.6, 3.55, math.pi),
        thing(TABLE, "dining_table", 2.5, 2.6),
        thing(COUNTER, "counter_top", 3.6, 0.42),
        thing("chair|1", "chair", 2.5, 1.75),
        thing("sofa|1", "sofa", 7.5, 0.6),
        thing(COFFEE, "coffee_table", 7.5, 1.9),
        thing("tv_stand|1", "tv_stand", 7.5, 3.7, math.pi),
        thing("television|1", "television", 7.5, 3.7, math.pi, low=0.5, parent="tv_stand|1"),
        thing("bed|1", "bed", 9.0, 2.7),
        thing("book|old", "book", 3.9, 0.42, 0.3, low=0.9, parent=COUNTER),
        thing("vase|1", "vase", 2.9, 2.6, low=0.74, parent=TABLE),
    )
    return HouseSpec(
        id="tiny",
        sha256="tiny",
        rooms=rooms,
        walls=walls,
        openings=openings,
        things=things,
        height=2.6,
        start=Pose(x=4.0, y=2.0),
    )


def _opening(id: str, kind: Any, rooms: Any, a: Any, b: Any, low: float, high: float, passable: bool) -> Opening:
    return Opening(id=id, kind=kind, rooms=rooms, a=a, b=b, low=low, high=high, passable=passable)


def thing(id: str, kind: str, x: float, y: float, yaw: float = 0.0, low: float = 0.0, parent: str = "") -> Thing:
    size = catalog.kind(kind).size
    room = "room|1" if x < 5.0 else "room|2"
    return Thing(
        id=id, kind=kind, asset="", centre=(x, y, low + size[2] / 2), size=size, yaw=yaw, room=room, parent=parent
    )


def on(support: str, kind: str, u: float = 0.0, v: float = 0.0, surface: int = -1, id: str = "") -> Placement:
    """An object lying on a thing's surface, ``u`` and ``v`` [m] off its middle along its local axes."""
    from hthor.geometry.plane import to_house

    owner = next(thing for thing in house().things if thing.id == support)
    place = catalog.kind(owner.kind).surfaces(owner.size)[surface]
    local = (place.centre[0] + u, place.centre[1] + v, place.centre[2] + catalog.kind(kind).size[2] / 2)
    relation: Any = "in" if place.inside else "on"
    position: Vec3 = to_house(local, owner.centre, owner.yaw)
    return Placement(id=id or kind, kind=kind, position=position, support=support, relation=relation)


def task(*objects: Placement, human: Pose | None = None, robots: tuple[Pose, ...] = ()) -> TaskSpec:
    return TaskSpec(
        id="test",
        kind="object_goal",
        house="tiny",
        house_sha256="tiny",
        human_start=human or Pose(x=4.0, y=2.0, yaw=math.pi),
        robot_starts=robots,
        objects=objects,
        goal=Goal(target="apple", relation="find"),
        instruction="find an apple",
        time_limit=90.0,
        t_star=3.0,
    )


def do(world: World, seat: str, motion: Motion) -> list[Event]:
    """Start a motion and let time pass until it is over; what happened."""
    world.start(seat, motion)
    events = list(world.advance())
    while not world.idle(seat):
        events += world.advance()
    return events


def reason(world: World, seat: str, motion: Motion) -> str:
    """Why a motion failed, empty when it did not."""
    do(world, seat, motion)
    outcome = world.outcome(seat)
    assert outcome is not None
    assert outcome.ok == (not outcome.reason)
    return outcome.reason


def wait(world: World, ticks: int) -> None:
    for _ in range(ticks):
        world.advance()
