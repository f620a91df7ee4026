"""A built-in robot that stands in a person's way gives way: a whole episode at a doorway."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import pytest
import world_house as tiny
from world_house import FRIDGE, on

from hthor import plugins
from hthor.episode import play
from hthor.geometry.plane import wrap
from hthor.types import (
    HUMAN,
    Action,
    AgentRef,
    Briefing,
    Goal,
    HumanSeat,
    Move,
    Observation,
    Pose,
    RobotSeat,
    Rotate,
    TrialSpec,
    Wait,
)
from hthor.world import World

GOAL = (7.0, 2.9)


class Walker:
    """Walks straight through the doorway to a place behind it, whatever stands there, and stays."""

    arrived = -1

    def begin(self, briefing: Briefing) -> None:
        pass

    def act(self, observation: Observation) -> Action:
        pose = observation.pose
        x, y = (5.4, 2.0) if pose.x < 5.3 else GOAL
        if math.dist((pose.x, pose.y), GOAL) < 0.3:
            self.arrived = observation.tick if self.arrived < 0 else self.arrived
            return Action(motion=Wait(seconds=1.0))
        off = wrap(math.atan2(y - pose.y, x - pose.x) - pose.yaw)
        return Action(motion=Rotate(yaw=off) if abs(off) > 0.1 else Move(forward=0.3))

    def rate(self, met: bool, tick: int) -> int | None:
        return None

    def state(self) -> dict[str, Any]:
        return {}


@pytest.mark.parametrize("yaw", [math.pi, 0.0], ids=["facing", "turned away"])
@pytest.mark.parametrize("name", ["frontier", "oracle"])
def test_a_robot_in_a_doorway_lets_the_person_through(name: str, yaw: float) -> None:
    world = World(tiny.house(), robots=("scout",))
    agent = plugins.load("agent", name)
    ref = AgentRef(name=name, source=name, sha256="0", privileges=tuple(getattr(agent, "privileges", ())))
    task = msgspec.structs.replace(
        tiny.task(on(FRIDGE, "apple", surface=1), human=Pose(x=4.2, y=2.0), robots=(Pose(x=5.0, y=2.0, yaw=yaw),)),
        kind="object_goal_navigation",
        goal=Goal(target="apple", relation="find"),
        time_limit=30.0,
    )
    trial = TrialSpec(
        task=task,
        robots=(RobotSeat(seat="robot", robot="scout", agent=ref),),
        humans=(HumanSeat(seat="human", model="walker", sha256="0", participant=0),),
        session=0,
        index=0,
        seed=0,
        suite_sha256="0",
        rules_sha256="0",
        code_sha256="0",
    )
    walker = Walker()
    log = play(trial, world, {"human": walker}, {"robot": agent()})  # type: ignore[arg-type]
    assert not log.faults
    assert {event.kind for event in log.events if event.seat == HUMAN} >= {"in_way"}, "it did stand in the way"
    assert 0 < walker.arrived < 150, "the person is through within a quarter of a minute"
