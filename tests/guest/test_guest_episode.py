"""Whole trials with two people and two robots: a guest and a local agent observe the same, whichever clock decides."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import levels
import mirror_agent
import msgspec
import numpy as np
import pytest
from episode_fakes import TASK, Mind, trial
from walking_stage import WalkingStage

from hthor.episode import Concurrent, DecisionClock, EpisodeLog, LockStep, play
from hthor.guest import Guest, GuestConfig
from hthor.types import Action, Briefing, Camera, Detection, Drive, Observation, Pose, Reply, Scan, Send
from hthor.world import World

LEVELS = ["L1", "L2", "L3"]
CLOCKS = ["lockstep", "concurrent", "instant"]
EVERY_COMMIT = {("L1", "lockstep"), ("L2", "lockstep"), ("L3", "concurrent"), ("L3", "instant")}
"""Each level and each clock with some other; the rest is for the night."""


def pairs(chosen: set[tuple[str, str]], clocks: list[str], levels: list[str]) -> list[Any]:
    """Every level with every clock, as parameters."""
    every = [(level, clock) for level in levels for clock in clocks]
    return [pytest.param(*one, marks=[] if one in chosen else pytest.mark.nightly) for one in every]


class Stage(WalkingStage):
    """Has every sensor, whose readings change from tick to tick; heads turn, and the outcome of a walk is seen."""

    def pose(self, seat: str) -> Pose:
        return msgspec.structs.replace(super().pose(seat), head=0.1 if self.tick % 2 else msgspec.UNSET, yaw=0.2)

    def senses(self, seat: str) -> Any:
        return Moment(self, seat, None)

    def frozen_senses(self, seat: str) -> Any:
        return Moment(self, seat, self.tick)


class Moment:
    """Sensors that show ``tick``; without one, the world's present tick."""

    def __init__(self, stage: Stage, seat: str, tick: int | None) -> None:
        self._stage, self._seat, self._frozen = stage, seat, tick

    @property
    def tick(self) -> int:
        return self._stage.tick if self._frozen is None else self._frozen

    def detections(self) -> tuple[Detection, ...]:
        person: dict[str, Any] = {"kind": "person", "family": "person", "size": (0.5, 0.5, 1.7), "distance": 1.0}
        return tuple(
            Detection(id=seat, position=(float(self.tick), 0.0, 0.9), yaw=0.5, **person) for seat in ("human", "human2")
        )

    def scan(self) -> Scan:
        origin = Pose(x=0.0, y=float(self.tick), head=0.5)
        return Scan(origin=origin, bearings=np.zeros(3), ranges=np.full(3, 0.1 * self.tick), limit=5.0)

    def rgb(self) -> Any:
        return np.full((8, 8, 3), self.tick % 256, np.uint8)

    def depth(self) -> Any:
        return np.full((8, 8), self.tick, np.float32)

    def segmentation(self) -> Any:
        return np.full((8, 8), self.tick, np.int32)

    def camera(self) -> Camera:
        return Camera(size=(8, 8), matrix=np.eye(3), pose=np.eye(4) * self.tick, near=0.02, far=80.0)


class Both:
    """A guest and a local agent in one seat; the guest, which is later, decides."""

    def __init__(self, guest: Guest) -> None:
        self.guest, self.local = guest, mirror_agent.Agent()
        self.decided: list[tuple[Observation, Action, Action]] = []

    def begin(self, briefing: Briefing) -> None:
        self.guest.begin(briefing)
        self.local.begin(briefing)

    def act(self, observation: Observation) -> Action:
        time.sleep(0.002)
        here = self.local.act(observation)
        there = self.guest.act(observation)
        self.decided.append((observation, here, there))
        return there


