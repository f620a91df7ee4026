"""The world is a version: the same bodies that do the same fare the same, or `rules.SIMULATION` says otherwise."""

from __future__ import annotations

import hashlib
import math

import pytest

from hthor import rules, tasks
from hthor.types import HUMAN, Drop, Move, Open, Pick, Place, Rotate, Wait
from hthor.world import World

GOLDEN = {
    # version of the world: digests of where everything was, to the centimetre, at every half second
    1: {"alder": "2b29bb2edb4bf200", "cedar": "45e27c19c9e68f8d"},
    2: {"alder": "2b29bb2edb4bf200", "cedar": "45e27c19c9e68f8d"},  # bodies push loose things; here nobody meets any
    3: {"alder": "2b29bb2edb4bf200", "cedar": "45e27c19c9e68f8d"},  # what nothing carries falls; doors need their way
    4: {"alder": "2b29bb2edb4bf200", "cedar": "45e27c19c9e68f8d"},  # rugs go on below the floor; panes stop hands
    5: {"alder": "2b29bb2edb4bf200", "cedar": "45e27c19c9e68f8d"},  # nothing goes back to where something is by now
}


def script(task):
    """A walk through the house that bumps into things, handles what it meets, and waits."""
    target = task.goal.target
    yield from (Move(forward=0.3), Rotate(yaw=0.7), Move(forward=0.5), Move(forward=0.5, left=0.1))
    yield from (Pick(object=target), Wait(seconds=0.3), Rotate(yaw=-1.1, pitch=-0.2), Move(forward=0.5), Drop())
    for thing in ("Fridge|1", "fridge"):
        yield Open(thing=thing)
    for turn in range(24):
        yield Rotate(yaw=0.9 * math.sin(1.7 * turn))
        yield Move(forward=0.5, left=0.1 * math.cos(turn))
        yield Move(forward=0.4)
    yield Place(on="fridge")


def course(house: str) -> list[tuple[int, ...]]:
    """Poses and things [cm], every half second, of a person and a robot who both follow the script."""
    task = next(task for task in tasks.load_suite("smoke").tasks if task.house == house)
    from hthor import plugins

    world = World(house, robots=(plugins.load("robot", "scout"),))
    world.reset(task, seed=7)
    left = {seat: script(task) for seat in world.seats}
    rows = []
    for tick in range(600):
        for seat in world.seats:
            if world.idle(seat):
                world.start(seat, next(left[seat], Wait(seconds=0.5)))
        world.advance()
        if tick % 5 == 0:
            snapshot = world.snapshot()
            bodies = [c for seat in (HUMAN, "robot") for c in (snapshot.poses[seat].x, snapshot.poses[seat].y)]
            things = [c for id in sorted(snapshot.things) for c in snapshot.things[id].position]
            rows.append(tuple(round(100.0 * c) for c in (*bodies, *things)))
    return rows


@pytest.mark.parametrize("house", ["alder", "cedar"])
def test_the_world_is_that_of_its_version(house):
    rows = course(house)
    assert len({row[:2] for row in rows}) > 20, "the script gets about"
    found = hashlib.sha256(repr(rows).encode()).hexdigest()[:16]
    expected = GOLDEN[rules.SIMULATION][house]
    assert found == expected, "the world behaves otherwise: raise rules.SIMULATION and add its digests here"
