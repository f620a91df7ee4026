"""Questions and answers in whole trials: a person asks the built-in robots, and robots ask a person."""

from __future__ import annotations

import math
from itertools import pairwise, takewhile
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import pytest
import world_house as tiny
from world_house import COUNTER, FRIDGE, on

from hthor import plugins
from hthor.episode import EpisodeLog, play
from hthor.eval.records import trial_record
from hthor.humans.communication import asking, speech
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import Participant
from hthor.types import HUMAN, AgentRef, Goal, HumanSeat, Pose, RobotSeat, TaskSpec, TrialSpec
from hthor.types.events import Accepted, Answered, Asked, Event, Offer, Replied, Sent, Shown
from hthor.world import World

BLIND = msgspec.structs.replace(Parameters(), lam0=1e-9, p_slip=0.0)
"""Somebody who never notices the apple, so that the robot finds it first."""
STUBBORN = msgspec.structs.replace(BLIND, a0=-20.0, p_ignore=1.0)
"""Somebody who follows nobody, and says nothing."""
OBEDIENT = msgspec.structs.replace(BLIND, a0=20.0)
E = TypeVar("E")


@pytest.fixture(scope="module")
def world() -> World:
    return World(tiny.house(), robots=("scout",), objects=[("apple", "apple")])


def bring(support: str) -> TaskSpec:
    """Bring the apple to the bed; the robot begins in the kitchen, where it is, and the person in the other room."""
    starts = {"human": Pose(x=9.2, y=1.2, yaw=math.pi), "robots": (Pose(x=4.0, y=2.0, yaw=math.pi),)}
    made = tiny.task(on(support, "apple"), **starts)  # type: ignore[arg-type]
    goal = Goal(target="apple", relation="on", destination="bed")
    return msgspec.structs.replace(made, kind="mobile_manipulation", goal=goal, instruction="Bring the apple.")


def trial(agent: str, support: str = COUNTER, people: int = 1) -> TrialSpec:
    privileges = plugins.load("agent", agent).privileges
    robot = RobotSeat(
        seat="robot", robot="scout", agent=AgentRef(name=agent, source="", sha256="", privileges=privileges)
    )
    seats = (HUMAN, *(f"human{k}" for k in range(2, people + 1)))
    hashes = dict.fromkeys(("suite_sha256", "rules_sha256", "code_sha256"), "0")
    return TrialSpec(
        task=bring(support),
        robots=(robot,),
        humans=tuple(HumanSeat(seat=seat, model="any", sha256="0", participant=k) for k, seat in enumerate(seats)),
        session=0,
        index=0,
        seed=0,
        **hashes,
    )


def played(world: World, agent: str, model: str = "proxy", traits: Parameters = BLIND, **more: Any) -> EpisodeLog:
    """The log of a trial with this built-in robot and this person."""
    person = plugins.load("human model", model)(Participant(seed=0, number=0, traits=traits))
    return play(trial(agent, **more), world, {HUMAN: person}, {"robot": plugins.load("agent", agent)()})


def of(log: EpisodeLog, kind: type[E], seat: str = "") -> list[E]:
    entries = (*log.events, *log.journal)
    return [entry for entry in entries if isinstance(entry, kind) and seat in ("", entry.seat)]  # type: ignore[attr-defined]


