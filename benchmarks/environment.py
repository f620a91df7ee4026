"""The environment alone: a tick in every state of the world, sight, resets and builds, beside dm_control's own.

Three things take the same control steps in the same house: our world; `composer.Environment` with the same `HouseTask`
and default settings; and bare `mj_step`, the floor. Where our world splits a step, because something falls fast, the
floor takes the very same parts, so that it pays for the same physics.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterator, Sequence
from typing import Any
from unittest import mock

import mujoco
from dm_control import composer

from benchmarks.scenes import ROBOT, TICKS, Scene, Walk, walk
from benchmarks.table import Clock, Row, median_ms
from hthor import rules, tasks
from hthor.houses.space.free_space import FreeSpace
from hthor.types import HUMAN
from hthor.world import World
from hthor.world.model import composer_env as ours
from hthor.world.model import inventory
from hthor.world.model.composer_task import HouseTask

_FALL_TICKS = round(2.0 / rules.TICK_S)
_FALL_M = 1.0
_RING_M = 0.5


def rows(scenes: Sequence[Scene], suite: str, repeats: int) -> Iterator[Row]:
    """All rows; every value is the median over the scenes."""
    found = [measure(scene, suite, repeats) for scene in scenes]

    def middle(name: str) -> float:
        return statistics.median(one[name] for one in found)

    def row(what: str, name: str, unit: str = "ms", **more: Any) -> Row:
        return Row(part="environment", what=what, value=middle(name), unit=unit, **more)

    for state, title in (("still", "90 s, nothing moves"), ("walk", "90 s, two walk"), ("fall", "2 s, objects fall")):
        yield row(f"{title}: world", state)
        yield row(f"{title}: composer.Environment", f"{state} composer", remark="same task, default settings")
        yield row(f"{title}: bare mj_step", f"{state} floor", remark="the same engine steps")
        yield row(f"{title}: composer / world", f"{state} gain", "x")
    yield row("objects fall: world / bare mj_step", "fall overhead", "x", bar=2.0)
    yield row("objects fall: world / 20 ms steps", "fall coarse", "x", remark="mj_step in steps too long for falling")
    yield row("90 s, two walk and see", "sight", bar=30.0, remark="detections of both and in_view, every tick")
    yield row("the same, times real time", "sight speed", "x", bar=3000.0, at_least=True)
    yield row("reset to another task, same house", "reset", bar=2.0)
    yield row("the same: composer.Environment", "reset composer", remark="default settings: compiles the model anew")
    yield row("world build", "build", remark="house loaded before; free space not cached")


def measure(scene: Scene, suite: str, repeats: int) -> dict[str, float]:
    """All numbers of one scene."""
    way, other = walk(scene), composer_environment(scene)
    found: dict[str, float] = {}
    found["still"] = median_ms(lambda: _still(scene), repeats)
    found["still composer"] = median_ms(lambda: _steps(other, TICKS), repeats)
    found["still floor"] = found["walk floor"] = median_ms(lambda: _bare(scene, TICKS), repeats)
    found["walk"] = median_ms(lambda: _replay(scene, way), repeats)
    found["walk composer"] = median_ms(lambda: _steps(other, TICKS, moving=True), repeats)
    found["sight"] = median_ms(lambda: _replay(scene, way, _see), repeats)
    found["sight speed"] = 90000.0 / found["sight"]
    found.update(_falling(scene, other, repeats))
    for state in ("still", "walk", "fall"):
        found[f"{state} gain"] = found[f"{state} composer"] / found[state]
    found["reset"] = _resets(scene, suite)
    found["reset composer"] = median_ms(other.reset, 1)
    found["build"] = median_ms(lambda: _build(scene), 1)
    return found


def composer_environment(scene: Scene) -> Any:
    """dm_control's environment of the same house, bodies and objects, with default settings."""
    world = scene.world
    split = inventory.split_things(world.house, _objects(scene))
    task = HouseTask(world.house, split, world.bodies)
    task.starts = {placed.id: (placed.position, placed.yaw) for placed in scene.task.objects}
    environment = composer.Environment(task, random_state=0)
    environment.reset()
    return environment


def _objects(scene: Scene) -> tuple[tuple[str, str], ...]:
    return tuple((placed.id, placed.kind) for placed in scene.task.objects)


def _still(scene: Scene) -> None:
    scene.world.reset(scene.task)
    for _ in range(TICKS):
        scene.world.advance()


def _steps(environment: Any, ticks: int, moving: bool = False) -> None:
    """Control steps of dm_control's environment, from where it is; ``moving`` bodies are written as poses."""
    data, action = environment.physics.data, environment.action_spec().generate_value()
    for tick in range(ticks):
        if moving:
            data.mocap_pos[:, 0] = 0.01 * tick
        environment.step(action)


