"""Makes tasks and suites: goals, arrangements and starts, drawn by name.

``python -m hthor.tasks.generation.generate smoke`` writes ``suites/data/smoke.json`` again, with the same bytes as long
as the houses, the catalogue, the rules and this code stay the same. A second argument names another file to write.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import msgspec

from hthor import houses, jsonio, plugins, seeds
from hthor.catalog.priors import Triplet
from hthor.errors import HthorError, UnknownName
from hthor.tasks.arrangement.target_arrangement import arrange
from hthor.tasks.generation import difficulty
from hthor.tasks.generation.difficulty import Level
from hthor.tasks.generation.start_poses import StartPoses, draw_start_poses
from hthor.tasks.generation.suite_specs import ROBOTS, SUITE_SPECS, SuiteSpec, TaskOrder
from hthor.tasks.kind import TaskKind
from hthor.tasks.suite import Suite, encode_suite, in_turn, make_suite
from hthor.tasks.suites import library
from hthor.types import Goal, HouseSpec, Placement, TaskSpec

_CLOSE_S = 0.5
Split = Literal["", "seen", "new"]
_TRIES = 20


def build_suite(spec: SuiteSpec) -> Suite:
    """The suite that a specification describes: the first task of each house, then the second of each, and so on.

    Raises:
        HthorError: when a house has no room for one of its tasks.
    """
    columns = [house_tasks(spec, houses.load(name)) for name in spec.houses]
    return make_suite(spec.name, spec.version, tuple(in_turn(columns)))


def house_tasks(spec: SuiteSpec, house: HouseSpec) -> tuple[TaskSpec, ...]:
    """The tasks of a specification in one house."""
    return tuple(make_ordered_task(spec, house, order) for order in spec.orders(spec, house))


def make_ordered_task(
    spec: SuiteSpec, house: HouseSpec, order: TaskOrder, lap: int | None = None, split: Split = ""
) -> TaskSpec:
    """One task of a suite, independent of its other tasks.

    Args:
        lap: how often it was drawn before; None for the number in `SuiteSpec.redrawn`. split: as for `make_task`.
    """
    word, laps = ("again", dict(spec.redrawn).get(order.name, 0)) if lap is None else ("lap", lap)
    return make_task(
        house,
        plugins.load("task kind", order.kind),
        order.goal,
        seeds.derive(spec.root, word, laps) if laps else spec.root,
        name=order.name,
        fixed=order.fixed,
        share=order.share,
        robots=spec.robots,
        candidates=spec.candidates,
        level=order.level,
        split=split,
        serial=spec.serial,
        record_difficulty=spec.record_difficulty,
        phases=spec.phases,
    )


def make_task(
    house: HouseSpec,
    kind: TaskKind,
    goal: Goal | None,
    root: int,
    *,
    name: str,
    fixed: Triplet | None = None,
    share: float | None = None,
    robots: int = ROBOTS,
    candidates: int = 2,
    level: Level | Literal[""] = "",
    split: Split = "",
    serial: bool = False,
    record_difficulty: bool = True,
    phases: bool = True,
) -> TaskSpec:
    """A task of any kind, fixed by ``root`` and ``name``.

    Args:
        goal: the goal; if None, the kind draws a goal and an arrangement (`TaskKind.draw`).
        name: the task's id, such as ``navigation/alder/apple-in-fridge``.
        fixed: a triplet that must hold for the goal's target.
        share: how hard, in [0, 1]: the intended size is at that share of the range `TaskKind.intended_s`; drawn
            when None.
        robots: how many robots have start poses.
        candidates: how many arrangements are compared, to take the nearest to that size; a near one ends the search.
        level: the required stratum of difficulty, empty for any.
        split: whether the house is one of the ten scenes; empty when the suite does not record that.
        serial: as for `hthor.tasks.arrangement.target_arrangement.arrange`.
        record_difficulty: whether the task records its difficulty.
        phases: whether the task has the phases of its kind.

    Raises:
        HthorError: when the house has no arrangement or no start poses for it.
    """
    hardness = seeds.draw(root, name, "share") if share is None else share
    easiest, hardest = kind.intended_s
    wanted = easiest + hardness * (hardest - easiest)
    best: tuple[float, TaskSpec, int] | None = None
    reason = ""
    for attempt in range(2 * _TRIES):
        own = seeds.derive(root, name, attempt)
        try:
            aim, objects = _scene(house, kind, goal, own, fixed, serial)
        except HthorError as error:
            reason = f": {error}"
            continue
        found = draw_start_poses(house, kind, aim, objects, wanted, own, robots=robots, strict=attempt < _TRIES)
        if found is None:
            continue
        made = kind.completed(_spec(house, kind, name, found, aim, objects), house)
        problem = kind.misfit(made, house)
        if problem or (level and difficulty.level_of(made, house, kind) != level):
            reason = f": {problem or f'none was {level}'}"
            continue
        if best is None or abs(found.size - wanted) < abs(best[0] - wanted):
            best = (found.size, made, own)
        if best is not None and (abs(best[0] - wanted) <= _CLOSE_S or attempt + 1 >= candidates):
            break
    if best is None:
        raise HthorError(f"no arrangement was found for task '{name}' in {2 * _TRIES} tries{reason}")
    made = msgspec.structs.replace(best[1], split=split)
    if phases:
        made = msgspec.structs.replace(made, phases=kind.phases(made, house, best[2]))
    if not record_difficulty:
        return made
    return msgspec.structs.replace(made, difficulty=difficulty.level_of(made, house, kind))


def _scene(
    house: HouseSpec, kind: TaskKind, goal: Goal | None, root: int, fixed: Triplet | None, serial: bool
) -> tuple[Goal, tuple[Placement, ...]]:
    if goal is None:
        return kind.draw(house, root)
    return goal, arrange(house, root, {goal.target: goal.destination}, fixed=fixed, serial=serial)


def _spec(
    house: HouseSpec, kind: TaskKind, name: str, start: StartPoses, goal: Goal, objects: tuple[Placement, ...]
) -> TaskSpec:
    return TaskSpec(
        id=name,
        kind=kind.name,
        house=house.id,
        house_sha256=house.sha256,
        human_start=start.poses[0],
        robot_starts=start.poses[1:],
        objects=objects,
        goal=goal,
        instruction=kind.instruction(goal, objects),
        time_limit=kind.time_limit,
        t_star=kind.t_star_of(start.least),
    )


def main(arguments: Sequence[str]) -> int:
    """Write the suite of the given name."""
    try:
        if not arguments or arguments[0] not in SUITE_SPECS:
            raise UnknownName("suite specification", arguments[0] if arguments else "", SUITE_SPECS)
        path = Path(arguments[1]) if len(arguments) > 1 else library.suite_path(arguments[0])
        jsonio.write(path, encode_suite(build_suite(SUITE_SPECS[arguments[0]])))
    except HthorError as error:
        sys.stderr.write(f"{error}\n")
        return error.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
