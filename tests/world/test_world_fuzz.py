"""Random calls of a world, some of them odd: no traceback, nothing lost, nothing in one another; and the same again."""

from __future__ import annotations

import functools
import sys
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from hthor.world import World

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from benchmarks import worldfuzz


@functools.cache
def world() -> World:
    return World("hazel", robots=("tender", "scout"))


def fresh() -> World:
    world().reset()
    return world()


@settings(max_examples=6)
@given(st.integers(0, 10**6), st.sampled_from((0.02, 0.15, 0.6)))
def test_calls_leave_a_sound_world(seed: int, odd: float) -> None:
    report = worldfuzz.run(fresh(), 60, str(seed), odd=odd)
    assert sum(report.calls.values()) == 60
    assert report.findings == []


def test_the_same_calls_fare_the_same() -> None:
    one, two = (worldfuzz.run(fresh(), 80, "again").digest for _ in range(2))
    assert one == two != worldfuzz.run(fresh(), 80, "other").digest


def test_what_is_wrong_is_found() -> None:
    broken = World("hazel", robots=("tender",))
    checker = worldfuzz.Checker(broken)
    broken.put_object("apple", on=broken.furniture("counter_top")[0].id)
    broken.settle()
    assert checker.check() == ""
    apple, other = broken.parts.objects.get("apple"), next(one for one in broken.parts.objects if one.clutter)
    assert apple is not None
    data = broken.env.data
    data.qpos[apple.qpos : apple.qpos + 3] = data.qpos[other.qpos : other.qpos + 3]
    assert " mm deep in " in checker.check()
