"""Checks every task of a suite against its kind, its house and the catalogue, without the physics engine.

`hthor tasks check` also proves tasks in the simulated world.
"""

import math
import shlex
from collections.abc import Iterator, Sequence

import msgspec
from msgspec import Struct

from hthor import catalog, plugins
from hthor.errors import HouseError, HthorError, TaskError, UnknownName
from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.solids import overlap_depth
from hthor.tasks.arrangement.placement import SupportSurfaces, as_thing, footprint, rests_on, supports_of
from hthor.tasks.arrangement.reachability import HEIGHT_M, RADIUS_M
from hthor.tasks.kind import TaskKind
from hthor.tasks.suite import Suite
from hthor.types import HouseSpec, Placement, TaskSpec

CODE_PART = "tools"

_ALOFT_M = 0.01
"""How far an object may be above or below the surface that it names as its support, or inside another thing."""
_LISTED = 20
"""How many tasks an error message names; the others are only counted."""


class TaskFault(Struct, frozen=True, kw_only=True):
    """A fault of a task of a suite: the task's index in the suite and its id, the field and the problem."""

    index: int
    task: str
    field: str
    problem: str


def validate(suite: Suite, file: str) -> None:
    """Check every task against its kind, its house and the catalogue.

    Raises:
        TaskError: names the first fault, the tasks that have faults, and the command that shows all faults.
    """
    if not suite.tasks:
        raise TaskError(file, "tasks", "is empty; a suite needs at least one task")
    found = tuple(find_faults(suite))
    if found:
        raise TaskError(file, f"tasks[{found[0].index}].{found[0].field}", _words(found, suite, file))


def find_faults(suite: Suite) -> Iterator[TaskFault]:
    """All faults of a suite's tasks, in the suite's order."""
    seen: set[str] = set()
    loaded: dict[str, HouseSpec | str] = {}
    for index, task in enumerate(suite.tasks):
        if task.house not in loaded:
            loaded[task.house] = _house(task.house, suite)
        house = loaded[task.house]
        rows = [("house", house)] if isinstance(house, str) else list(task_faults(task, house))
        if task.id in seen:
            rows.insert(0, ("id", f"'{task.id}' is the id of an earlier task; ids must be distinct"))
        seen.add(task.id)
        for field, problem in rows:
            yield TaskFault(index=index, task=task.id, field=field, problem=problem)


def _words(found: Sequence[TaskFault], suite: Suite, file: str) -> str:
    """The first problem, then all tasks that have a problem."""
    ids = list(dict.fromkeys(one.task for one in found))
    if len(ids) == 1:
        return found[0].problem
    listed = ", ".join(ids[:_LISTED]) + (f" and {len(ids) - _LISTED} more" if len(ids) > _LISTED else "")
    many = f"{len(ids)} of the suite's {len(suite.tasks)} tasks cannot be run as they are: {listed}."
    return f"{found[0].problem}. {many} 'hthor tasks check {shlex.quote(file)}' says what is wrong with each."


def task_faults(task: TaskSpec, house: HouseSpec) -> Iterator[tuple[str, str]]:
    """All faults of a task in its house: pairs of a field and a problem."""
    if task.house_sha256 != house.sha256:
        yield "house_sha256", f"the task was made for {task.house_sha256}, the house '{task.house}' is {house.sha256}"
        return
    yield from _objects(task, house)
    yield from _phases(task, house)
    yield from _goal(task, house)
    yield from _starts(task, house)
    for field, value in (("time_limit", task.time_limit), ("t_star", task.t_star)):
        if not (math.isfinite(value) and value > 0.0):
            yield field, f"must be a positive number of seconds, got {value}"


def _house(name: str, suite: Suite) -> HouseSpec | str:
    """The house of that name, or why it cannot be loaded."""
    try:
        return suite.houses.load(name)
    except (UnknownName, HouseError) as error:
        return str(error)