def until(log: EpisodeLog, tick: int) -> tuple[list[Event], list[Any]]:
    """Events and places of the person before this tick."""
    return list(takewhile(lambda event: event.tick < tick, log.events)), log.paths[HUMAN][: tick // 2]


def speeds(log: EpisodeLog, begin: int = 0, end: int = 10**6) -> list[float]:
    """[m/s] How fast the person walked between these ticks, five times a second."""
    path = [(x / 1000, y / 1000) for x, y, _ in log.paths[HUMAN][(begin + 1) // 2 : end // 2 + 1]]
    return [math.dist(a, b) / 0.2 for a, b in pairwise(path)]


# ------------------------------------------------------------------------------------------------------- a person asks


@pytest.mark.parametrize("agent", ["frontier", "oracle"])
def test_a_persons_question_is_answered_at_once(world: World, agent: str) -> None:
    log = played(world, agent, "asking", STUBBORN)
    questions = [sent for sent in of(log, Sent, HUMAN) if sent.question]
    assert questions
    for question in questions:
        (answer,) = [sent for sent in of(log, Sent, "robot") if sent.answers == question.message]
        assert answer.tick == question.tick + 1
        assert answer.to == HUMAN
        answered = [event for event in of(log, Answered, "robot") if event.message == question.message]
        assert [event.tick for event in answered] == [answer.tick]
    assert answer.object == "apple"
    assert answer.off == 0.0


@pytest.mark.parametrize("agent", ["frontier", "oracle"])
def test_what_neither_has_seen_neither_knows(world: World, agent: str) -> None:
    """The apple is in the closed fridge; only the oracle goes there, and speaks of it from then on."""
    log = played(world, agent, "asking", STUBBORN, support=FRIDGE)
    suggested = next((sent.tick for sent in of(log, Sent, "robot") if sent.position and sent.answers is None), math.inf)
    answers = [sent for sent in of(log, Sent, "robot") if sent.answers is not None]
    assert answers
    for answer in answers:
        assert (answer.position is not None) is (answer.tick > suggested)
        if answer.position is None:
            assert answer.text == "I have not seen the apple yet."
    assert math.isfinite(suggested) is (agent == "oracle")


def test_asking_takes_time(world: World) -> None:
    """Up to the question the trial is the same as without it; then the person speaks, and walks more slowly."""
    plain, log = (played(world, "frontier", model, STUBBORN) for model in ("proxy", "asking"))
    asked, sent = of(log, Asked)[0], of(log, Sent, HUMAN)[0]
    assert asked.tick > asking.PATIENCE_S / 0.1
    assert until(log, asked.tick) == until(plain, asked.tick)
    assert (sent.tick - asked.tick) * 0.1 == pytest.approx(asked.seconds, abs=0.4)
    assert asked.seconds == pytest.approx(speech.PREPARE_S + asked.words / speech.WORDS_PER_S)
    spoken = [
        speed
        for one, said in zip(of(log, Asked), of(log, Sent, HUMAN), strict=False)
        for speed in speeds(log, one.tick + 2, said.tick)
    ]
    assert max(speeds(log)) == pytest.approx(STUBBORN.v_pace, abs=0.02)
    assert 0.0 < max(spoken) < STUBBORN.v_pace / STUBBORN.k_read + 0.02


@pytest.mark.parametrize("agent", ["frontier", "oracle"])
def test_the_answer_is_read_and_followed_like_a_message(world: World, agent: str) -> None:
    """Somebody who has turned down the suggestion, and then asks, is told again; who follows goes there."""
    log = played(world, agent, "asking", OBEDIENT, support=COUNTER)
    taken = {event.message for event in of(log, Accepted, HUMAN)}
    offers = {entry.message for entry in of(log, Offer)}
    assert taken
    assert taken <= offers
    assert sum(speeds(log)) * 0.2 > 4.0


def test_a_replay_asks_what_was_asked(world: World, tmp_path: Path) -> None:
    spec, log = trial("frontier"), played(world, "frontier", "asking", STUBBORN)
    (tmp_path / "trials.jsonl").write_bytes(trial_record.encode(trial_record.make_record(spec, log)))
    person = plugins.load("human model", "replay")(Participant(seed=0, number=0), None, str(tmp_path))
    again = play(spec, world, {HUMAN: person}, {"robot": plugins.load("agent", "frontier")()})
    assert of(again, Sent, HUMAN) == of(log, Sent, HUMAN)
    assert of(again, Answered) == of(log, Answered)


# -------------------------------------------------------------------------------------------------------- a robot asks


@pytest.mark.parametrize("agent", ["frontier", "oracle"])
@pytest.mark.parametrize("traits", [STUBBORN, OBEDIENT], ids=["who ignores", "who accepts"])
def test_a_robots_question_is_answered_and_takes_time(world: World, agent: str, traits: Parameters) -> None:
    plain, log = (played(world, name, traits=traits) for name in (agent, f"asking_{agent}"))
    question = next(sent for sent in of(log, Sent, "robot") if sent.question)
    assert until(log, question.tick) == until(plain, question.tick)
    accepted = [event.tick for event in of(log, Accepted) if event.tick < question.tick]
    assert question.text.startswith("Have you found" if accepted else "Did you accept")
    shown = next(event for event in of(log, Shown, HUMAN) if event.message == question.message)
    answered = next(event for event in of(log, Answered, HUMAN) if event.message == question.message)
    (entry,) = [entry for entry in of(log, Replied) if entry.message == question.message]
    assert answered.yes is False
    assert entry.answer == "no"
    took = (answered.tick - shown.tick) * 0.1
    assert took == pytest.approx(entry.read_s + speech.PREPARE_S + speech.PRESS_S, abs=0.4)
    again = [sent for sent in of(log, Sent, "robot") if sent.tick > answered.tick and not sent.question]
    assert again[0].object == "apple"
    assert again[0].off == 0.0


# ---------------------------------------------------------------------------------------------------------- two people


def test_two_people_and_a_robot_talk() -> None:
    """One asks; the robot is asked and answers, and its suggestions go to whom it has seen nearest."""
    world = World(tiny.house(), robots=("scout",), objects=[("apple", "apple")], people=2)
    names = {HUMAN: "asking", "human2": "proxy"}
    people = {
        seat: plugins.load("human model", name)(Participant(seed=0, number=k, traits=STUBBORN))
        for k, (seat, name) in enumerate(names.items())
    }
    log = play(trial("oracle", people=2), world, people, {"robot": plugins.load("agent", "oracle")()})
    questions = [sent for sent in of(log, Sent, HUMAN) if sent.question]
    assert questions
    assert {sent.to for sent in questions} == {"robot"}
    answers = [sent for sent in of(log, Sent, "robot") if sent.answers is not None]
    assert len(answers) == len(questions)
    assert {sent.to for sent in answers} == {HUMAN}
    assert not of(log, Sent, "human2")
    assert all(sent.to in ("", HUMAN, "human2") for sent in of(log, Sent, "robot"))
