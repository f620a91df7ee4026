"""How a robot of a team gets past people: undisturbed by who is not in its way, round them, or out of theirs."""

from __future__ import annotations

import itertools
import math
from types import SimpleNamespace

import msgspec
import pytest
import world_house as tiny

from hthor.agents.skills.right_of_way.passing import Passing
from hthor.agents.skills.right_of_way.yielding import Yielding
from hthor.agents.skills.routes import HouseRoutes
from hthor.geometry.plane import turn
from hthor.navigation.path_follower import Follower
from hthor.types import Briefing, Detection, Motion, Move, Observation, Outcome, Pose, Rotate, Vec2, Wait
from hthor.world.model.bodies import bodies
from hthor.world.model.bodies.avatar import HUMAN

TENDER, PUCK = bodies.load_robot("tender"), bodies.load_robot("puck")
TICK_S = 0.1
HERE, GOAL = (5.5, 1.1), (5.5, 3.3)  # in the living room, with two metres of free floor beside it
KITCHEN, LIVING, DOORWAY = (4.2, 2.0), (6.2, 2.0), (5.0, 2.0)


def person(x: float, y: float) -> Detection:
    size = (0.4, 0.4, 1.7)
    return Detection(id="human", kind="person", family="person", position=(x, y, 0.9), size=size, yaw=0.0, distance=1.0)


def observe(here: Vec2 | Pose, *seen: Detection, seconds: float = 0.0, outcome: Outcome | None = None) -> Observation:
    pose = here if isinstance(here, Pose) else Pose(x=here[0], y=here[1])
    senses = SimpleNamespace(detections=lambda: seen)
    return Observation(tick=round(seconds / TICK_S), pose=pose, idle=True, senses=senses, outcome=outcome)


def after(pose: Pose, motion: Motion) -> Pose:
    """Where a motion leads that nothing stops."""
    if isinstance(motion, Rotate):
        return msgspec.structs.replace(pose, yaw=pose.yaw + motion.yaw)
    if not isinstance(motion, Move):
        return pose
    dx, dy = turn((motion.forward, motion.left), pose.yaw)
    return msgspec.structs.replace(pose, x=pose.x + dx, y=pose.y + dy)


@pytest.fixture
def passing() -> Passing:
    briefing = Briefing(
        seat="robot",
        instruction="",
        target="",
        destination="",
        relation="on",
        time_limit=90.0,
        body=TENDER,
        tick_s=TICK_S,
        house=tiny.house(),
        crew={"human": HUMAN, "robot": TENDER},
    )
    routes = HouseRoutes(tiny.house(), TENDER)
    return Passing(briefing, routes, Yielding(briefing, routes))


def on_the_way(here: Vec2 = HERE, goal: Vec2 = GOAL) -> Follower:
    follower = Follower()
    follower.take((here, goal))
    follower.next(Pose(x=here[0], y=here[1]))
    return follower


def test_who_is_not_in_the_way_is_no_reason_to_stop(passing):
    follower = on_the_way()
    assert passing.motion(observe(HERE, person(6.3, 2.2)), follower, is_free=False) is None
    assert passing.motion(observe(HERE, person(5.5, 0.6)), follower, is_free=False) is None, "behind it"
    assert follower.path == (HERE, GOAL)


def test_round_somebody_where_there_is_room(passing):
    follower, pose = on_the_way(), Pose(x=HERE[0], y=HERE[1])
    for step in range(40):
        motion = passing.motion(observe(pose, person(5.5, 2.2), seconds=0.6 * step), follower, is_free=False)
        motion = motion or follower.next(pose)
        if motion is None:
            break
        pose = after(pose, motion)
        assert math.dist((pose.x, pose.y), (5.5, 2.2)) > TENDER.radius + HUMAN.radius
    assert math.dist((pose.x, pose.y), GOAL) < 0.1


def test_stopped_by_furniture_on_its_way_round_it_tries_from_where_it_has_room(passing):
    """Otherwise it would make the same move at every tick."""
    follower, here = on_the_way(), (5.4, 1.1)
    stopped = Outcome(motion="move", ok=False, reason="sofa_1 is in the way", by="sofa_1")
    first = passing.motion(observe(here, person(5.5, 2.2)), follower, is_free=False)
    assert isinstance(first, Move)
    again = passing.motion(observe(here, person(5.5, 2.2), seconds=0.1, outcome=stopped), follower, is_free=False)
    assert isinstance(again, Move)
    pose = after(Pose(x=here[0], y=here[1]), again)
    assert (pose.x, pose.y) == pytest.approx(passing.routes.loose(here))
    assert again != first


