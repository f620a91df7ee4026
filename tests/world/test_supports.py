"""What nothing carries falls: whatever was taken, moved, removed, opened or pushed away from under a thing."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hthor import tasks
from hthor.errors import HthorError
from hthor.types import Drive
from hthor.world import World

HANGING_M = 0.02
"""[m] An object that sinks farther when it is woken was in the air; long things that lean on something slip by 1 cm."""
KINDS = ("bowl", "pan", "pot", "plate", "laptop", "box", "book", "apple", "mug", "egg")
SPARES = tuple((f"spare {kind}", kind) for kind in KINDS)
SCENES = ("hazel", "cedar", "elder")


def hanging(world: World) -> dict[str, float]:
    """How far [m] the objects at rest would fall that nothing carries; the world is afterwards as it was.

    What a body keeps from falling, because it fits nowhere beside that body, is not at rest.
    """
    state, environment = world.save_state(), world.env
    model, data, present = environment.model, environment.data, {one.id for one in world.objects() if not one.held_by}
    bodies = {prop.id: environment.physics.bind(prop.root_body).element_id for prop in environment.task.props}
    rests = {id: id in present and environment.asleep[model.body_treeid[body]] >= 0 for id, body in bodies.items()}
    joints = {id: int(model.body_jntadr[body]) for id, body in bodies.items() if rests[id]}
    height = {id: int(model.jnt_qposadr[joint]) + 2 for id, joint in joints.items()}
    before = {id: float(data.qpos[at]) for id, at in height.items()}
    environment.wake(int(model.jnt_dofadr[joint]) for joint in joints.values())
    for _ in range(15):
        environment.tick()
    falls = {id: before[id] - float(data.qpos[at]) for id, at in height.items()}
    world.load_state(state)
    return {id: fall for id, fall in falls.items() if fall > HANGING_M}


def stack(world: World, on: str, *ids: str) -> bool:
    """Put objects on one another, the first on a thing; False where there is no room."""
    try:
        world.put_object(ids[0], on=on)
        world.settle()
        for low, high in itertools.pairwise(ids):
            x, y, z = world.position(low)
            world.put_object(high, (x, y, z + 0.2))
            world.settle()
    except HthorError:
        return False
    return True


@pytest.fixture(scope="module")
def worlds() -> dict[str, World]:
    return {scene: World(scene, robots=["tender", "scout"], objects=SPARES) for scene in SCENES}


def lifted(world: World, id: str) -> None:
    assert world.human.go_to(id).ok
    assert world.human.pick(id).ok


def moved_away(world: World, id: str) -> None:
    world.put_object(id, on="coffee_table")


@pytest.mark.parametrize(
    ("take", "kind"),
    [(lifted, kind) for kind in ("bowl", "pan", "pot", "laptop", "box")]  # no hand reaches a book that is covered
    + [(take, kind) for take in (World.remove_object, moved_away) for kind in ("bowl", "plate", "laptop", "book")],
)
def test_what_lay_in_or_on_a_thing_stays_behind_and_falls(
    worlds: dict[str, World], take: Callable[[World, str], None], kind: str
) -> None:
    world = worlds["hazel"]
    world.reset()
    low, middle, high = f"spare {kind}", "spare mug", "spare egg"
    assert stack(world, "dining_table", low, middle, high)
    before = world.position(middle)[2]
    take(world, low)
    world.settle()
    assert hanging(world) == {}
    assert world.position(middle)[2] < before - 0.005
    assert world.state(middle).support in ("dining_table", "")


def test_a_stack_that_is_pushed_away_from_under_things_falls(worlds: dict[str, World]) -> None:
    world = worlds["hazel"]
    world.reset()
    robot = world.actor("robot2")
    robot.teleport(3.0, 6.3, yaw=0.0)
    for number, id in enumerate(("spare book", "spare box", "spare apple")):
        world.put_object(id, (3.6, 6.3, 0.1 + 0.3 * number))
        world.settle()
    robot.move(0.5)
    robot.move(0.5)
    world.settle()
    assert hanging(world) == {}


def test_what_leans_on_a_door_falls_when_it_opens(worlds: dict[str, World]) -> None:
    """The things of a shelf inside a fridge that touch its door have nothing to lean on when it is open."""
    world = worlds["hazel"]
    world.reset()
    world.set_open("fridge")
    world.put_object("spare laptop", on="fridge")
    world.settle()
    world.set_open("fridge", False)
    world.settle()
    assert hanging(world) == {}
    world.set_open("fridge")
    world.settle()
    assert hanging(world) == {}


@pytest.mark.parametrize("suite", ["smoke", pytest.param("paper", marks=pytest.mark.nightly)])
def test_no_task_begins_with_a_thing_in_the_air(suite: str) -> None:
    worlds: dict[str, World] = {}
    for task in tasks.load_suite(suite).tasks:
        if task.house not in worlds:
            worlds[task.house] = World(task.house)
        world = worlds[task.house]
        world.reset(task)
        assert hanging(world) == {}, task.id


def act(world: World, chance: random.Random) -> None:
    """One thing that people, robots or a program may do."""
    bases, ids = [thing.id for thing in world.furniture()], [id for id, _ in SPARES]
    actor = world.actor(chance.choice(world.seats[:2]))
    match chance.choice(("stack", "stack", "handle", "handle", "handle", "remove", "open", "push", "throw")):
        case "stack":
            stack(world, chance.choice(bases), *chance.sample(ids, 3))
        case "handle" if actor.holding:
            actor.place(chance.choice(bases)) if chance.random() < 0.5 else actor.drop()
        case "handle":
            there = world.objects()
            bearing = [one.id for one in there if any(is_over(other.position, one.position) for other in there)]
            target = chance.choice(bearing or [one.id for one in there])
            actor.go_to(target)
            actor.pick(target)
        case "remove":
            world.remove_object(chance.choice([one.id for one in world.objects() if not one.held_by]))
        case "open":
            one = chance.choice([state for state in world.truth() if state.id in bases])
            world.set_open(one.id, not one.open)
        case "push":
            low = [one.position[:2] for one in world.objects() if one.position[2] < 0.3]
            robot = world.actor("robot2")
            if low and robot.go_to(chance.choice(low)).ok:
                world.start("robot2", Drive(forward=0.5, yaw=chance.uniform(-3.0, 3.0)))
                world.step(20)
        case "throw":
            one = chance.choice([one for one in world.objects() if not one.held_by])
            x, y, z = one.position
            speed = (chance.uniform(-3.0, 3.0), chance.uniform(-3.0, 3.0), chance.uniform(0.0, 3.0))
            world.put_object(one.id, (x, y, z + 0.02), velocity=speed)


def is_over(high: tuple[float, ...], low: tuple[float, ...]) -> bool:
    return high[2] > low[2] and math.dist(high[:2], low[:2]) < 0.1


def play(world: World, seed: int, actions: int) -> None:
    chance = random.Random(seed)
    world.reset()
    for _ in range(actions):
        try:
            act(world, chance)
        except HthorError:
            continue
        world.settle(20.0)
        assert hanging(world) == {}


@settings(max_examples=5, deadline=None)
@given(scene=st.sampled_from(SCENES), seed=st.integers(0, 10**6))
def test_nothing_hangs_in_the_air_whatever_is_done(worlds: dict[str, World], scene: str, seed: int) -> None:
    play(worlds[scene], seed, 12)


@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(8))
def test_nothing_hangs_in_the_air_after_many_actions(worlds: dict[str, World], seed: int) -> None:
    play(worlds[SCENES[seed % len(SCENES)]], seed, 150)
