"""People follow an instruction: how much of it they keep, how they walk, and when they only watch."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.walks import walk

from hthor.humans.behaviours.follow_instruction import CHUNKS, remembered
from hthor.navigation import directions
from hthor.navigation.directions import Direction


@given(st.integers(0, 9), st.randoms(use_true_random=False))
def test_people_keep_four_steps_of_an_instruction_the_end_included(count, luck):
    draws = {}
    human = SimpleNamespace(draw=lambda *names: draws.setdefault(names, luck.random()))
    steps = [Direction(act="door", side="left", room="kitchen")] * count
    kept = remembered(human, steps)
    assert len(kept) == count
    assert sum(step is not None for step in kept) == min(count, CHUNKS - 1)
    assert kept == remembered(human, steps)


@pytest.mark.parametrize(
    "house", ["birch", *(pytest.param(house, marks=pytest.mark.nightly) for house in ("cedar", "juniper"))]
)
def test_a_person_follows_the_instruction_alone_and_stops(house):
    task, log = walk(f"vln/{house}/01")
    assert log.met
    assert len(directions.read(task.instruction)) >= 3
    assert [event.seat for event in log.events if event.kind == "success"] == ["human"]
    assert len({tuple(pose) for pose in log.paths["human"][-8:]}) <= 2, "they stand at the end"


def test_people_leave_the_walk_to_the_robot_that_has_to_walk():
    task, log = walk("vln/alder/02")
    assert not log.met
    (x, y, _), (u, v, _) = log.paths["human"][0], log.paths["human"][-1]
    assert math.dist((x, y), (u, v)) < 50  # [mm]
    assert task.goal.target == "robot_1"