def test_in_a_doorway_it_gets_out_of_the_way_and_goes_on_when_the_person_is_past(passing):
    follower, pose = on_the_way(KITCHEN, LIVING), Pose(x=KITCHEN[0], y=KITCHEN[1])
    for step in range(8):
        motion = passing.motion(observe(pose, person(*DOORWAY), seconds=0.4 * step), follower, is_free=False)
        assert motion is not None
        pose = after(pose, motion)
    assert math.dist((pose.x, pose.y), DOORWAY) > 1.0
    assert isinstance(motion, Wait)
    gone = observe(pose, person(0.8, 2.0), seconds=8 * 0.4 + 0.1)
    assert passing.motion(gone, follower, is_free=False) is None
    assert follower.path == passing.routes.way((pose.x, pose.y), LIVING)


def test_it_does_not_wait_for_ever_for_somebody_who_stays(passing):
    follower = on_the_way(KITCHEN, LIVING)
    motions = [
        passing.motion(observe(KITCHEN, person(*DOORWAY), seconds=0.5 * step), follower, is_free=False)
        for step in range(14)
    ]
    assert motions[0] is not None
    assert None in motions


def test_after_a_contact_it_stands_still_for_a_moment(passing):
    follower = on_the_way()
    bump = Outcome(motion="move", ok=False, reason="", by="human")
    assert passing.motion(observe(HERE, outcome=bump), follower, is_free=False) == Wait(seconds=0.3)


def test_with_nothing_to_do_it_steps_away_from_whoever_comes_close(passing):
    step = passing.motion(observe(HERE, person(5.5, 1.6)), Follower(), is_free=True)
    assert isinstance(step, Move)
    assert math.dist((HERE[0] + step.forward, HERE[1] + step.left), (5.5, 1.6)) > 0.6
    assert passing.motion(observe(HERE, person(5.5, 1.6)), Follower(), is_free=False) is None


def test_a_robot_that_stands_where_it_would_pass_is_dealt_with_first(passing):
    follower = on_the_way()
    assert isinstance(passing.motion(observe(HERE, person(5.5, 1.9)), follower, is_free=False), Move)
    bumped = Outcome(motion="move", ok=False, reason="robot2 is in the way", by="robot2")
    assert passing.motion(observe(HERE, person(5.5, 1.9), seconds=0.3, outcome=bumped), follower, is_free=False) is None


def yielding_of(seat: str) -> Yielding:
    """The right of way of a tender beside a puck."""
    briefing = Briefing(
        seat=seat,
        instruction="",
        target="",
        destination="",
        relation="on",
        time_limit=90.0,
        body=TENDER if seat == "robot" else PUCK,
        tick_s=TICK_S,
        house=tiny.house(),
        crew={"human": HUMAN, "robot": TENDER, "robot2": PUCK},
    )
    return Yielding(briefing, HouseRoutes(tiny.house(), briefing.body))


def a_robot(seat: str, x: float, y: float) -> Detection:
    size = (0.4, 0.4, 0.2)
    return Detection(id=seat, kind="puck", family="robot", position=(x, y, 0.1), size=size, yaw=0.0, distance=1.0)


def test_no_way_leads_through_a_robot_in_the_only_doorway():
    bumped = Outcome(motion="move", ok=False, reason="robot2 is in the way", by="robot2")
    seen = observe((4.6, 2.0), a_robot("robot2", *DOORWAY), outcome=bumped)
    assert yielding_of("robot").around(seen, LIVING) == (), "it has to go away first"


def test_a_way_round_a_robot_keeps_out_of_it():
    bumped = Outcome(motion="move", ok=False, reason="robot2 is in the way", by="robot2")
    other = (5.5, 1.9)
    way = yielding_of("robot").around(observe((5.5, 1.5), a_robot("robot2", *other), outcome=bumped), GOAL)
    assert way
    apart = TENDER.radius + PUCK.radius
    for a, b in itertools.pairwise(((5.5, 1.5), *way)):
        for k in range(11):
            point = (a[0] + k / 10 * (b[0] - a[0]), a[1] + k / 10 * (b[1] - a[1]))
            assert math.dist(point, other) >= min(apart, 0.4) - 0.03


def test_a_robot_without_work_makes_room_for_one_with_an_arm_that_stands_beside_it():
    idle = yielding_of("robot2")
    here, places = (5.5, 1.9), {"robot": (5.5, 1.4)}
    for tick in range(3):
        step = idle.give_way(observe(here, a_robot("robot", 5.5, 1.4), seconds=tick), places)
        assert isinstance(step, Move), "also while the other stands still"
    assert math.dist((here[0] + step.forward, here[1] + step.left), places["robot"]) > 0.6
