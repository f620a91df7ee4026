"""Laws of several people in one world: where they begin, what they see, how they look, what they do together."""

from __future__ import annotations

import itertools
import math

import msgspec
import numpy as np
import pytest
import world_house as tiny
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from world_house import COFFEE, TABLE, do, on, task, wait

from hthor import plugins
from hthor.errors import HthorError, UnknownName
from hthor.houses.space.free_space import FreeSpace
from hthor.tasks.validate import task_faults
from hthor.types import Drive, Drop, Move, Pick, Placement, Pose, Rotate, TaskSpec
from hthor.world import World
from hthor.world.model.bodies import avatar, bodies

FIND = plugins.load("task kind", "object_goal_navigation")
FAR = Pose(x=9.5, y=0.5, yaw=-1.0)


@pytest.fixture(scope="module")
def world() -> World:
    objects = [("apple", "apple"), ("mug", "mug"), ("trunk", "trunk")]
    return World(tiny.house(), robots=("tender", "puck"), objects=objects, people=3)


def place(pose: Pose) -> tuple[float, float]:
    return (pose.x, pose.y)


def disperse(world: World, *seats: str) -> None:
    """These bodies into the far corner."""
    corner = ((9.5, 0.4), (9.5, 1.0), (8.9, 0.4), (8.9, 1.0))
    for seat, (x, y) in zip(seats, corner, strict=False):
        world.teleport(seat, Pose(x=x, y=y))


def test_people_sit_before_robots(world: World) -> None:
    assert world.seats == ("human", "human2", "human3", "robot", "robot2")
    assert world.robots == ("robot", "robot2")
    assert world.bodies["human2"] == world.bodies["human"]
    assert world.actor("human2").body.title == "person"
    with pytest.raises(UnknownName, match="human4"):
        world.actor("human4")
    for people in (0, -1, 1.5, True, 1000):
        with pytest.raises(HthorError, match="people must be a whole number from 1 to 20"):
            World(tiny.house(), people=people)  # type: ignore[arg-type]


# ---------------------------------------------------------------------------------------------------- where they begin

spots = st.tuples(st.floats(0.5, 9.5), st.floats(0.5, 3.5), st.floats(-3.0, 3.0))


@settings(max_examples=cases(40))
@given(spots, st.lists(spots, max_size=3), st.lists(spots, max_size=2))
def test_everybody_begins_at_a_place_of_their_own(world: World, first, others, robots) -> None:
    human, *rest = (Pose(x=x, y=y, yaw=yaw) for x, y, yaw in (first, *others, *robots))
    given = msgspec.structs.replace(
        task(human=human, robots=tuple(rest[len(others) :])), other_human_starts=tuple(rest[: len(others)])
    )
    world.reset(given)
    asked = dict(zip(world.seats[:3], (human, *given.other_human_starts), strict=False))
    asked |= dict(zip(world.robots, given.robot_starts, strict=False))
    for seat, pose in asked.items():
        body = world.bodies[seat]
        free = FreeSpace.of(world.house, body.radius, body.height).nearest_free(pose.x, pose.y)
        assert place(world.pose(seat)) == free
        assert world.pose(seat).yaw == pose.yaw
    for seat in set(world.seats) - set(asked):
        first_of_kind = asked["human"] if seat not in world.robots else asked.get("robot", asked["human"])
        assert world.pose(seat).yaw == first_of_kind.yaw
        assert world.space[seat].is_free(*place(world.pose(seat)))
        for other in world.seats:
            if other != seat:
                apart = math.dist(place(world.pose(seat)), place(world.pose(other)))
                assert apart >= world.bodies[seat].radius + world.bodies[other].radius


def test_a_task_for_one_person_is_written_as_before(world: World) -> None:
    one = task(on(TABLE, "apple"))
    assert "other_human_starts" not in msgspec.json.encode(one).decode()
    two = msgspec.structs.replace(one, other_human_starts=(FAR,))
    assert msgspec.json.decode(msgspec.json.encode(two), type=TaskSpec) == two
    with pytest.raises(HthorError, match="yaw must be a finite number"):
        world.reset(msgspec.structs.replace(one, other_human_starts=(Pose(x=1.0, y=1.0, yaw=math.nan),)))


