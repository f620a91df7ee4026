"""A hand on one body: it goes where it is told by a way that there is, says what stops it, and passes messages."""

from __future__ import annotations

import math

import pytest
import world_house as tiny
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from world_house import COFFEE, COUNTER, FRIDGE, TABLE, on, task

from hthor import houses, rules
from hthor.errors import HthorError, UnknownName
from hthor.types import Close, Move, Open, Pose
from hthor.world import World

MIDDLE = Pose(x=4.0, y=2.0)
quick = settings(max_examples=cases(20))


@pytest.fixture(scope="module")
def built() -> World:
    return World(tiny.house(), robots=("tender", "scout"))


@pytest.fixture
def world(built: World) -> World:
    return begin(built)


def begin(world: World) -> World:
    apple, mug = on(TABLE, "apple", 0.3, 0.1), on(FRIDGE, "mug", surface=0)
    world.reset(task(apple, mug, human=MIDDLE, robots=(Pose(x=6.0, y=3.0), Pose(x=8.5, y=1.0))))
    return world


def straight(world: World, seat: str, x: float, y: float) -> float:
    pose = world.pose(seat)
    return math.dist((pose.x, pose.y), (x, y))


# --------------------------------------------------------------------------------------------------------------- going


def test_a_vector_longer_than_a_step_is_gone_in_steps(world: World) -> None:
    human = world.human
    human.teleport(1.2, 0.8, yaw=0.0)
    assert human.move(1.3, 0.0).ok
    assert (human.pose.x, human.pose.y) == pytest.approx((2.5, 0.8))
    steps = math.ceil(1.3 / rules.MOVE_MAX_M)
    assert world.tick == steps * math.ceil(1.3 / steps / (human.body.speed * rules.TICK_S))


def test_the_first_step_that_is_blocked_is_the_last(world: World) -> None:
    human = world.human
    human.teleport(4.0, 2.0, yaw=-math.pi / 2)
    outcome = human.move(3.0)
    assert not outcome.ok
    assert (outcome.reason, outcome.by) == ("blocked", COUNTER)
    assert world.pose("human").y > 0.9
    assert [event.kind for event in world.events].count("blocked") == 1


def test_bad_vectors_are_refused_and_move_nothing(world: World) -> None:
    for forward in (math.nan, math.inf):
        before = world.human.pose
        assert not world.human.move(forward).ok
        assert world.human.pose == before


@quick
@given(st.floats(0.2, 9.8), st.floats(0.2, 3.8))
def test_going_to_a_point_ends_at_the_nearest_free_place(built: World, x: float, y: float) -> None:
    world = begin(built)
    robot = world.robot
    outcome = robot.go_to((x, y))
    space, others = world.space["robot"], [pose for seat, pose in world.poses().items() if seat != "robot"]
    assert outcome.ok or outcome.by in ("human", "robot2")
    nearest = (x, y) if space.is_free(x, y) else space.nearest_free(x, y, space.component(6.0, 3.0))
    if all(math.dist((pose.x, pose.y), nearest) > 1.5 for pose in others):  # and nobody stands there
        assert outcome.ok
        assert straight(world, "robot", x, y) == pytest.approx(math.dist(nearest, (x, y)), abs=1e-6)
    assert not [event for event in world.events if event.kind in ("blocked", "in_way", "refused")]


def test_going_leads_around_another_body(world: World) -> None:
    """Somebody stands in the middle of the straight way, in the free part of the room."""
    human, robot = world.human, world.robot
    human.teleport(1.0, 1.0)
    robot.teleport(2.0, 1.0)
    assert human.go_to((3.2, 1.2)).ok
    assert straight(world, "human", 3.2, 1.2) < 1e-6
    assert not [event for event in world.events if event.kind == "in_way"]


def test_a_body_in_the_only_doorway_is_no_way_through(world: World) -> None:
    """Whoever wants to pass goes as near as there is floor."""
    world.actor("robot2").teleport(5.0, 2.0)
    outcome = world.human.go_to((8.6, 1.0))
    assert (outcome.ok, outcome.by) == (False, "robot2")
    assert world.human.room == "room|1"
    assert 4.0 < world.human.pose.x < 5.0
    assert not [event for event in world.events if event.kind in ("blocked", "in_way", "refused")]


