"""Proves in the physics engine that tasks are as their files say, and that they can be done.

A task is set up in the simulated world. Every object is released there and must stay where it is; then the relations
that the task states are measured on the true state, by separate code; then a person who knows where everything is does
the task (`hthor.eval.task_check.omniscient_solver`).
"""

from __future__ import annotations

import functools
import math
import os
import signal
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import closing
from functools import cache, lru_cache
from multiprocessing import get_context
from typing import TYPE_CHECKING, TypeVar

import msgspec
from msgspec import Struct

from hthor import catalog, code_identity, plugins, rules
from hthor.errors import HthorError, UnknownName
from hthor.eval.runner import worker
from hthor.eval.task_check import omniscient_solver
from hthor.houses.library import OURS, HouseLibrary
from hthor.tasks.arrangement.placement import NEAR_M, as_thing
from hthor.tasks.validate import task_faults as mistakes
from hthor.types import HouseSpec, Placement, TaskSpec, Thing, ThingState, Vec3

CODE_ROOT = "makers"

if TYPE_CHECKING:
    from hthor.world import World

DRIFT_M, WATCHED_S = 0.02, 2.0
"""How far [m] an object may move within this time [s] after its release."""
_PATIENCE = 6
"""In a task with several jobs, a person alone may take this many times the time limit."""
_DEEP_M = 0.01
_LIFT_M = 0.002
"""Height [m] above its place at which an object is released: less than `DRIFT_M`, but enough to wake the engine."""
_CHUNK = 10
_In = TypeVar("_In")
_Out = TypeVar("_Out")


class TaskFault(Struct, frozen=True, kw_only=True):
    """A fault of a task: the field that is wrong, and the reason."""

    task: str
    field: str
    reason: str


class TaskVerdict(Struct, frozen=True, kw_only=True):
    """The result of checking one task. ``drift`` [m] is the farthest that an object moved after its release;
    ``seconds`` and ``metres`` are the time and walk of an omniscient person, 0 where that could not be tried.
    """

    task: str
    house: str
    least: float = 0.0
    drift: float = 0.0
    seconds: float = 0.0
    metres: float = 0.0
    faults: tuple[TaskFault, ...] = ()


def check_tasks(
    tasks: Sequence[TaskSpec], *, jobs: int, houses: HouseLibrary = OURS
) -> Generator[TaskVerdict, None, None]:
    """Check tasks in worker processes; verdicts come as they are ready. Closing the iterator ends the workers."""
    work = functools.partial(_examine, houses=houses)
    with closing(run_in_workers(work, _chunks(tasks), jobs=jobs)) as found:
        for _, own in found:
            yield from own


def run_in_workers(
    work: Callable[[_In], _Out], items: Sequence[_In], *, jobs: int
) -> Generator[tuple[int, _Out], None, None]:
    """Do something to each item in worker processes; results come with the items' numbers as they are ready.

    Closing the iterator ends the workers.
    """
    before = dict(os.environ)
    os.environ.update(worker.ONE_THREAD, PYTHONHASHSEED="0")
    code_identity.keep_compiled()
    count, parent = min(jobs, max(1, len(items))), (os.getpid(),)
    pool = ProcessPoolExecutor(count, get_context("spawn"), initializer=_begin, initargs=parent)
    try:
        left = {pool.submit(work, item): number for number, item in enumerate(items)}
        for future in as_completed(left):
            yield left[future], future.result()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in tuple((getattr(pool, "_processes", None) or {}).values()):
            process.terminate()
        os.environ.clear()
        os.environ.update(before)


def check_task(task: TaskSpec, house: HouseSpec | HouseLibrary = OURS) -> TaskVerdict:
    """Check one task in this process, in its house or in the one that a library has under its house's name."""
    try:
        house = _house(house, task.house, task.house_sha256) if isinstance(house, HouseLibrary) else house
    except HthorError as error:
        return _unsound(task, [("house", str(error))])
    first = list(mistakes(task, house))
    if first:
        return _unsound(task, first)
    try:
        return _proved(task, house)
    except HthorError as error:  # the world refuses to set the task up
        return _unsound(task, [("$", str(error))])