def test_the_best_placed_person_sets_the_least_time() -> None:
    house, far = tiny.house(), task(on(TABLE, "apple"), human=Pose(x=9.5, y=0.8))
    near = task(on(TABLE, "apple"), human=Pose(x=4.0, y=2.0))
    both = msgspec.structs.replace(far, other_human_starts=(near.human_start,))
    assert FIND.t_star(both, house) == FIND.t_star(near, house) < FIND.t_star(far, house)
    lost = msgspec.structs.replace(far, other_human_starts=(Pose(x=-50.0, y=0.0),))
    assert FIND.t_star(lost, house) == FIND.t_star(far, house)
    assert ("other_human_starts[0]", "(-50, 0) is in a wall or furniture, or less than 0.2 m from it") in [
        (field, problem) for field, problem in task_faults(lost, house)
    ]


# ------------------------------------------------------------------------------------------------------ what they see


def test_a_search_is_over_when_anybody_has_the_target_in_view(world: World) -> None:
    given = task(on(COFFEE, "apple", -0.4), human=Pose(x=1.0, y=1.0), robots=(FAR,))
    others = (Pose(x=6.3, y=1.9, pitch=-0.6), Pose(x=1.0, y=3.0))
    world.reset(msgspec.structs.replace(given, other_human_starts=others))
    snapshot = world.snapshot()
    assert list(snapshot.in_view) == ["human", "human2", "human3"]
    assert "apple" in snapshot.in_view["human2"]
    assert "apple" not in snapshot.in_view["human"]
    with pytest.raises(KeyError):
        snapshot.in_view["robot"]
    assert FIND.met(given, snapshot, world.house)
    world.teleport("human2", Pose(x=6.3, y=1.9, yaw=math.pi))
    assert not FIND.met(given, world.snapshot(), world.house)


def test_people_see_and_are_seen(world: World) -> None:
    given = task(human=Pose(x=1.0, y=1.0), robots=(Pose(x=2.5, y=0.9, yaw=math.pi), FAR))
    world.reset(
        msgspec.structs.replace(given, other_human_starts=(Pose(x=2.0, y=1.2, yaw=math.pi), Pose(x=9.5, y=1.2)))
    )
    seen = {seat: {one.id: one for one in world.detections(seat)} for seat in world.seats}
    assert (seen["human"]["human2"].family, seen["human"]["human2"].kind) == ("person", "person")
    assert (seen["human2"]["human"].family, seen["human2"]["human"].kind) == ("person", "person")
    assert (seen["human"]["robot"].family, seen["robot"]["human2"].family) == ("robot", "person")
    assert "human" not in seen["human"]
    assert "human3" not in seen["human"]


def test_heads_decide_what_is_seen(world: World) -> None:
    world.reset(task(on(COFFEE, "apple", -0.4), human=Pose(x=6.3, y=1.9, yaw=math.pi, pitch=-0.6)))
    disperse(world, *world.seats[1:])
    assert "apple" not in world.snapshot().in_view["human"]
    scan = world.scan("human")
    world.teleport("human", Pose(x=6.3, y=1.9, yaw=math.pi, pitch=-0.6, head=math.pi))
    assert "apple" in world.snapshot().in_view["human"]
    assert "apple" in {one.id for one in world.detections("human")}
    turned = world.scan("human")
    assert abs(turned.origin.yaw) < 1e-12
    assert turned.ranges.tolist() != scan.ranges.tolist()
    view, camera = world.look("human"), world.camera("human")
    world.teleport("human", Pose(x=6.3, y=1.9, yaw=0.0, pitch=-0.6))
    straight = world.look("human")
    assert np.allclose(camera.pose, world.camera("human").pose)
    assert (view.segmentation == straight.segmentation).mean() > 0.99
    with pytest.raises(HthorError, match="robot has no neck"):
        world.teleport("robot", Pose(x=8.9, y=0.4, head=0.3))


