"""The built-in agents where there is more to do than one thing: they carry, divide the work, and ask."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import msgspec
import pytest

from hthor import catalog, houses, plugins
from hthor.agents.skills import viewpoints
from hthor.agents.skills.audience import Audience
from hthor.agents.skills.joint_carrying.leadership import Leadership
from hthor.agents.skills.knowledge import Knowledge, resting_points
from hthor.agents.skills.message_timing import help_carry_text, look_inside_text
from hthor.agents.skills.routes import HouseRoutes
from hthor.agents.skills.task_allocation import TaskAllocation
from hthor.episode import EpisodeLog, play
from hthor.geometry import plane
from hthor.types import (
    HUMAN,
    Action,
    AgentRef,
    BodySpec,
    Briefing,
    Goal,
    HouseSpec,
    HumanSeat,
    Job,
    Observation,
    Placement,
    Pose,
    Receipt,
    Reply,
    RobotSeat,
    TaskSpec,
    Thing,
    ThingState,
    TrialSpec,
    Wait,
)
from hthor.world import World

SEATS = ("robot", "robot2", "robot3")
KINDS = ("multi_robot_collection", "room_rearrangement", "tidying_up", "collaborative_carrying")
HOUSE = "hazel"


class Bystander:
    """Somebody who stands in a corner and answers every message alike."""

    def __init__(self, accept: bool | None = None) -> None:
        self.accept = accept

    def begin(self, briefing: Briefing) -> None: ...

    def act(self, observation: Observation) -> Action:
        if self.accept is None or not observation.inbox:
            return Action(motion=Wait(seconds=1.0))
        return Action(motion=Wait(seconds=1.0), say=Reply(message=observation.inbox[-1].id, accept=self.accept))

    def rate(self, met: bool, tick: int) -> int | None: ...

    def state(self) -> dict[str, Any]:
        return {}


OBJECTS = (("apple", "apple"), ("apple_2", "apple"), ("apple_3", "apple"), ("mug", "mug"), ("trunk", "trunk"))


@functools.cache
def the_house() -> HouseSpec:
    return houses.load(HOUSE)


@functools.cache
def world(robots: tuple[str, ...]) -> World:
    """One world for all tasks with these bodies: it holds every object that any of them has."""
    return World(the_house(), robots=robots, objects=OBJECTS)


def run(task: TaskSpec, *robots: str, human: Any = None) -> tuple[EpisodeLog, float]:
    """Play a task with robots such as "tender:oracle"; also the share of it that was done."""
    cast = [robot.split(":") for robot in robots]
    minds: Mapping[str, Any] = {
        seat: plugins.load("agent", name)() for seat, (_, name) in zip(SEATS, cast, strict=False)
    }
    seats = tuple(
        RobotSeat(
            seat=seat,
            robot=body,
            agent=AgentRef(name=name, source=name, sha256="", privileges=plugins.load("agent", name).privileges),
        )
        for seat, (body, name) in zip(SEATS, cast, strict=False)
    )
    trial = TrialSpec(
        task=task,
        robots=seats,
        humans=(HumanSeat(seat="human", model="proxy", sha256="", participant=0),),
        session=0,
        index=0,
        seed=0,
        suite_sha256="",
        rules_sha256="",
        code_sha256="",
    )
    stage = world(tuple(body for body, _ in cast))
    log = play(trial, stage, {"human": human or Bystander()}, minds)
    kind = plugins.load("task kind", task.kind)
    return log, kind.progress(task, stage.snapshot(), stage.house)


def thing(id: str) -> Thing:
    return next(one for one in the_house().things if one.id == id)


def lying(id: str, kind: str, on: str, number: int = 0, u: float = 0.0, v: float = 0.0) -> Placement:
    """An object on the surface ``number`` of a thing of the house, ``u`` and ``v`` metres from its middle."""
    there, height = thing(on), catalog.kind(kind).size[2]
    surface = catalog.kind(there.kind).rests(there.size)[number]
    x, y, z = surface.centre
    position = plane.to_house((x + u, y + v, z + height / 2 + 0.005), there.centre, there.yaw)
    return Placement(id=id, kind=kind, position=position, support=on, relation=catalog.kind(there.kind).relation)


def task(kind: str, objects: tuple[Placement, ...], jobs: tuple[Job, ...], limit: float = 180.0) -> TaskSpec:
    house = the_house()
    first = jobs[0]
    return TaskSpec(
        id="made",
        kind=kind,
        house=HOUSE,
        house_sha256=house.sha256,
        human_start=Pose(x=1.0, y=0.6),
        robot_starts=(house.start,),
        objects=objects,
        goal=Goal(target=first.target, relation=first.relation, destination="", jobs=jobs if kind in KINDS else ()),
        instruction="Do it.",
        time_limit=limit,
        t_star=10.0,
    )


def starting(made: TaskSpec, robot: Pose) -> TaskSpec:
    """The same task with the robot somewhere else."""
    return msgspec.structs.replace(made, robot_starts=(robot,))


def said(log: EpisodeLog, seat: str = "robot") -> list[str]:
    return [event.text for event in log.events if event.kind == "sent" and event.seat == seat]


def apples(*places: tuple[str, int]) -> tuple[tuple[Placement, ...], tuple[Job, ...]]:
    """Apples on things, and the jobs to bring them to the dining table."""
    names = ["apple", "apple_2", "apple_3"][: len(places)]
    objects = tuple(lying(name, "apple", on, number) for name, (on, number) in zip(names, places, strict=True))
    return objects, tuple(Job(target=name, relation="on", destinations=("dining_table",)) for name in names)


# ------------------------------------------------------------------------------------------------------------ contract


def a_task(kind: str, limit: float) -> TaskSpec:
    if kind == "multi_robot_collection":
        return task(kind, *apples(("fridge", 1), ("desk", 0), ("stove", 0)), limit=limit)
    if kind == "collaborative_carrying":
        x, y = the_house().start.x, the_house().start.y
        trunk = Placement(id="trunk", kind="trunk", position=(x + 1.5, y, 0.2))
        job = Job(target="trunk", relation="at", place=(x - 1.5, y, 0.2), hands=2)
        return task(kind, (trunk,), (job,), limit=limit)
    mug, home = lying("mug", "mug", "desk"), lying("mug", "mug", "dining_table", u=0.3)
    place = home.position if kind == "room_rearrangement" else None
    destinations = ("dining_table",) if kind == "room_rearrangement" else ("dining_table", "counter_top")
    return task(kind, (mug,), (Job(target="mug", relation="on", destinations=destinations, place=place),), limit=limit)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("agent", [name for name in plugins.names("agent") if name in ("frontier", "oracle", "none")])
def test_every_agent_takes_part_in_every_kind_with_every_body(kind: str, agent: str) -> None:
    log, _ = run(a_task(kind, 8.0), f"tender:{agent}", f"puck:{agent}", f"porter:{agent}")
    assert not log.faults
    reasons = [event.reason for event in log.events if event.kind == "refused"]
    assert not [reason for reason in reasons if "cannot" in reason or "at most" in reason or "no object" in reason]


def test_the_same_trial_goes_the_same_way() -> None:
    made = a_task("multi_robot_collection", 25.0)
    logs = [run(made, "tender:oracle", "puck:frontier", "porter:none")[0] for _ in range(2)]
    assert logs[0] == logs[1]


# ------------------------------------------------------------------------------------------------------------ carrying


def test_the_oracle_gathers_what_lies_about_and_opens_the_fridge_for_it() -> None:
    log, share = run(task("multi_robot_collection", *apples(("fridge", 1), ("desk", 0))), "tender:oracle")
    assert (log.met, share) == (True, 1.0)
    assert [event.thing for event in log.events if event.kind == "opened"] == ["fridge"]
    assert said(log)[0].startswith("I put the apple on the dining table"), "so that nobody looks for it any longer"


def test_two_oracles_do_not_fetch_the_same_thing() -> None:
    log, _ = run(task("multi_robot_collection", *apples(("fridge", 1), ("desk", 0))), "tender:oracle", "tender:oracle")
    picked = {event.seat: event.object for event in log.events if event.kind == "picked"}
    assert log.met
    assert sorted(picked.values()) == ["apple", "apple_2"], "each has fetched one"


def test_the_oracle_puts_things_back_exactly() -> None:
    made = a_task("room_rearrangement", 180.0)
    log, _ = run(made, "tender:oracle")
    assert log.met
    assert [event.kind for event in log.events].count("placed") == 1
    place = made.goal.jobs[0].place
    state = world(("tender",)).state("mug")
    assert place is not None
    assert math.dist(state.position[:2], place[:2]) < 0.05


def test_what_is_out_of_place_is_tidied_up() -> None:
    log, _ = run(a_task("tidying_up", 180.0), "tender:oracle")
    assert log.met


def test_the_frontier_robot_carries_what_it_has_seen_to_where_it_has_seen() -> None:
    jobs = (Job(target="mug", relation="on", destinations=("bed",)),)
    made = task("tidying_up", (lying("mug", "mug", "desk"),), jobs)
    made = starting(made, Pose(x=12.9, y=8.75, yaw=0.5))
    log, _ = run(made, "tender:frontier")
    assert [event.kind for event in log.events if event.kind in ("picked", "placed")] == ["picked", "placed"]
    assert log.met


def test_what_lies_well_is_left_alone() -> None:
    mug, apple = lying("mug", "mug", "desk"), lying("apple", "apple", "dining_table")
    jobs = (
        Job(target="mug", relation="on", destinations=("dining_table",)),
        Job(target="apple", relation="on", destinations=("dining_table",)),
    )
    log, _ = run(task("tidying_up", (mug, apple), jobs), "tender:oracle")
    assert [event.object for event in log.events if event.kind == "picked"] == ["mug"]


def test_two_robots_carry_what_is_too_heavy_for_one() -> None:
    log, _ = run(a_task("collaborative_carrying", 120.0), "porter:oracle", "porter:oracle")
    kinds = [event.kind for event in log.events]
    assert kinds.count("held") == 2
    assert "lifted" in kinds
    assert log.met


def test_one_robot_asks_for_a_hand() -> None:
    log, _ = run(a_task("collaborative_carrying", 40.0), "porter:oracle")
    assert said(log) == [help_carry_text("trunk", held=False)]
    log, _ = run(a_task("collaborative_carrying", 60.0), "porter:frontier")
    assert said(log) == [help_carry_text("trunk", held=True)]


# ------------------------------------------------------------------------------------------------------------- telling


def test_who_cannot_open_the_fridge_asks_the_person_to_look_inside() -> None:
    made = task("multi_robot_collection", *apples(("fridge", 1), ("desk", 0)), limit=60.0)
    log, _ = run(made, "puck:oracle")
    assert said(log)[0] == "I cannot open the fridge in front of me. Please look inside for the apple."
    event = next(event for event in log.events if event.kind == "sent")
    assert event.object == "apple"


def test_it_asks_again_ten_seconds_after_it_was_turned_down() -> None:
    made = task("multi_robot_collection", *apples(("fridge", 1)), limit=60.0)
    log, _ = run(made, "puck:oracle", human=Bystander(accept=False))
    sent = [event.tick for event in log.events if event.kind == "sent"]
    declined = [event.tick for event in log.events if event.kind == "declined"]
    assert len(sent) >= 2
    assert declined[0] + 100 <= sent[1] <= declined[0] + 150


def test_the_frontier_robot_asks_for_what_it_has_not_seen() -> None:
    made = task("multi_robot_collection", *apples(("fridge", 1)), limit=15.0)
    made = starting(made, Pose(x=1.3, y=4.1, yaw=math.pi))
    log, _ = run(made, "puck:frontier")
    assert look_inside_text("fridge", ("apple",)) in said(log)
    event = next(event for event in log.events if event.kind == "sent")
    assert event.object == "fridge", "it does not claim that the apple is there"


def test_in_the_papers_kinds_nobody_asks() -> None:
    (apple,), _ = apples(("fridge", 1))
    for agent in ("oracle", "frontier"):
        made = task("object_goal_navigation", (apple,), (Job(target="apple", relation="find"),), limit=20.0)
        made = starting(made, Pose(x=1.3, y=4.1, yaw=math.pi))
        log, _ = run(made, f"puck:{agent}")
        assert not [text for text in said(log) if "cannot open" in text]


# ---------------------------------------------------------------------------------------------------- dividing the work


def body(name: str, *capabilities: Any) -> BodySpec:
    spec = plugins.load("robot", "tender")
    fields = {field: getattr(spec, field) for field in BodySpec.__struct_fields__}
    return BodySpec(**fields | {"name": name, "capabilities": frozenset(("navigate", *capabilities))})


def crew(me: str, *places: tuple[str, float], **bodies: BodySpec) -> tuple[TaskAllocation, Knowledge, tuple[Job, ...]]:
    """Apples on a line, by name and x, to be brought to x = 0."""
    knowledge = Knowledge()
    knowledge.states = {
        name: ThingState(id=name, kind="apple", position=(x, 0.0, 0.7), support="shelf") for name, x in places
    }
    jobs = tuple(Job(target=name, relation="on", place=(0.0, 0.0, 0.7)) for name, _ in places)
    told = Briefing(
        seat=me,
        instruction="",
        target=places[0][0],
        destination="",
        relation="on",
        body=bodies[me],
        tick_s=0.1,
        time_limit=90.0,
        jobs=jobs,
        crew=bodies,
    )
    return TaskAllocation(told, lambda here, place: math.dist(here, place[:2])), knowledge, jobs


def test_everybody_gets_another_job() -> None:
    hands = body("hands", "pick", "open")
    team, knowledge, jobs = crew("robot", ("near", 1.0), ("far", 9.0), human=hands, robot=hands, robot2=hands)
    team.places |= {"human": (30.0, 0.0), "robot": (0.0, 0.0), "robot2": (9.5, 0.0)}
    share = team.share(jobs, knowledge)
    assert {seat: job.target for seat, job in share.items()} == {"robot": "near", "robot2": "far"}


def test_whoever_has_something_in_hand_gets_no_job() -> None:
    hands = body("hands", "pick", "open")
    team, knowledge, jobs = crew("robot", ("one", 1.0), ("two", 2.0), robot=hands)
    knowledge.states = {**knowledge.states, "x": ThingState(id="x", kind="mug", position=(0, 0, 1), held_by="robot")}
    assert team.share(jobs, knowledge) == {}


def test_the_person_is_left_what_is_nearest_to_its_place_where_somebody_can_tell_them() -> None:
    hands, wheels = body("hands", "pick", "open"), body("wheels")
    bodies = {"human": hands, "robot": hands, "robot2": wheels}
    places = (("near", 2.0), ("far", 9.0), ("middle", 5.0))
    for me in ("robot", "robot2"):
        team, knowledge, jobs = crew(me, *places, **bodies)
        assert team.reserved(jobs, knowledge) == "near", "all come to the same answer"
    team, knowledge, jobs = crew("robot", *places, human=hands, robot=hands)
    assert team.reserved(jobs, knowledge) == "", "with nobody to tell them, nothing is kept for the person"


def test_points_to_put_things_on_lie_on_the_thing() -> None:
    table = thing("dining_table")
    points = resting_points(table, 0.1)
    assert len(points) > 20
    for x, y, z in points:
        u, v, _ = plane.to_local((x, y, z), table.centre, table.yaw)
        assert abs(u) <= table.size[0] / 2 - 0.1 + 1e-9
        assert abs(v) <= table.size[1] / 2 - 0.1 + 1e-9
        assert z == pytest.approx(table.centre[2] + table.size[2] / 2, abs=0.05)


def test_the_closest_thing_is_the_one_with_the_shortest_way() -> None:
    house = the_house()
    routes = HouseRoutes(house, body("tall"))
    tables = [thing for thing in house.things if resting_points(thing, 0.0)]
    starts = [(room.polygon[0][0] + 1.0, room.polygon[0][1] + 1.0) for room in house.rooms]
    chosen = set()
    for here in [*starts, tables[0].centre[:2]]:  # the last one is no place to stand: no way begins there
        ways = [viewpoints.path_to_reach(routes, here, resting_points(thing, 0.0), 0.8, thing) for thing in tables]
        far = [
            (viewpoints.path_length(way) if way else math.inf, thing.id)
            for way, thing in zip(ways, tables, strict=True)
        ]
        closest = viewpoints.closest_thing(routes, here, tables, lambda thing: resting_points(thing, 0.0), 0.8)
        assert closest.id == min(far)[1]
        chosen.add(closest.id)
    assert len(chosen) > 2


def test_the_closest_of_things_without_a_way_is_the_first_by_id() -> None:
    routes = HouseRoutes(the_house(), body("tall"))
    outside = [msgspec.structs.replace(thing("dining_table"), id=id, centre=(-50.0, 0.0, 0.4)) for id in ("b", "a")]
    closest = viewpoints.closest_thing(
        routes, routes.space.nearest_free(2.0, 2.0), outside, lambda one: resting_points(one, 0.0), 0.8
    )
    assert closest.id == "a"


def test_seats_are_sorted_as_they_are_numbered() -> None:
    from hthor.agents.skills.task_allocation import seat_order

    assert sorted(["robot10", "robot2", HUMAN, "robot"], key=seat_order) == [HUMAN, "robot", "robot2", "robot10"]


# ------------------------------------------------------------------------------------------------- several people


def test_of_several_people_each_is_told_about_another_job() -> None:
    hands = body("hands", "pick", "open")
    team, knowledge, jobs = crew("robot", ("one", 1.0), ("two", 2.0), human=hands, human2=hands, robot=hands)
    team.places |= {"human": (1.0, 0.0), "human2": (6.0, 0.0)}
    audience = Audience(team, 0.1)
    assert audience.choose(jobs[0], knowledge) == "human", "the nearer one"
    audience.note("human", jobs[0])
    assert audience.choose(jobs[0], knowledge) == "human2", "who has not been told yet"
    assert audience.choose(jobs[1], knowledge) == "human"
    accepted = Receipt(message=0, status="accepted", tick=3, by="human")
    audience.hear(SimpleNamespace(receipt=accepted), knowledge)
    assert audience.choose(jobs[1], knowledge) == "human2", "the other is on the way"
    assert audience.has_somebody_else(jobs[0], knowledge)
    knowledge.states = {**knowledge.states, "x": ThingState(id="x", kind="mug", position=(0, 0, 1), held_by="human2")}
    assert not audience.has_somebody_else(jobs[0], knowledge)


def test_somebody_who_accepted_is_on_the_way_for_as_long_as_the_walk_takes() -> None:
    hands = body("hands", "pick", "open")
    team, knowledge, jobs = crew("robot", ("near", 1.0), ("far", 16.0), human=hands, human2=hands, robot=hands)
    team.places |= {"human": (0.0, 0.0), "human2": (0.0, 0.0)}
    audience = Audience(team, 0.1)
    audience.note("human", jobs[1])
    audience.hear(SimpleNamespace(receipt=Receipt(message=0, status="accepted", tick=0, by="human")), knowledge)
    team.tick = 390  # 16 m at 0.4 m/s take 40 s
    assert audience.choose(jobs[0], knowledge) == "human2"
    team.tick = 410
    assert audience.choose(jobs[0], knowledge) == "human"


@pytest.mark.parametrize(("first", "second"), [("robot", "robot2"), ("robot2", "robot")])
def test_of_two_robots_with_a_load_the_one_in_front_leads_and_the_other_where_it_sticks(first, second) -> None:
    places = {first: (1.0, 0.0), second: (0.0, 0.0)}
    leadership = Leadership(0.1, places.__getitem__, math.dist)

    def leader(tick: int, x: float) -> str:
        state = ThingState(id="x", kind="trunk", position=(x, 0.0, 0.5), bearers=(second, first))
        return leadership.leader(tick, state, (9.0, 0.0, 0.0))

    assert leader(0, 0.5) == first
    places.update({first: (0.0, 0.0), second: (1.0, 0.0)})
    assert leader(30, 1.0) == first, "who leads is settled when they lift it"
    assert leader(69, 1.05) == first
    assert leader(70, 1.05) == second, "it has not moved for four seconds"
    assert leader(100, 1.2) == second
    assert leader(140, 1.2) == first


def test_a_robot_leads_people_and_alone_people_lead_themselves() -> None:
    leadership = Leadership(0.1, lambda _: (0.0, 0.0), math.dist)
    for bearers, leads in ((("human", "robot2"), "robot2"), (("human2", "human"), "human")):
        state = ThingState(id="x", kind="trunk", position=(0.0, 0.0, 0.5), bearers=bearers)
        assert leadership.leader(0, state, (9.0, 0.0, 0.0)) == leads


def test_the_only_person_is_told_as_everybody_is() -> None:
    hands = body("hands", "pick", "open")
    team, knowledge, jobs = crew("robot", ("one", 1.0), human=hands, robot=hands)
    audience = Audience(team, 0.1)
    assert audience.choose(jobs[0], knowledge) == ""
    assert not audience.has_somebody_else(jobs[0], knowledge)