def is_solvable(task: TaskSpec, house: HouseSpec) -> bool:
    """Whether a task has no fault in its house."""
    return not check_task(task, house).faults


def repeated(tasks: Sequence[TaskSpec]) -> list[TaskFault]:
    """A fault for every id that more than one task has."""
    many = Counter(task.id for task in tasks)
    reason = "is the id of {} tasks; ids must be distinct"
    return [TaskFault(task=id, field="id", reason=reason.format(count)) for id, count in many.items() if count > 1]


def _proved(task: TaskSpec, house: HouseSpec) -> TaskVerdict:
    """The result of checking a task whose record is valid in its house."""
    world = _world(house, tuple((placed.id, placed.kind) for placed in task.objects))
    inside = tuple(_inside(world, task))
    if inside:
        return _unsound(task, inside)
    drift, states = woken(world, task)
    found = [*_unsettled(task, drift), *(fault for one in task.objects for fault in _untrue(one, house, task, states))]
    seconds, metres, late = _played(world, task)
    verdict = _unsound(task, [*found, *late])
    return msgspec.structs.replace(verdict, drift=max(drift.values(), default=0.0), seconds=seconds, metres=metres)


def _unsound(task: TaskSpec, faults: Sequence[tuple[str, str]]) -> TaskVerdict:
    rows = tuple(TaskFault(task=task.id, field=field, reason=reason) for field, reason in faults)
    return TaskVerdict(task=task.id, house=task.house, least=_least(task), faults=rows)


def _least(task: TaskSpec) -> float:
    """The least time [s], 0 for a task of an unknown kind."""
    try:
        return float(plugins.load("task kind", task.kind).least(task))
    except UnknownName:
        return 0.0


def woken(world: World, task: TaskSpec) -> tuple[dict[str, float], dict[str, ThingState]]:
    """How far [m] each object of a task moves after its release, and the state of all objects then."""
    world.reset(task)
    for placed in task.objects:
        x, y, z = placed.position
        world.put_object(placed.id, (x, y, z + _LIFT_M), yaw=placed.yaw)
    drift = dict.fromkeys((placed.id for placed in task.objects), 0.0)
    for _ in range(round(WATCHED_S / rules.TICK_S)):
        world.advance()
        for placed in task.objects:
            drift[placed.id] = max(drift[placed.id], math.dist(world.position(placed.id), placed.position))
    return drift, {state.id: state for state in world.truth()}


def _inside(world: World, task: TaskSpec) -> Iterator[tuple[str, str]]:
    """Objects that cannot be set down where the task says, because something is there already."""
    world.reset(task)
    for number, placed in enumerate(task.objects):
        x, y, z = placed.position
        try:
            world.put_object(placed.id, (x, y, z + _LIFT_M), yaw=placed.yaw)
        except HthorError as error:
            yield f"objects[{number}].position", str(error)


def _unsettled(task: TaskSpec, drift: dict[str, float]) -> Iterator[tuple[str, str]]:
    for number, placed in enumerate(task.objects):
        if drift[placed.id] > DRIFT_M:
            reason = f"'{placed.id}' is not at rest: it moves {drift[placed.id]:.3f} m in {WATCHED_S:.0f} s"
            yield f"objects[{number}].position", reason


def _untrue(
    placed: Placement, house: HouseSpec, task: TaskSpec, states: dict[str, ThingState]
) -> Iterator[tuple[str, str]]:
    """Statements of the task about an object that the object's true state contradicts."""
    where = f"objects[{task.objects.index(placed)}]"
    things, state = {thing.id: thing for thing in house.things}, states[placed.id]
    things |= {other.id: as_thing(other) for other in task.objects if other is not placed}
    half = catalog.kind(placed.kind).size[2] / 2
    on_it = placed.support in things and things[placed.support].parent == state.support != ""
    if state.support != placed.support and not on_it:
        reason = f"'{placed.id}' rests on '{state.support or 'the floor'}', not on '{placed.support or 'the floor'}'"
        yield f"{where}.support", reason
    elif placed.support and not _holds(things[placed.support], state.position, half, within=placed.relation == "in"):
        yield f"{where}.relation", f"'{placed.id}' is not {placed.relation} '{placed.support}'"
    if placed.near:
        gap = _gap(state.position, things.get(placed.near), states.get(placed.near))
        if not gap <= NEAR_M:
            yield f"{where}.near", f"'{placed.id}' is {gap:.2f} m from '{placed.near}', more than {NEAR_M} m"


