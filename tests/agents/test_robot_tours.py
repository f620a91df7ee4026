"""Robots that look around before a task, and what they record."""

from __future__ import annotations

import math

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from still_person import StillPerson
from worlds import world_of

from hthor import houses, tasks
from hthor.agents import frontier, oracle, silent
from hthor.agents.skills.touring.surface_survey import SurfaceSurvey
from hthor.agents.skills.touring.tour_record import TourRecord
from hthor.episode import Episode
from hthor.types import (
    AgentRef,
    Briefing,
    Detection,
    HumanSeat,
    Job,
    Observation,
    PhaseBriefing,
    Pose,
    Ready,
    RobotSeat,
    Thing,
    TrialSpec,
)
from hthor.world.robots import tender

TASK = next(task for task in tasks.load_suite("rearrange").tasks if task.id == "rearrange/cedar/01")
TABLE = Thing(id="table", kind="dining_table", asset="", centre=(2.0, 2.0, 0.37), size=(1.6, 0.9, 0.74), yaw=0.0)


class Eyes:
    def __init__(self, *seen: Detection) -> None:
        self.seen = seen

    def detections(self) -> tuple[Detection, ...]:
        return self.seen


def detection(id: str, x: float, far: float, **more: object) -> Detection:
    fields = {"id": id, "kind": id, "family": "object", "position": (x, 2.0, 0.8), "size": (0.1, 0.1, 0.1)}
    return Detection(**{**fields, "yaw": 0.0, "distance": far, **more})  # type: ignore[arg-type]


def look(*seen: Detection, phase: str = "tour") -> Observation:
    return Observation(tick=0, pose=Pose(x=0.0, y=0.0), idle=True, senses=Eyes(*seen), phase=phase)  # type: ignore[arg-type]


@given(st.permutations([0.5, 1.0, 1.4]))
def test_what_was_seen_from_nearest_is_recorded(order: list[float]) -> None:
    record = TourRecord(["mug", "apple"])
    for far in order:
        record.note(look(detection("mug", 2.0 + far / 100, far, support="table"), detection("book", 2.0, 0.1)))
    assert record.seen["mug"].distance == 0.5
    assert set(record.seen) == {"mug"}
    assert not record.complete
    job = record.job("mug", {"table": TABLE})
    assert job == Job(target="mug", relation="on", destinations=("table",), place=(2.005, 2.0, 0.8))
    assert record.job("apple", {}) is None


def test_what_somebody_holds_is_not_recorded() -> None:
    record = TourRecord(["mug"])
    record.note(look(detection("mug", 2.0, 1.0, held_by="human")))
    assert not record.seen


def test_a_support_is_guessed_where_the_detector_does_not_tell() -> None:
    record = TourRecord(["mug", "far"])
    record.note(look(detection("mug", 2.0, 1.0), detection("far", 4.0, 1.0)))
    job = record.job("mug", {"table": TABLE})
    assert job is not None
    assert job.destinations == ("table",)
    assert record.job("far", {"table": TABLE}) is None, "it lies on nothing that was seen"


def test_a_surface_is_looked_at_from_near_and_in_view_only() -> None:
    survey = SurfaceSurvey(tender.SPEC)
    survey.add([TABLE])
    whole = len(survey.left("table"))

    def see(x: float, yaw: float, clear: bool = True) -> int:
        survey.see(Pose(x=x, y=2.0, yaw=yaw, pitch=-0.5), [TABLE], lambda a, b: clear)
        return len(survey.left("table"))

    assert see(-1.0, 0.0) == whole, "too far away"
    assert see(0.8, math.pi) == whole, "behind the robot"
    assert see(0.8, 0.0, clear=False) == whole, "behind a wall"
    assert 0 < see(0.8, 0.0) < whole, "only the near end"
    see(3.2, math.pi)
    survey.drop("table")
    assert not survey.is_left("table")


def test_no_robot_keeps_anybody_waiting() -> None:
    mind = silent.Agent()
    assert mind.act(look()).signals == (Ready(),)
    assert mind.act(look(phase="")).signals == ()


def toured(kind: type, seconds: float) -> tuple[object, Episode]:
    """A robot's agent after its tour of the house, beside a person who stands still."""
    agent = AgentRef(name="a", source="", sha256="", privileges=kind.privileges)  # type: ignore[attr-defined]
    phase = msgspec.structs.replace(TASK.phases[0], time_limit=seconds)
    spec = TrialSpec(
        task=msgspec.structs.replace(TASK, phases=(phase,)),
        robots=(RobotSeat(seat="robot", robot="tender", agent=agent),),
        humans=(HumanSeat(seat="human", model="proxy", sha256="", participant=0),),
        session=0,
        index=0,
        seed=0,
        suite_sha256="",
        rules_sha256="",
        code_sha256="",
    )
    episode, mind, person = Episode(spec, world_of(TASK, ("tender",))), kind(), StillPerson()
    episode.reset()
    mind.begin(episode.briefing("robot"))
    while not episode.done:
        for seat in episode.waiting:
            seen = episode.observe(seat)
            if seat == "robot" and not seen.phase:
                mind.act(seen)
                return mind, episode
            action = mind.act(seen) if seat == "robot" else person.act(seen)
            ready = seat == "human"
            episode.submit(seat, msgspec.structs.replace(action, signals=(Ready(),)) if ready else action)
        episode.advance()
    raise AssertionError("the task never began")


@pytest.mark.parametrize("kind", [oracle.Agent, frontier.Agent])
def test_after_a_tour_a_robot_knows_what_it_saw_and_no_more(kind: type) -> None:
    mind, episode = toured(kind, 200.0)
    assert episode.tick < 2000, "it said that it was ready"
    policy = mind.policy if kind is oracle.Agent else mind.multi_object  # type: ignore[attr-defined]
    truth = {job.target: job for job in TASK.goal.jobs}
    assert {job.target for job in policy.jobs} == set(truth), "it saw all of them in this house"
    for job in policy.jobs:
        assert job.destinations == truth[job.target].destinations
        assert math.dist(job.place, truth[job.target].place) < 0.05


def test_what_was_not_seen_on_a_tour_is_left_to_others() -> None:
    mind, _ = toured(oracle.Agent, 30.0)
    jobs = mind.policy.jobs  # type: ignore[attr-defined]
    assert 0 < len(jobs) < len(TASK.goal.jobs)
    assert all(job.place is not None for job in jobs[1:])


def test_a_told_job_is_kept_as_it_was_told() -> None:
    from hthor.agents.skills.touring.tour import Tour

    told = (Job(target="mug", relation="on", destinations=("desk",)), Job(target="apple", relation="back"))
    briefing = Briefing(
        seat="robot",
        instruction="",
        target="mug",
        destination="desk",
        relation="on",
        body=tender.SPEC,
        tick_s=0.1,
        time_limit=90.0,
        house=houses.load("alder"),
        jobs=told,
        crew={"robot": tender.SPEC},
        phases=(PhaseBriefing(name="tour", instruction="", time_limit=60.0),),
    )
    after = Tour(briefing).briefing_after()
    assert after.jobs == told[:1]
    assert after.phases == ()