@pytest.mark.parametrize("thing", [FRIDGE, TABLE, COUNTER, COFFEE, "bed|1", "sofa|1", "tv_stand|1", "apple"])
@pytest.mark.parametrize("seat", ["human", "robot"])
def test_going_to_a_thing_ends_in_reach_and_facing_it(world: World, seat: str, thing: str) -> None:
    actor = world.actor(seat)
    assert actor.go_to(thing).ok
    x, y, _ = world.position(thing)
    ahead = math.atan2(y - actor.pose.y, x - actor.pose.x)
    assert math.remainder(actor.pose.yaw - ahead, 2 * math.pi) == pytest.approx(0.0, abs=1e-6)
    if thing == FRIDGE:
        assert actor.open(thing).ok
    elif thing == "apple":
        assert actor.pick(thing).ok
        assert actor.holding == "apple"


def test_going_to_a_body_ends_beside_it(world: World) -> None:
    assert world.robot.go_to("human").ok
    human = world.human.pose
    apart = straight(world, "robot", human.x, human.y)
    assert world.bodies["human"].radius + world.bodies["robot"].radius - 1e-6 <= apart < 1.5


def test_what_is_in_the_hand_goes_along(world: World) -> None:
    human = world.human
    assert human.go_to("apple").ok
    assert human.pick("apple").ok
    assert human.go_to(COFFEE).ok
    assert math.dist(world.position("apple")[:2], (human.pose.x, human.pose.y)) < human.body.reach
    assert human.place(COFFEE).ok
    assert world.state("apple").support == COFFEE


# ------------------------------------------------------------------------------------------------------------- looking


@quick
@given(st.floats(-3, 13), st.floats(-3, 7), st.floats(0, 2.5))
def test_looking_at_a_point_turns_the_camera_there(built: World, x: float, y: float, z: float) -> None:
    world = begin(built)
    human = world.human
    assert human.look_at((x, y, z)).ok
    pose, far = human.pose, math.hypot(x - human.pose.x, y - human.pose.y)
    if far > 1e-3:
        assert math.remainder(pose.yaw - math.atan2(y - pose.y, x - pose.x), 2 * math.pi) == pytest.approx(0, abs=1e-6)
        limit = human.body.pitch_limit
        wanted = max(-limit, min(limit, math.atan2(z - human.body.eye, far)))
        assert pose.pitch == pytest.approx(wanted, abs=1e-6)
    assert (pose.x, pose.y) == (MIDDLE.x, MIDDLE.y)


def test_looking_shows_what_is_looked_at(world: World) -> None:
    human = world.human
    assert human.go_to("apple").ok
    assert human.sees("apple")
    assert human.rotate(math.pi).ok
    assert not human.sees("apple")
    assert human.look_at("apple").ok
    assert human.sees("apple")
    row, column = 64, 64
    number = world.names.index("apple")
    assert abs(float((human.segmentation() == number).nonzero()[0].mean()) - row) < 3
    assert abs(float((human.segmentation() == number).nonzero()[1].mean()) - column) < 3
    assert not human.sees("mug"), "the fridge is closed"


# ------------------------------------------------------------------------------------------------------------ teleport


def test_teleport_keeps_what_is_not_given_and_ends_what_was_begun(world: World) -> None:
    human = world.human
    human.rotate(0.7, pitch=0.2)
    world.start("human", Move(forward=0.5))
    assert not world.idle("human")
    pose = human.teleport(2.0, 0.8)
    assert (pose.x, pose.y) == (2.0, 0.8)
    assert (pose.yaw, pose.pitch) == pytest.approx((0.7, 0.2))
    assert world.idle("human")
    world.step(5)
    assert human.pose == pose


def test_there_is_no_teleport_into_furniture_or_a_wall(world: World) -> None:
    before = world.human.pose
    for x, y in ((2.5, 2.6), (5.0, 0.5), (-3.0, 1.0)):
        with pytest.raises(HthorError, match=r"not free for human; try space\['human'\]\.nearest_free"):
            world.human.teleport(x, y)
    assert world.human.pose == before


@pytest.mark.parametrize(("motion", "begun"), [(Open, False), (Close, True)])
def test_teleport_lets_go_of_a_door_that_it_was_moving(world: World, motion, begun: bool) -> None:
    """The door stays where it is; another body can take it from there."""
    human = world.human
    world.set_open(FRIDGE, begun)
    assert human.go_to(FRIDGE).ok
    world.start("human", motion(thing=FRIDGE))
    world.step(2)
    assert not world.idle("human")
    human.teleport(4.0, 2.0)
    assert world.settle()
    robot = world.robot
    assert robot.go_to(FRIDGE).ok
    assert (robot.open(FRIDGE) if motion is Open else robot.close(FRIDGE)).ok, "nobody else holds it"
    assert world.state(FRIDGE).open == (not begun)