@pytest.fixture
def robots(tmp_path: Path) -> Iterator[Any]:
    guests: list[Guest] = []

    def make(level: str) -> dict[str, Both]:
        path = shutil.copy(mirror_agent.__file__, tmp_path)
        guests.extend(Guest(path, config=GuestConfig(isolation=levels.need(level))) for _ in range(2))
        return {"robot": Both(guests[0]), "robot2": Both(guests[1])}

    yield make
    for guest in guests:
        guest.close()


def clock_of(name: str) -> DecisionClock:
    """The clock of this name; a concurrent one waits for all agents now and then, or slow machines would ask few."""
    if name == "lockstep":
        return LockStep()
    every = 1 if name == "instant" else 8
    clock = Concurrent(pace=lambda tick: clock.settle() if tick % every == 0 else time.sleep(0.004))
    return clock


def run(clock: DecisionClock, robots: dict[str, Any], world: Any = None) -> EpisodeLog:
    spec = trial("object_poses", "house_map")
    spec = msgspec.structs.replace(spec, task=msgspec.structs.replace(TASK, time_limit=3.0 if world else 6.0))
    people = {"human": Mind(first_person), "human2": Mind(second_person)}
    return play(spec, world or Stage(), people, robots, clock)


def first_person(now: Observation) -> Action:
    """Asks the robot, and says yes or no to what is asked."""
    if now.tick % 5 == 0:
        return Action(say=Send(text="Where is the mug?", object="mug", to="robot", question=True))
    if now.inbox and now.inbox[0].question and now.tick % 2:
        return Action(say=Reply(message=now.inbox[0].id, accept=now.tick % 4 == 1))
    return Action()


def second_person(now: Observation) -> Action:
    """Tells everybody something, and answers in words."""
    if now.tick % 7 == 0:
        return Action(say=Send(text="It is hot today.", position=(1.0, 2.0, 0.0)))
    if now.inbox and now.inbox[0].question and now.inbox[0].sender != "human":
        return Action(say=Send(text="In the sink.", answers=now.inbox[0].id))
    return Action()


@pytest.mark.parametrize(("level", "clock"), pairs(EVERY_COMMIT, CLOCKS, LEVELS))
def test_a_guest_observes_what_a_local_agent_observes(level: str, clock: str, robots: Any) -> None:
    both = robots(level)
    log = run(clock_of(clock), both)
    assert not log.faults
    steps = [step for one in both.values() for step in one.decided]
    assert len(steps) > 20
    for observation, here, there in steps:
        assert here == there, observation.tick
        assert isinstance(there.motion, Drive)
    seen = [observation for observation, _, _ in steps]
    inbox = [message for one in seen for message in one.inbox]
    assert {message.sender for message in inbox} == {"human", "human2"}
    assert {message.question for message in inbox} == {True, False}
    assert {one.pose.head for one in seen} == {0.1, msgspec.UNSET}
    assert any(message.answers is not None for message in inbox)
    assert any(isinstance(here.say, Send) and here.say.answers is not None for _, here, _ in steps)
    assert len({one.receipt.status for one in seen if one.receipt}) > 1


@pytest.mark.parametrize(("level", "clock"), pairs(EVERY_COMMIT, CLOCKS[:2], LEVELS[1:]))
def test_it_does_so_in_a_real_world(level: str, clock: str, robots: Any) -> None:
    """With pictures, which another thread draws while bodies drive."""
    objects = tuple((placed.id, placed.kind) for placed in TASK.objects)
    both = robots(level)
    log = run(clock_of(clock), both, World(TASK.house, ("scout", "scout"), objects, people=2))
    assert not log.faults
    for one in both.values():
        assert len(one.decided) > 3
        assert [here for _, here, _ in one.decided] == [there for _, _, there in one.decided]
        assert len({observation.pose.x for observation, _, _ in one.decided}) > 1
        assert any(observation.inbox for observation, _, _ in one.decided)


def test_a_clock_that_waits_gives_the_trial_of_lock_step(robots: Any) -> None:
    both = robots("L2")
    assert run(clock_of("lockstep"), both) == run(clock_of("instant"), both)
