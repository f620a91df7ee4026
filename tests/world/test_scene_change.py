"""Changing the scene between two ticks: beginning again, and moving single objects."""

from __future__ import annotations

import math

import msgspec
import pytest
from two_rooms import TABLE, house, thing

from hthor import catalog
from hthor.errors import HthorError
from hthor.types import Drop, Goal, Move, Pick, Placement, Pose, TaskSpec
from hthor.world import World

DESK = thing("desk", "desk", 7.5, 4.0)
FRIDGE = thing("fridge", "fridge", 1.0, 4.5, yaw=math.pi)
HOME = house(TABLE, DESK, FRIDGE)
TOP = TABLE.centre[2] + TABLE.size[2] / 2


def lying(id: str, x: float, y: float, z: float = TOP, support: str = "table") -> Placement:
    return Placement(id=id, kind=id, position=(x, y, z + catalog.kind(id).size[2] / 2), support=support)


BEFORE = (lying("apple", 2.5, 2.1), lying("mug", 2.9, 2.5))
AFTER = (lying("apple", 7.5, 4.0, DESK.centre[2] + DESK.size[2] / 2, "desk"), BEFORE[1])
TASK = TaskSpec(
    id="t",
    kind="mobile_manipulation",
    house="made",
    house_sha256="",
    human_start=Pose(x=2.5, y=1.2, yaw=math.pi / 2),
    robot_starts=(Pose(x=4.0, y=4.0),),
    objects=BEFORE,
    goal=Goal(target="apple", relation="on", destination="desk"),
    instruction="",
    time_limit=90.0,
    t_star=1.0,
)


@pytest.fixture(scope="module")
def world() -> World:
    return World(HOME, robots=["tender"], objects=[("apple", "apple"), ("mug", "mug")])


def run(world: World, seat: str, motion: object) -> None:
    world.start(seat, motion)  # type: ignore[arg-type]
    while not world.idle(seat):
        world.advance()


def states(world: World) -> dict[str, object]:
    return {state.id: state for state in world.truth()}


def test_a_restart_is_a_beginning_in_everything_but_time(world: World) -> None:
    later = msgspec.structs.replace(TASK, objects=AFTER)
    world.reset(later, seed=3)
    fresh, poses = world.truth(), world.poses()
    world.reset(TASK, seed=3)
    run(world, "human", Pick(object="apple"))
    assert world.holding("human") == "apple"
    world.start("robot", Move(forward=0.5))
    world.advance()
    tick = world.tick
    world.restart(later)
    assert world.tick == tick
    assert world.truth() == fresh
    assert world.poses() == poses
    assert not world.holding("human")
    assert all(world.idle(seat) for seat in world.seats)
    world.advance()
    assert world.tick == tick + 1
    assert world.still, "everything is at rest"


def test_a_state_after_a_restart_can_be_saved(world: World) -> None:
    world.reset(TASK)
    world.advance()
    world.restart(msgspec.structs.replace(TASK, objects=AFTER))
    state = world.save_state()
    world.reset(TASK)
    world.load_state(state)
    assert world.save_state() == state
    assert world.truth()[0].support == "desk"


def test_one_object_moves_out_of_a_hand_and_nothing_else(world: World) -> None:
    world.reset(TASK)
    run(world, "human", Pick(object="apple"))
    world.start("human", Drop())
    mug, pose = states(world)["mug"], world.pose("human")
    world.rearrange(BEFORE, AFTER)
    assert not world.holding("human")
    assert world.idle("human"), "what the hand was doing has ended"
    for _ in range(20):
        world.advance()
    apple = states(world)["apple"]
    assert apple.support == "desk"  # type: ignore[attr-defined]
    assert math.dist(apple.position, AFTER[0].position) < 0.02  # type: ignore[attr-defined]
    assert (states(world)["mug"], world.pose("human")) == (mug, pose)


def test_two_objects_can_change_places(world: World) -> None:
    world.reset(TASK)
    apple, mug = BEFORE
    swapped = (
        msgspec.structs.replace(apple, position=(2.9, 2.5, apple.position[2])),
        msgspec.structs.replace(mug, position=(2.5, 2.1, mug.position[2])),
    )
    world.rearrange(BEFORE, swapped)
    for one in swapped:
        assert math.dist(states(world)[one.id].position, one.position) < 1e-9  # type: ignore[attr-defined]


def test_a_taken_place_gives_the_nearest_free_one(world: World) -> None:
    world.reset(TASK)
    onto_mug = (msgspec.structs.replace(BEFORE[0], position=(2.9, 2.5, BEFORE[0].position[2])), BEFORE[1])
    world.rearrange(BEFORE, onto_mug)
    apple = states(world)["apple"]
    assert 0.05 < math.dist(apple.position[:2], (2.9, 2.5)) < 0.4  # type: ignore[attr-defined]
    assert apple.support == "table"  # type: ignore[attr-defined]


def test_an_object_may_come_and_go(world: World) -> None:
    world.reset(TASK)
    world.rearrange(BEFORE, BEFORE[1:])
    assert "apple" not in states(world)
    world.rearrange(BEFORE[1:], BEFORE)
    assert "apple" in states(world)


def test_doors_stay_as_they_are_unless_all_begins_again(world: World) -> None:
    world.reset(TASK)
    world.set_open("fridge")
    world.rearrange(BEFORE, AFTER)
    assert states(world)["fridge"].open  # type: ignore[attr-defined]
    world.restart(TASK)
    assert not states(world)["fridge"].open  # type: ignore[attr-defined]


def test_an_object_without_a_support_has_no_other_place(world: World) -> None:
    world.reset(TASK)
    inside = (msgspec.structs.replace(BEFORE[0], position=TABLE.centre, support=""), BEFORE[1])
    with pytest.raises(HthorError, match="apple"):
        world.rearrange(BEFORE, (msgspec.structs.replace(inside[0], position=BEFORE[1].position), BEFORE[1]))