# ------------------------------------------------------------------------------------------------------------ messages


def test_a_message_is_sent_shown_and_answered(world: World) -> None:
    robot, human = world.robot, world.human
    assert robot.receipt() is None
    assert human.inbox() == ()
    receipt = robot.send("The apple is here.", object="apple", position=world.position("apple"))
    assert receipt.status == "sent"
    (message,) = human.inbox()
    assert (message.sender, message.text, message.object) == ("robot", "The apple is here.", "apple")
    assert message.position == pytest.approx(world.position("apple"))
    assert message.image().shape == (128, 128, 3)
    assert robot.receipt().status == "shown"
    human.reply(accept=False)
    assert robot.receipt().status == "declined"
    assert human.inbox() == ()
    with pytest.raises(HthorError, match="there is no message for human to answer"):
        human.reply(accept=True)
    assert [(m.id, r.status) for m, r in world.messages] == [(message.id, "declined")]
    assert [event.kind for event in world.events] == ["sent", "shown", "declined"]


def test_a_new_message_covers_the_one_before(world: World) -> None:
    first, second = world.robot, world.actor("robot2")
    first.send("one")
    assert second.receipt() is None
    second.send("two")
    assert first.receipt().status == "covered"
    assert [message.text for message in world.human.inbox()] == ["two"]
    world.human.reply(accept=True)
    assert (first.receipt().status, second.receipt().status) == ("covered", "accepted")


def test_a_confirmed_message_gives_a_map_that_is_hidden_and_shown(world: World) -> None:
    human, robot = world.human, world.robot
    with pytest.raises(HthorError, match="no message was confirmed yet"):
        human.map_view()
    robot.send("The apple is here.", "apple", world.position("apple"))
    assert human.display.message is not None
    assert human.display.message.text == "The apple is here."
    assert human.display.map is None
    human.reply(accept=True)
    assert human.display.message is None
    picture = human.map_view(160)
    assert picture.shape == (160, 160, 3)
    assert (world.map_view("human", 160) == picture).all()
    human.hide("map")
    with pytest.raises(HthorError, match=r"it is hidden: show\('map'\) shows it"):
        human.map_view()
    human.show("map")
    human.show("panel")
    assert human.display.message.text == "The apple is here."
    assert (human.map_view(160) == picture).all()
    assert [(e.kind, e.what, e.on) for e in world.events[-3:]] == [
        ("displayed", "map", False),
        ("displayed", "map", True),
        ("displayed", "panel", True),
    ]
    for wrong in (robot.map_view, lambda: robot.show("map"), lambda: human.map_view(7), lambda: human.hide("radio")):
        with pytest.raises(HthorError):
            wrong()


def test_the_map_turns_and_moves_with_the_person_and_the_robot(world: World) -> None:
    human, robot = world.human, world.robot
    apple = world.position("apple")
    robot.send("The apple is here.", "apple", apple)
    human.reply(accept=True)
    before = human.map_view()
    for act in (lambda: human.rotate(1.0), lambda: human.move(0.3), lambda: robot.move(-0.3)):
        act()
        (body,), (place,), me = human.display.map.bodies, human.display.map.places, human.pose
        for mark, point in ((body, (robot.pose.x, robot.pose.y)), (place, apple[:2])):
            way = me.gaze + math.atan2(mark.left, mark.forward)
            far = math.hypot(mark.forward, mark.left)
            assert (me.x + far * math.cos(way), me.y + far * math.sin(way)) == pytest.approx(point, abs=5e-3)
    assert (human.map_view() != before).any()


def test_the_image_is_the_sender_s_view_at_that_moment(world: World) -> None:
    robot = world.robot
    robot.go_to("apple")
    seen = robot.rgb()
    robot.send("look")
    robot.rotate(math.pi)
    (message,) = world.human.inbox()
    assert (message.image() == seen).all()
    assert (message.image() != robot.rgb()).any()


def test_a_person_asks_and_a_robot_answers(world: World) -> None:
    world.human.send("Where is the apple?", "apple", to="robot", question=True)
    assert world.actor("robot2").inbox() == ()
    (question,) = world.robot.inbox()
    world.robot.send("On the table.", "apple", (1.0, 2.0, 0.8), answers=question.id)
    assert world.robot.inbox() == ()
    assert (world.human.receipt().status, world.human.receipt().by) == ("answered", "robot")
    (answer,) = world.human.inbox()
    assert (answer.answers, answer.to, answer.position) == (question.id, "human", (1.0, 2.0, 0.8))


