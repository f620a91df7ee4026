"""A load for two in a house with one door: who takes which end, who leads, what is done when it is stuck."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Sequence

import msgspec
import pytest
import world_house as tiny
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import plugins
from hthor.agents.skills.joint_carrying.handle_choice import HandleChoice
from hthor.agents.skills.joint_carrying.leadership import Leadership
from hthor.agents.skills.joint_carrying.towing import Towing
from hthor.agents.skills.message_timing import MessageTiming
from hthor.agents.skills.routes import HouseRoutes
from hthor.agents.skills.routes_around import RoutesAround, discs_around
from hthor.agents.skills.viewpoints import path_length
from hthor.episode import EpisodeLog, play
from hthor.geometry import plane
from hthor.humans.models.proxy import Model
from hthor.humans.population.participant import Participant
from hthor.navigation.detours import Disc
from hthor.types import (
    HUMAN,
    AgentRef,
    BodySpec,
    Briefing,
    Goal,
    HumanSeat,
    Job,
    Placement,
    Pose,
    Receipt,
    RobotSeat,
    ThingState,
    TrialSpec,
    Vec2,
    Vec3,
)
from hthor.types.events import Blocked
from hthor.world import World
from hthor.world.model.bodies import bodies
from hthor.world.model.bodies.avatar import HUMAN as PERSON

PORTER, PUCK = bodies.load_robot("porter"), bodies.load_robot("puck")
HEIGHT_M, HALF_M, DEEP_M = 0.2, 0.4, 0.4
LIVING = (6.3, 3.2, HEIGHT_M)
"""A place in the living room."""
ROOMS = ((2.5, 1.1), (6.3, 3.2))
"""A free place in each of the two rooms."""


def routes(body: BodySpec = PORTER, *others: BodySpec) -> HouseRoutes:
    return HouseRoutes(tiny.house(), body, others)


def handle_choice() -> HandleChoice:
    made = routes()

    def length(a: Vec2, b: Vec2) -> float:
        return path_length((a, *made.way(a, b)))

    return HandleChoice(PORTER, made, length, ROOMS)


def outline(middle: Vec3, yaw: float) -> tuple[Disc, ...]:
    return discs_around(middle, (2 * HALF_M, DEEP_M), yaw, PORTER.radius)


def load(x: float, y: float, *bearers: str, up: bool = True) -> ThingState:
    held_by = bearers[0] if bearers and up else ""
    return ThingState(id="trunk", kind="trunk", position=(x, y, 0.5), held_by=held_by, bearers=bearers)


# ------------------------------------------------------------------------------------------------------- which end


def test_the_end_in_front_is_taken_where_the_helper_gets_past() -> None:
    middle = (6.2, 2.9, HEIGHT_M)
    ends = HandleChoice.ends(middle, math.pi / 2, HALF_M)
    first = handle_choice().before_helper(ends, middle, (4.2, 1.6, HEIGHT_M), outline(middle, math.pi / 2))
    assert first[0] == min(ends, key=lambda end: end[1]), "the end towards the door"


def test_an_end_in_the_only_doorway_is_not_taken_first() -> None:
    middle = (4.2, 2.0, HEIGHT_M)
    left, right = sorted(HandleChoice.ends(middle, 0.0, HALF_M))
    choice = handle_choice()
    stand = choice.stand(right, middle, outline(middle, 0.0))
    assert stand is not None
    assert 4.9 < stand[0] < 5.3, "who takes this end stands in the doorway"
    assert right not in choice.before_helper((left, right), middle, LIVING, outline(middle, 0.0))


def test_a_stand_is_free_floor_nearer_to_its_own_handle() -> None:
    choice, made = handle_choice(), routes()
    for x, y, yaw in ((4.2, 2.0, 0.0), (6.2, 2.9, 1.0), (8.4, 1.2, 0.4), (1.0, 2.6, 1.5)):
        middle = (x, y, HEIGHT_M)
        ends = HandleChoice.ends(middle, yaw, HALF_M)
        for end, other in (ends, ends[::-1]):
            stand = choice.stand(end, middle, outline(middle, yaw))
            if stand is not None:
                assert made.stands(stand[:2])
                off = plane.distance_to_rectangle(stand[:2], (x, y), (2 * HALF_M, DEEP_M), yaw)
                assert off > PORTER.radius, "not on the trunk"
                assert math.dist(stand[:2], end[:2]) < math.dist(stand[:2], other[:2])


# -------------------------------------------------------------------------------------------------- round the trunk


@given(
    x=st.floats(0.8, 9.2),
    y=st.floats(0.8, 3.2),
    yaw=st.floats(-math.pi, math.pi),
    a=st.tuples(st.floats(0.5, 9.5), st.floats(0.5, 3.5)),
    b=st.tuples(st.floats(0.5, 9.5), st.floats(0.5, 3.5)),
)
@example(x=1.03125, y=3.0, yaw=2.0, a=(1.0, 1.0), b=(2.0, 3.0))  # the shortest path has a bend beside the trunk
@settings(max_examples=cases(60))
def test_a_route_round_the_trunk_keeps_off_it(x: float, y: float, yaw: float, a: Vec2, b: Vec2) -> None:
    around = RoutesAround(routes(), outline((x, y, HEIGHT_M), yaw))
    here, spot = (routes().space.nearest_free(*point) for point in (a, b))
    assume(around.stands(here) and around.stands(spot))
    way = around.way(here, spot)
    for start, end in itertools.pairwise((here, *way) if way else ()):
        for share in range(21):
            point = (start[0] + share / 20 * (end[0] - start[0]), start[1] + share / 20 * (end[1] - start[1]))
            off = plane.distance_to_rectangle(point, (x, y), (2 * HALF_M, DEEP_M), yaw)
            assert off > PORTER.radius - 0.05, "half a cell of the grid"
    assert not way or way[-1] == spot


def test_a_body_at_the_trunk_steps_back_before_it_goes_round() -> None:
    middle, here, beyond = (6.2, 2.4, HEIGHT_M), (5.75, 2.4), (6.85, 2.6)
    around = RoutesAround(routes(), outline(middle, math.pi / 2))
    assert routes().stands(here)
    assert not around.stands(here), "the trunk is not on the map"
    first = around.loose(here)
    assert math.dist(first, middle[:2]) > math.dist(here, middle[:2])
    assert around.way(here, beyond)[0] == first
    assert path_length((here, *around.way(here, beyond))) > math.dist(here, beyond) + 0.1


# -------------------------------------------------------------------------------------------------------- who leads

PLACES = {HUMAN: (2.0, 0.0), "robot": (0.0, 0.0), "robot2": (1.0, 0.0)}


def leadership() -> Leadership:
    return Leadership(0.1, PLACES.__getitem__, math.dist)


def test_the_one_in_front_leads_also_if_it_is_a_person() -> None:
    assert leadership().leader(0, load(1.0, 0.0, HUMAN, "robot"), (5.0, 0.0, 0.0)) == HUMAN
    assert leadership().leader(0, load(1.0, 0.0, HUMAN, "robot"), (-5.0, 0.0, 0.0)) == "robot"


def test_a_robot_does_not_lead_from_behind_but_gives_up() -> None:
    """From behind it would walk past the person, to the same side of the load."""
    made, ahead = leadership(), (5.0, 0.0, 0.0)
    for tick in range(100):
        assert made.leader(tick, load(1.0, 0.0, HUMAN, "robot"), ahead) == HUMAN
        assert not made.is_stuck
    made.leader(100, load(1.0, 0.0, HUMAN, "robot"), ahead)
    assert made.is_stuck
    made.forget()
    made.leader(101, load(1.0, 0.0, HUMAN, "robot"), ahead)
    assert not made.is_stuck


def test_what_moves_is_not_stuck() -> None:
    made = leadership()
    for tick in range(0, 300, 5):
        made.leader(tick, load(0.02 * tick, 0.0, HUMAN, "robot"), (9.0, 0.0, 0.0))
        assert not made.is_stuck


def test_what_gets_no_closer_is_put_down_a_little_farther_away() -> None:
    near, beside = load(0.0, 0.4, HUMAN), load(0.0, 0.6, HUMAN)
    place = (0.0, 0.0, 0.5)
    assert Towing.is_there(near, place, still_s=0.0)
    assert not Towing.is_there(beside, place, still_s=0.0)
    assert Towing.is_there(beside, place, still_s=4.0)


# ------------------------------------------------------------------------------------------------------ asking again


def test_a_request_is_repeated_when_nobody_comes() -> None:
    briefing = Briefing(
        seat="robot",
        instruction="",
        target="trunk",
        destination="",
        relation="at",
        time_limit=180.0,
        body=PORTER,
        tick_s=0.1,
    )
    accepted = Receipt(message=0, status="accepted", tick=20, by=HUMAN)
    once, again = MessageTiming(briefing, most=2), MessageTiming(briefing, most=2, repeat_s=40.0)
    for timing in (once, again):
        assert timing.due(0, None)
        timing.note(0)
    assert [timing.due(399, accepted) for timing in (once, again)] == [False, False]
    assert [timing.due(400, accepted) for timing in (once, again)] == [False, True]
    again.note(400)
    assert not again.due(2000, accepted), "not more often than allowed"


# ------------------------------------------------------------------------------------------------------ where to wait


def test_a_small_robot_waits_where_it_bars_no_passage_of_large_ones() -> None:
    large = routes(PERSON)
    for here in ((5.0, 2.0), (6.3, 1.2), (3.0, 1.2)):
        for way in (
            routes(PUCK, PERSON).retreat(here, here, 1.0),
            routes(PUCK, PERSON, PORTER).retreat(here, here, 1.0),
        ):
            assert way
            assert large.stands(way[-1]), "a person could stand there, so the floor around it is what people see of it"
            assert math.dist(way[-1], (5.0, 2.0)) > 1.0, "not in the doorway"


# ---------------------------------------------------------------------------------------------- the house with one door


@functools.cache
def porters(count: int) -> World:
    return World(tiny.house(), robots=["porter"] * count, objects=[("trunk", "trunk")])


def carry(trunk: Placement, human: Pose, robots: Sequence[Pose], participant: int, seconds: float = 90.0) -> EpisodeLog:
    """A person and porters bring the trunk from the kitchen to the living room."""
    job = Job(target="trunk", relation="at", destinations=("room|2",), place=LIVING, hands=2)
    goal = Goal(target="trunk", relation="at", destination="sofa", jobs=(job,))
    made = msgspec.structs.replace(
        tiny.task(trunk, human=human, robots=tuple(robots)),
        kind="collaborative_carrying",
        goal=goal,
        instruction="Carry the trunk to the living room and put it down. It takes two.",
        time_limit=seconds,
    )
    oracle = plugins.load("agent", "oracle")
    ref = AgentRef(name="oracle", source="oracle", sha256="", privileges=oracle.privileges)
    seats = ("robot", "robot2")[: len(robots)]
    trial = TrialSpec(
        task=made,
        robots=tuple(RobotSeat(seat=seat, robot="porter", agent=ref) for seat in seats),
        humans=(HumanSeat(seat=HUMAN, model="proxy", sha256="", participant=participant),),
        session=0,
        index=0,
        seed=0,
        suite_sha256="",
        rules_sha256="",
        code_sha256="",
    )
    model = Model(Participant(seed=0, number=participant))
    log = play(trial, porters(len(seats)), {HUMAN: model}, {seat: oracle() for seat in seats})
    assert not log.faults
    return log


@pytest.mark.parametrize("participant", range(3))
def test_the_trunk_gets_through_the_only_door(participant: int) -> None:
    trunk = Placement(id="trunk", kind="trunk", position=(4.1, 2.0, HEIGHT_M), yaw=0.0, support="room|1")
    human, robot = Pose(x=1.2, y=1.2), Pose(x=6.0, y=3.0, yaw=math.pi)
    assert carry(trunk, human, [robot], participant).met


@pytest.mark.parametrize("participant", range(2))
def test_a_porter_goes_round_the_trunk_to_the_free_end(participant: int) -> None:
    """They come from the same side: one of them has to get past the trunk, which stops bodies."""
    trunk = Placement(id="trunk", kind="trunk", position=(3.2, 2.0, HEIGHT_M), yaw=0.0, support="room|1")
    human, robot = Pose(x=1.2, y=1.2), Pose(x=1.2, y=2.6)
    log = carry(trunk, human, [robot], participant)
    assert log.met
    assert sum(isinstance(event, Blocked) and event.by == "trunk" for event in log.events) < 20


def test_two_porters_do_not_stand_off_in_the_only_door() -> None:
    trunk = Placement(id="trunk", kind="trunk", position=(3.2, 2.0, HEIGHT_M), yaw=0.0, support="room|1")
    starts = [Pose(x=6.0, y=2.0, yaw=math.pi), Pose(x=1.0, y=2.6)]
    log = carry(trunk, Pose(x=7.5, y=1.0), starts, 0, seconds=180.0)
    assert log.met
