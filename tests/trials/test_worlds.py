"""Worlds are kept within a bound on their memory, and shared by tasks with different objects."""

from __future__ import annotations

import gc
import weakref
from typing import Any

import numpy as np
import pytest

from hthor import tasks
from hthor.episode import play
from hthor.houses import HouseLibrary
from hthor.trials import TrialRunner, Worlds, make_sessions
from hthor.trials.worlds import SPARE_MAX, Objects
from hthor.world import World

MB = 1_000_000
APPLE, BOOK = ("apple", "apple"), ("book", "book")


class Fake:
    """A world of 10 MB that has a cycle of references, as a simulation has."""

    nbytes = 10 * MB

    def __init__(self, objects: Objects) -> None:
        self.objects, self.me = objects, self


def test_a_world_is_built_once() -> None:
    worlds = Worlds()
    first = worlds.get("alder", (APPLE,), Fake)  # type: ignore[arg-type]
    assert worlds.get("alder", (APPLE,), pytest.fail) is first
    assert worlds.get("alder", (), pytest.fail) is first


def test_the_worlds_used_longest_ago_are_dropped_and_freed() -> None:
    worlds: Any = Worlds(most_bytes=40 * MB)
    first = worlds.get(0, (), Fake)
    others = [weakref.ref(worlds.get(house, (), Fake)) for house in (1, 2, 3)]
    assert worlds.get(0, (), pytest.fail) is first
    worlds.get(4, (), Fake)
    assert len(worlds) == 3
    assert [world() is None for world in others] == [True, True, False], "freed at once, cycles and all"
    assert worlds.get(0, (), pytest.fail) is first
    worlds.get(1, (), Fake)


def test_a_world_larger_than_the_bound_is_kept_while_it_is_the_last() -> None:
    worlds: Any = Worlds(most_bytes=MB)
    for house in range(3):
        world = worlds.get(house, (), Fake)
        assert len(worlds) == 1
        assert worlds.get(house, (), pytest.fail) is world


def test_tasks_with_different_objects_share_a_world() -> None:
    worlds: Any = Worlds()
    worlds.get("alder", (APPLE,), Fake)
    both = worlds.get("alder", (BOOK,), Fake)
    assert both.objects == (APPLE, BOOK)
    assert len(worlds) == 1
    other = worlds.get("alder", (("apple", "tomato"),), Fake)
    assert other.objects == (("apple", "tomato"),), "an id has one kind in a world"
    many = tuple((f"apple{number}", "apple") for number in range(SPARE_MAX))
    assert worlds.get("alder", many, Fake).objects == many
    assert worlds.get("alder", (BOOK, APPLE), pytest.fail) is both


def test_what_is_kept_is_scanned_again_when_its_owner_is_gone() -> None:
    worlds: Any = Worlds()
    world = weakref.ref(worlds.get("alder", (), Fake))
    del worlds
    gc.collect()
    assert world() is None


@pytest.fixture(scope="module")
def pair() -> tuple[World, World]:
    """The house of the first trial of `smoke` with its objects alone, and with three more."""
    trial = make_sessions("smoke", agent="frontier")[0].trials[0]
    objects = tuple((placed.id, placed.kind) for placed in trial.task.objects)
    more = (*objects[:2], ("another", "apple"), ("second", "plate"), *objects[2:], ("zebra", "mug"))
    house = HouseLibrary().load(trial.task.house)
    return tuple(World(house, robots=["scout"], objects=some) for some in (objects, more))  # type: ignore[return-value]


def test_a_trial_goes_the_same_in_a_world_with_more_objects(pair: tuple[World, World]) -> None:
    session, runner = make_sessions("smoke", agent="frontier")[0], TrialRunner()
    logs = []
    for world in pair:
        with runner.enter(session) as minds:
            logs.append(play(session.trials[0], world, minds.humans, minds.ready_agents()))
    assert logs[0] == logs[1]


def test_everything_that_a_robot_senses_is_the_same_there(pair: tuple[World, World]) -> None:
    task = next(task for task in tasks.load_suite("smoke").tasks if task.house == pair[0].house.id)
    for world in pair:
        world.reset(task, seed=5)
    few, many = pair
    assert many.names[: len(few.names)] == few.names
    assert many.label_kinds[: len(few.names)] == few.label_kinds
    for turn in range(8):
        for world in pair:
            world.robot.rotate(0.7 * (turn > 0))
        assert few.detections("robot") == many.detections("robot")
        assert np.array_equal(few.scan("robot").ranges, many.scan("robot").ranges)
        for mode in ("rgb", "depth", "segmentation"):
            assert np.array_equal(few.picture("robot", mode), many.picture("robot", mode)), mode