def test_who_may_not_speak_or_answer_is_told_so(world: World) -> None:
    with pytest.raises(HthorError, match="ghost"):
        world.human.send("hello", to="ghost")
    world.robot.send("hello")
    with pytest.raises(HthorError, match="robot"):
        world.robot.reply(accept=True, message=0)
    with pytest.raises(HthorError):
        world.human.reply(accept=True, message=99)
    assert world.robot.receipt().status == "sent"


def test_a_reset_forgets_messages_and_events(world: World) -> None:
    world.robot.send("hello")
    world.robot.move(0.2)
    world.reset()
    assert (world.messages, world.events, world.tick, world.robot.receipt()) == ((), [], 0, None)
    assert {state.id for state in world.objects()} == {"book|old", "vase|1"}


# --------------------------------------------------------------------------------------------------------- wrong names


def test_names_that_do_not_exist_are_named_with_the_nearest_that_does(world: World) -> None:
    cases = (
        (lambda: world.position("aple"), "unknown thing 'aple'. Did you mean 'apple'"),
        (lambda: world.state(TABLE), "unknown object 'dining_table|1'"),
        (lambda: world.human.go_to("fridge|2"), r"unknown thing 'fridge\|2'. Did you mean 'fridge\|1'"),
        (lambda: world.human.look_at("robot3"), "unknown thing 'robot3'"),
        (lambda: world.actor("robot3"), "unknown seat 'robot3'.*Valid: human, robot, robot2.*robots="),
        (lambda: world.objects(room="attic"), "unknown room 'attic'.*Valid: kitchen, living room"),
        (lambda: world.furniture(room="attic"), "unknown room 'attic'"),
        (lambda: world.set_open(TABLE), TABLE.replace("|", r"\|")),
        (lambda: world.put_object("egg", on=TABLE), "egg"),
        (lambda: world.remove_object("egg"), "egg"),
        (lambda: World("hazle"), "unknown house 'hazle'.*Did you mean 'hazel'"),
        (lambda: World(tiny.house(), robots=("tendr",)), "tendr.*Did you mean 'tender'"),
    )
    before = world.human.pose
    for call, words in cases:
        with pytest.raises(UnknownName, match=words):
            call()
    assert world.human.pose == before


def test_hands_say_why_not_for_ids_that_do_not_exist(world: World) -> None:
    for outcome in (world.human.pick("aple"), world.human.open("fridge|2"), world.human.place("tabel")):
        assert not outcome.ok
        assert outcome.reason


def test_a_long_list_of_names_is_cut() -> None:
    error = UnknownName("thing", "x", [f"thing_{k}" for k in range(100)])
    assert "thing_23 and 76 more" in str(error)
    assert "thing_24" not in str(error)
    assert len(error.valid) == 100, "who catches it has all of them"
    short = UnknownName("thing", "x", [f"thing_{k}" for k in range(24)])
    assert "more" not in str(short)
    house = World(houses.load("elder"), objects=())
    with pytest.raises(UnknownName, match=r"Valid: .* and \d+ more\.$") as caught:
        house.position("nothing at all")
    assert len(str(caught.value)) < 600


# -------------------------------------------------------------------------------------------------------------- asking


def test_counting_and_asking_agree(world: World) -> None:
    assert world.count("apple") == len(world.objects("apple")) == 1
    assert world.count("dining_table") == len(world.furniture("dining_table")) == 1
    assert {thing.room for thing in world.furniture(room="living room")} == {"room|2"}
    assert {state.id for state in world.objects(room="kitchen")} == {"apple", "mug", "book|old", "vase|1"}
    assert world.objects(room="room|2") == ()
    every = {state.id: state for state in world.truth()}
    assert all(world.state(id) == every[id] for id in every)
    assert world.position("human") == (MIDDLE.x, MIDDLE.y, world.bodies["human"].eye)
    world.remove_object("apple")
    assert world.count("apple") == 0
    with pytest.raises(UnknownName, match="apple"):
        world.state("apple")


def test_events_keep_what_steps_report(world: World) -> None:
    world.start("human", Open(thing=FRIDGE))
    news = world.step(3)
    assert world.events == list(news)
    assert [event.kind for event in news] == ["refused"]


def test_a_body_says_who_and_where_it_is(world: World) -> None:
    assert repr(world.robot) == "<tender 'robot' at (6.00, 3.00) in room|2>"
    assert world.human.room == "room|1"