def _bare(scene: Scene, ticks: int) -> None:
    model = scene.world.model
    data = mujoco.MjData(model)
    steps = round(rules.TICK_S / model.opt.timestep)
    for _ in range(ticks):
        mujoco.mj_step(model, data, steps)


def _replay(scene: Scene, way: Walk, see: Callable[[World], None] | None = None) -> None:
    """The walk, and at every tick a look around."""
    world, place = scene.world, 0
    world.reset(scene.task)
    for tick in range(TICKS):
        while place < len(way) and way[place][0] == tick:
            world.start(way[place][1], way[place][2])
            place += 1
        if see is not None:
            see(world)
        world.advance()


def _see(world: World) -> None:
    world.detections(HUMAN)
    world.detections(ROBOT)
    assert world.snapshot().in_view[HUMAN] is not None


def _drop(scene: Scene) -> None:
    """All objects of the task in the air around the person, a metre above the floor."""
    world = scene.world
    world.reset(scene.task)
    pose, placed = world.pose(HUMAN), scene.task.objects
    for number, one in enumerate(placed):
        angle = 2.0 * math.pi * number / len(placed)
        x, y = pose.x + _RING_M * math.cos(angle), pose.y + _RING_M * math.sin(angle)
        world.put_object(one.id, (*world.space[HUMAN].nearest_free(x, y), _FALL_M + 0.1 * number))


def _falling(scene: Scene, other: Any, repeats: int) -> dict[str, float]:
    """The world, dm_control's environment and two floors, for two seconds from the same state."""
    world, found = scene.world, {"fall": [], "fall composer": [], "fall floor": [], "fall 20 ms": []}
    engine = world.env
    _drop(scene)
    parts = _recorded(world)
    for turn in range(repeats + 1):
        _drop(scene)
        qpos, qvel = engine.data.qpos.copy(), engine.data.qvel.copy()
        costs = {}
        clock = Clock()
        for _ in range(_FALL_TICKS):
            world.advance()
        costs["fall"] = clock()
        other.reset()
        other.physics.data.qpos[:], other.physics.data.qvel[:] = qpos, qvel
        clock = Clock()
        _steps(other, _FALL_TICKS)
        costs["fall composer"] = clock()
        costs["fall floor"] = _stepped(world.model, qpos, qvel, parts)
        whole = round(rules.TICK_S / world.model.opt.timestep)
        costs["fall 20 ms"] = _stepped(world.model, qpos, qvel, [(world.model.opt.timestep, whole)] * _FALL_TICKS)
        for name, value in costs.items():
            found[name] += [value] if turn else []
    middle = {name: statistics.median(values) for name, values in found.items()}
    return {
        **middle,
        "fall overhead": middle["fall"] / middle["fall floor"],
        "fall coarse": middle["fall"] / middle["fall 20 ms"],
    }


def _recorded(world: World) -> list[tuple[float, int]]:
    """The engine steps that the world takes in the next two seconds: length [s] and number of each call."""
    calls: list[tuple[float, int]] = []

    def step(model: Any, data: Any, nstep: int = 1) -> None:
        calls.append((float(model.opt.timestep), nstep))
        mujoco.mj_step(model, data, nstep)

    recorder = mock.Mock(wraps=mujoco)
    recorder.mj_step = step
    with mock.patch.object(ours, "mujoco", recorder):
        for _ in range(_FALL_TICKS):
            world.advance()
    return calls


def _stepped(model: Any, qpos: Any, qvel: Any, parts: Sequence[tuple[float, int]]) -> float:
    """CPU time [ms] of these engine steps and nothing else."""
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = qpos, qvel
    mujoco.mj_kinematics(model, data)
    usual = model.opt.timestep
    clock = Clock()
    for length, number in parts:
        model.opt.timestep = length
        mujoco.mj_step(model, data, number)
    cost = clock()
    model.opt.timestep = usual
    return cost


def _resets(scene: Scene, suite: str) -> float:
    """Resets to the suite's tasks in this house, one after the other."""
    objects = _objects(scene)
    here = [
        task
        for task in tasks.load_suite(suite).tasks
        if task.house == scene.name and tuple((placed.id, placed.kind) for placed in task.objects) == objects
    ]
    scene.world.reset(here[0])
    costs = []
    for task in here * math.ceil(20 / len(here)):
        clock = Clock()
        scene.world.reset(task)
        costs.append(clock())
    return statistics.median(costs)


def _build(scene: Scene) -> None:
    FreeSpace.of.cache_clear()
    World(scene.world.house, robots=[scene.world.bodies[ROBOT]], objects=_objects(scene))