def _objects(task: TaskSpec, house: HouseSpec) -> Iterator[tuple[str, str]]:
    shelves, ids = SupportSurfaces.of(house), {thing.id for thing in house.things}
    taken: set[str] = set()
    for number, placement in enumerate(task.objects):
        where = f"objects[{number}]"
        if placement.id in taken or placement.id in ids:
            yield f"{where}.id", f"'{placement.id}' is taken; ids must be distinct from other objects' and the house's"
        taken.add(placement.id)
        try:
            kind = catalog.kind(placement.kind)
        except UnknownName as error:
            yield f"{where}.kind", str(error)
            continue
        if not kind.pickable:
            yield f"{where}.kind", f"'{placement.kind}' cannot be picked up, so it cannot be an object of a task"
        yield from _support(where, placement, shelves, task, house)
        if crowd := shelves.within(placement, _ALOFT_M):
            yield f"{where}.position", f"'{placement.id}' and '{crowd}' of the house are in one another"
        for other in task.objects[:number]:
            if other.kind in catalog.names() and overlap_depth(footprint(placement), footprint(other)) > _ALOFT_M:
                yield f"{where}.position", f"'{placement.id}' and '{other.id}' are in one another"


def _phases(task: TaskSpec, house: HouseSpec) -> Iterator[tuple[str, str]]:
    kinds, names = {placement.id: placement.kind for placement in task.objects}, [phase.name for phase in task.phases]
    for number, phase in enumerate(task.phases):
        where = f"phases[{number}]"
        if not phase.name or phase.name in names[:number]:
            yield f"{where}.name", f"'{phase.name}' is empty or the name of an earlier phase"
        if not (math.isfinite(phase.time_limit) and phase.time_limit > 0.0):
            yield f"{where}.time_limit", f"must be a positive number of seconds, got {phase.time_limit}"
        for placement in phase.objects:
            if kinds.get(placement.id) != placement.kind:
                problem = f"'{placement.id}', a {placement.kind}, is not one of the task's objects"
                yield f"{where}.objects", f"{problem}; valid: {', '.join(kinds)}"
        shown = msgspec.structs.replace(task, objects=phase.objects)
        yield from ((f"{where}.{field}", problem) for field, problem in _objects(shown, house))


def _support(
    where: str, placement: Placement, shelves: SupportSurfaces, task: TaskSpec, house: HouseSpec
) -> Iterator[tuple[str, str]]:
    things = {thing.id: thing for thing in house.things}
    things |= {other.id: as_thing(other) for other in task.objects if other.kind in catalog.names()}
    if placement.near and placement.near not in things.keys() - {placement.id}:
        yield f"{where}.near", f"there is no thing or object '{placement.near}'; valid: {', '.join(sorted(things))}"
    if not placement.support:
        if not shelves.lies(house, placement, ()):
            yield f"{where}.position", f"'{placement.id}' names no support, nor does it lie on free floor"
    elif placement.support not in things.keys() - {placement.id}:
        yield f"{where}.support", f"there is no thing '{placement.support}'; valid: {', '.join(sorted(things))}"
    elif not any(rests_on(placement, rest, _ALOFT_M) for rest in supports_of(things[placement.support])):
        yield f"{where}.position", f"'{placement.id}' rests on no surface of '{placement.support}'"


def _goal(task: TaskSpec, house: HouseSpec) -> Iterator[tuple[str, str]]:
    try:
        kind: TaskKind = plugins.load("task kind", task.kind)
    except UnknownName as error:
        yield "kind", str(error)
        return
    ids = [placement.id for placement in task.objects]
    if task.goal.target not in ids and task.goal.relation != "go":
        yield "goal.target", f"'{task.goal.target}' is not one of the task's objects; valid: {', '.join(ids)}"
        return
    try:
        objection = kind.objection(task.goal, house)
    except HthorError as error:
        objection = str(error)
    if objection:
        yield "goal", objection
    elif kind.solved(task.goal, task.objects, house):
        yield "goal", "is met before anybody has moved"


def _starts(task: TaskSpec, house: HouseSpec) -> Iterator[tuple[str, str]]:
    space = FreeSpace.of(house, RADIUS_M, HEIGHT_M)
    starts = [("human_start", task.human_start)]
    starts += [(f"other_human_starts[{number}]", pose) for number, pose in enumerate(task.other_human_starts)]
    starts += [(f"robot_starts[{number}]", pose) for number, pose in enumerate(task.robot_starts)]
    for field, pose in starts:
        if not space.is_free(pose.x, pose.y):
            yield field, f"({pose.x:g}, {pose.y:g}) is in a wall or furniture, or less than {RADIUS_M} m from it"
