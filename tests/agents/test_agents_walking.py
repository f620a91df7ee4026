"""Robots where somebody has to go to a landmark: they walk there themselves, or tell the person who walks."""

from __future__ import annotations

import pytest
from support.walks import walk

from hthor.agents.skills.walking.instructed_exploration import InstructedExplorer
from hthor.types import Pose
from hthor.world.robots.scout import SPEC


@pytest.mark.parametrize(
    "house", ["elder", *(pytest.param(house, marks=pytest.mark.nightly) for house in ("alder", "maple"))]
)
@pytest.mark.parametrize("agent", ["frontier", "oracle"])
def test_a_robot_walks_where_the_instruction_leads_and_stops(agent, house):
    task, log = walk(f"vln/{house}/02", agent)
    assert log.met
    assert [event.seat for event in log.events if event.kind == "success"] == ["robot"]
    assert not [event for event in log.events if event.kind == "sent"], "it has nothing to tell"
    assert log.ticks / 10 >= task.t_star, "nobody is faster than the least time"


@pytest.mark.parametrize("agent", ["frontier", "oracle"])
def test_a_robot_tells_the_person_who_walks_where_the_landmark_is(agent):
    task, log = walk("vln/rowan/01", agent)
    first = next(event for event in log.events if event.kind == "sent")
    assert first.object.startswith(task.goal.destination)
    assert first.seat == "robot"
    assert log.met


def test_the_instruction_pulls_the_exploration_to_its_side():
    explorer = InstructedExplorer(SPEC, "Go through the door on your left into the kitchen. Stop at the fridge.")
    here = Pose(x=0.0, y=0.0, yaw=0.0)
    assert explorer.extra_cost(here, (0.0, 2.0)) == explorer.extra_cost(here, (0.0, -2.0)), "before the first look"
    explorer._room, explorer._entry = "room", here
    explorer.aim = explorer._next_aim()
    assert explorer.extra_cost(here, (0.0, 2.0)) < explorer.extra_cost(here, (0.0, -2.0))


def test_other_words_are_no_reason_to_stop():
    assert InstructedExplorer(SPEC, "Please go somewhere nice.").steps == []
