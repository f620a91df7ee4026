"""The person's path is the same with any robot as with none, until a message is shown or the robot is in the way."""

from __future__ import annotations

import msgspec
import pytest

from hthor import rules, tasks
from hthor.episode import EpisodeLog, play
from hthor.tasks.suite import make_suite
from hthor.trials import TrialRunner
from hthor.trials.sessions import make_sessions
from hthor.types import HUMAN, Action, Briefing, Move, Observation, Rotate

PEOPLE = 2
TRIALS = 4
HOUSES = ("elder", "hazel")


class Wanderer:
    """Walks about and says nothing."""

    def begin(self, briefing: Briefing) -> None:
        self.turn = 0.9

    def act(self, observation: Observation) -> Action:
        if observation.outcome is not None and not observation.outcome.ok:
            return Action(motion=Rotate(yaw=self.turn))
        return Action(motion=Move(forward=0.4, left=0.1))


class Spinner:
    """Stays where it is, turns round and round, and says nothing."""

    def begin(self, briefing: Briefing) -> None:
        self.turn = 0.7

    def act(self, observation: Observation) -> Action:
        return Action(motion=Rotate(yaw=self.turn))


@pytest.fixture(scope="module")
def stage() -> TrialRunner:
    return TrialRunner()


@pytest.fixture(scope="module")
def alone(stage: TrialRunner) -> list[EpisodeLog]:
    return first_trials("silent", stage)


@pytest.fixture(scope="module")
def spun(stage: TrialRunner) -> list[EpisodeLog]:
    return first_trials("frontier", stage, Spinner())


@pytest.fixture(scope="module")
def wandered(stage: TrialRunner) -> list[EpisodeLog]:
    return first_trials("frontier", stage, Wanderer())


def first_trials(agent: str, stage: TrialRunner, mind: object = None) -> list[EpisodeLog]:
    """The first trials of a few people, in a few houses."""
    smoke, logs = tasks.load_suite("smoke"), []
    few = make_suite("few", 1, tuple(task for task in smoke.tasks if task.house in HOUSES))
    for session in make_sessions(few, agent=agent)[:PEOPLE]:
        with stage.enter(session) as company:
            for trial in session.trials[:TRIALS]:
                robots = {"robot": mind} if mind else company.ready_agents()
                logs.append(play(trial, stage.world(trial), company.humans, robots))
    return logs


def meeting(log: EpisodeLog) -> int:
    """The first tick at which the robot can have made a difference; the trial's end if it never did."""
    return min(
        (
            event.tick
            for event in log.events
            if event.kind == "shown" or (event.kind == "in_way" and event.seat == HUMAN)
        ),
        default=log.ticks,
    )


@pytest.mark.parametrize("agent", ["frontier", "oracle"])
def test_until_they_meet_the_person_is_alone(agent: str, stage: TrialRunner, alone: list[EpisodeLog]) -> None:
    apart = 0
    for without, together in zip(alone, first_trials(agent, stage), strict=True):
        until = min(meeting(together), without.ticks)
        same = until // rules.LOG_EVERY_TICKS
        assert together.paths[HUMAN][: same + 1] == without.paths[HUMAN][: same + 1]
        before = [event for event in together.events if event.seat == HUMAN and event.tick < until]
        assert before == [event for event in without.events if event.seat == HUMAN and event.tick < until]
        apart += until
    assert apart > PEOPLE * TRIALS * 20, "they met at once every time, so this test showed nothing"


def test_a_robot_that_is_never_in_the_way_changes_nothing_at_all(
    alone: list[EpisodeLog], wandered: list[EpisodeLog]
) -> None:
    undisturbed = 0
    for without, together in zip(alone, wandered, strict=True):
        if meeting(together) >= together.ticks:
            assert together.paths[HUMAN] == without.paths[HUMAN]
            assert together.ticks == without.ticks
            undisturbed += 1
    assert undisturbed, "the wanderer got in everybody's way, so this test showed nothing"


def person(log: EpisodeLog) -> bytes:
    """All that a trial's log has of the person, as it is written."""
    events = [event for event in log.events if event.seat == HUMAN]
    return msgspec.json.encode(
        (log.paths[HUMAN], events, log.journal, log.ticks, log.met, log.ratings, log.idle[HUMAN])
    )


def test_two_robots_that_neither_speak_nor_stand_in_the_way_meet_the_same_person(
    spun: list[EpisodeLog], wandered: list[EpisodeLog]
) -> None:
    """Byte for byte: path, stick, pitch, attempts, glimpses, choices, trust."""
    apart = 0
    for turning, walking in zip(spun, wandered, strict=True):
        if meeting(turning) >= turning.ticks and meeting(walking) >= walking.ticks:
            assert person(turning) == person(walking)
            apart += turning.paths["robot"] != walking.paths["robot"]
    assert apart > 2, "the robots were hardly ever out of the way, so this test showed nothing"


def test_the_person_alone_is_the_same_person(alone: list[EpisodeLog], spun: list[EpisodeLog]) -> None:
    """Without a robot nobody is asked how far they trust it; all else is the same, byte for byte."""
    same = 0
    for without, turning in zip(alone, spun, strict=True):
        if meeting(turning) >= turning.ticks:
            assert person(msgspec.structs.replace(turning, ratings={HUMAN: None})) == person(without)
            same += 1
    assert same > 2