def test_a_turned_head_is_drawn_turned(world: World) -> None:
    world.reset(task(human=Pose(x=1.0, y=1.0)))
    disperse(world, "human3", "robot", "robot2")
    pictures = []
    for head in (0.0, 1.2, -1.2):
        world.teleport("human2", Pose(x=2.2, y=1.0, yaw=math.pi, head=head))
        pictures.append(world.picture("human", size=(96, 96)))
    body = world.picture("human", "segmentation", size=(96, 96)) == world.names.index("human2")
    for one, two in itertools.combinations(pictures, 2):
        rows = np.nonzero((one != two).any(axis=(1, 2)))[0]
        assert len(rows) > 3
        top, foot = np.nonzero(body)[0].min(), np.nonzero(body)[0].max()
        assert rows.max() < top + 0.2 * (foot - top), "only the head turns"


def test_people_differ_in_their_clothes(world: World) -> None:
    spec = world.bodies["human"]
    looks = [bodies.look(spec, seat) for seat in world.seats[:3]]
    assert looks[0] == bodies.look(spec) == avatar.look()
    assert len(set(looks)) == 3
    for one, two in zip(looks[0], looks[1], strict=True):
        assert msgspec.structs.replace(one, rgba=two.rgba) == two
    pieces = [bodies.pieces(spec, seat) for seat in world.seats[:3]]
    assert len({tuple(piece.material for piece in one) for one in pieces}) == 3
    assert avatar.outfit("robot2") == avatar.outfit("human")


# --------------------------------------------------------------------------------------------------- what they do


def test_two_people_carry_what_is_too_heavy_for_one(world: World) -> None:
    trunk = Placement(id="trunk", kind="trunk", position=(6.0, 2.8, 0.211), support="room|2")
    given = task(trunk, human=Pose(x=5.3, y=2.8), robots=(FAR, Pose(x=9.5, y=1.2)))
    others = (Pose(x=6.7, y=2.8, yaw=math.pi), Pose(x=1.0, y=1.0))
    world.reset(msgspec.structs.replace(given, other_human_starts=others))
    assert [event.kind for event in do(world, "human2", Pick(object="trunk"))] == ["held"]
    assert [event.kind for event in do(world, "human", Pick(object="trunk"))] == ["held", "lifted"]
    do(world, "human2", Move(forward=-0.4))
    assert world.position("trunk")[0] > 6.1
    assert do(world, "human2", Drop())[-1].kind == "lowered"


STEPS = st.lists(
    st.tuples(
        st.sampled_from(("human", "robot")),
        st.sampled_from(
            (Move(forward=0.4), Move(forward=-0.3, left=0.2), Rotate(yaw=0.9), Drive(forward=0.7, yaw=2.0))
        ),
    ),
    min_size=1,
    max_size=12,
)


@settings(max_examples=cases(15))
@given(STEPS)
def test_somebody_far_away_changes_nothing(alone: World, both: World, steps) -> None:
    given = task(on(TABLE, "apple"), human=Pose(x=4.0, y=2.0), robots=(Pose(x=3.0, y=1.2),))
    courses = []
    for world in (alone, both):
        world.reset(msgspec.structs.replace(given, other_human_starts=(FAR,)), seed=3)
        world.set_open(tiny.FRIDGE)
        course = []
        for seat, motion in steps:
            world.start(seat, motion)
            for _ in range(3):
                course.append((world.advance(), world.pose("human"), world.pose("robot"), world.snapshot().things))
                found = (*world.detections("human"), *world.detections("robot"), world.outcome(seat))
                course.append([one for one in found if getattr(one, "id", "") != "human2"])
                course.append(world.snapshot().in_view["human"])
        courses.append(course)
    assert courses[0] == courses[1]


@pytest.fixture(scope="module")
def alone() -> World:
    return World(tiny.house(), robots=("tender",), objects=[("apple", "apple")], detectors=("noisy",))


@pytest.fixture(scope="module")
def both() -> World:
    return World(tiny.house(), robots=("tender",), objects=[("apple", "apple")], detectors=("noisy",), people=2)


def test_people_talk_in_a_world_by_hand(both: World) -> None:
    both.reset(task(on(TABLE, "apple"), human=Pose(x=4.0, y=2.0)))
    wait(both, 1)
    assert both.robot.send("Look.").status == "sent"
    assert [message.text for message in both.actor("human2").inbox()] == ["Look."]