def _holds(thing: Thing, point: Vec3, half: float, *, within: bool) -> bool:
    """Whether an object, which reaches ``half`` [m] above and below ``point``, is over a thing's outline and, if
    ``within`` (as in a sink or a fridge), inside its height, otherwise on top of a part of it.
    """
    u, v = _seen_from(thing, point)
    low, foot = thing.centre[2] - thing.size[2] / 2, point[2] - half
    high = low + thing.size[2]
    inside = abs(u) <= thing.size[0] / 2 and abs(v) <= thing.size[1] / 2
    if within:
        return inside and low - _DEEP_M <= foot <= high - _DEEP_M
    return inside and low + _DEEP_M < foot <= high + _DEEP_M


def _gap(point: Vec3, thing: Thing | None, other: ThingState | None) -> float:
    """Distance [m] on the plan to a thing's edge or else an object's middle; inf without either."""
    if thing is not None:
        u, v = _seen_from(thing, point)
        return math.hypot(max(abs(u) - thing.size[0] / 2, 0.0), max(abs(v) - thing.size[1] / 2, 0.0))
    return math.inf if other is None else math.dist(point[:2], other.position[:2])


def _seen_from(thing: Thing, point: Vec3) -> tuple[float, float]:
    """Position of a point along a thing's width and along its depth [m], from its middle."""
    away = complex(point[0] - thing.centre[0], point[1] - thing.centre[1])
    turned = away * complex(math.cos(thing.yaw), -math.sin(thing.yaw))
    return turned.real, turned.imag


def _played(world: World, task: TaskSpec) -> tuple[float, float, list[tuple[str, str]]]:
    """The time [s] and the walk [m] of a person who does the task alone, and the faults that this shows."""
    many = len(task.goal.todo) > 1
    if any(job.hands > 1 for job in task.goal.todo):
        return 0.0, 0.0, []
    world.reset(task)
    kind = plugins.load("task kind", task.kind)
    if kind.met(task, world.snapshot(), world.house):
        return 0.0, 0.0, [("human_start", "the goal is met before anybody has moved")]
    feat = omniscient_solver.solve(world, task, limit_s=_PATIENCE * task.time_limit if many else None)
    faults = []
    if not feat.met:
        faults.append(("goal", f"a person who knows everything does not meet it: {feat.reason}"))
    elif kind.least(task) > feat.seconds:
        faults.append(("t_star", f"means at least {kind.least(task)} s, but {feat.seconds} s were enough"))
    return feat.seconds, feat.metres, faults


def _chunks(tasks: Sequence[TaskSpec]) -> list[list[TaskSpec]]:
    """Tasks of one house together, so that a worker builds few worlds, and few at a time, so that all end together."""
    by_house: dict[str, list[TaskSpec]] = {}
    for task in tasks:
        by_house.setdefault(task.house, []).append(task)
    return [own[first : first + _CHUNK] for own in by_house.values() for first in range(0, len(own), _CHUNK)]


def _examine(tasks: Sequence[TaskSpec], houses: HouseLibrary) -> list[TaskVerdict]:
    return [check_task(task, houses) for task in tasks]


def _begin(parent: int) -> None:
    """End with the parent, and ignore Ctrl-C, which the parent handles."""
    worker.end_with_parent(parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@lru_cache(maxsize=32)
def _house(houses: HouseLibrary, name: str, sha256: str) -> HouseSpec:  # noqa: ARG001 - a file may change
    """The house of that name, loaded once for all tasks that were made for its version ``sha256``."""
    return houses.load(name)


@cache
def _world(house: HouseSpec, objects: tuple[tuple[str, str], ...]) -> World:
    from hthor.world import World

    return World(house, objects=objects)
