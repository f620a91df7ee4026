"""Making suites: goals, arrangements and starts, drawn by name from one root; knows nothing of how suites are read.

``python -m hthor.tasks.generate smoke`` writes ``suites/smoke.json`` anew, byte for byte the same as long as the
houses, the catalogue, the rules and this code are. A second argument names another file to write.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor import houses, jsonio, plugins, rules, seeds
from hthor.errors import HthorError, UnknownName
from hthor.houses.freespace import FreeSpace
from hthor.tasks import library
from hthor.tasks.arrange import arrange
from hthor.tasks.avatar import HEIGHT_M, START_MARGIN_M
from hthor.tasks.ground import Ground
from hthor.tasks.kind import TaskKind
from hthor.types import Goal, HouseSpec, Placement, Pose, TaskSpec

Floats = NDArray[np.float64]

AWAY_M = 3.0
"""Least way of a start from the target: to a place from which it is in reach, and on to it as the crow flies."""
APART_M = 1.2
"""Least distance between two starts."""
EASY_S, HARD_S = 4.0, 20.5
"""T* that the easiest and the hardest task of a house are aimed at; a small house falls short of the hardest."""
_CLOSE_S = 0.5
_STARTS = 400
_LOOKS = 6
_TRIES = 20


class Plan(Struct, frozen=True, kw_only=True):
    """What a suite is made of: so many tasks of each kind in each house, from one root of all draws."""

    name: str
    version: int
    root: int
    houses: tuple[str, ...]
    counts: tuple[tuple[str, int], ...]


PLANS = {
    "smoke": Plan(
        name="smoke",
        version=3,
        root=20240608,
        houses=("alder", "birch", "cedar", "elder", "hazel", "juniper", "linden", "maple", "rowan", "willow"),
        counts=(("object_goal_navigation", 2), ("mobile_manipulation", 4)),
    )
}


def build(plan: Plan) -> library.Suite:
    """The suite that a plan describes.

    Raises:
        HthorError: when a house cannot take as many tasks.
    """
    columns = [in_house(plan, houses.load(name)) for name in plan.houses]
    tasks = [task for row in zip(*columns, strict=True) for task in row]
    return library.frozen(plan.name, plan.version, tuple(tasks))


def in_house(plan: Plan, house: HouseSpec) -> tuple[TaskSpec, ...]:
    """One house's tasks of a plan, the kinds spread evenly over the list."""
    shelves: list[tuple[float, int, TaskSpec]] = []
    shift = (seeds.draw(plan.root, house.id, "shift") - 0.5) / max(count for _, count in plan.counts)
    for rank, (name, count) in enumerate(plan.counts):
        kind: TaskKind = plugins.load("task kind", name)
        goals = _goals(kind, house, count, seeds.derive(plan.root, house.id, name))
        levels = seeds.shuffled(count, plan.root, house.id, name, "levels")
        for number, goal in enumerate(goals):
            share = (levels[number] + 0.5) / count
            task = _task(plan, house, kind, goal, number + 1, share)
            shelves.append(((number + 0.5) / count + rank * shift, rank, task))
    return tuple(task for _, _, task in sorted(shelves, key=lambda shelf: shelf[:2]))


def _goals(kind: TaskKind, house: HouseSpec, count: int, root: int) -> list[Goal]:
    """As many goals as wanted, each of the benchmark's once before any comes again, no target twice running."""
    known = kind.goals(house)
    if not known:
        raise HthorError(f"house '{house.id}' has nothing for a task of kind '{kind.name}'")
    order: list[Goal] = []
    for lap in range(math.ceil(count / len(known))):
        order += [known[index] for index in seeds.shuffled(len(known), root, "goals", lap)]
    return order[:count]


def _task(plan: Plan, house: HouseSpec, kind: TaskKind, goal: Goal, number: int, share: float) -> TaskSpec:
    """Of several arrangements and starts the one with T* nearest to what is aimed at."""
    name = f"{plan.name}/{house.id}/{kind.short}-{number:02d}"
    wanted = EASY_S + share * (HARD_S - EASY_S)
    best: tuple[float, tuple[Placement, ...], tuple[Pose, ...]] | None = None
    for attempt in range(_TRIES):
        root = seeds.derive(plan.root, name, attempt)
        objects = arrange(house, root, {goal.target: goal.destination})
        found = _begin(house, kind, goal, objects, wanted, root)
        if found is not None and (best is None or abs(found[0] - wanted) < abs(best[0] - wanted)):
            best = (found[0], objects, found[1])
        if best is not None and (abs(best[0] - wanted) <= _CLOSE_S or attempt + 1 >= _LOOKS):
            break
    if best is None:
        raise HthorError(f"no arrangement was found for task '{name}' in {_TRIES} tries; the house may be too small")
    t_star, objects, poses = best
    return TaskSpec(
        id=name,
        kind=kind.name,
        house=house.id,
        house_sha256=house.sha256,
        human_start=poses[0],
        robot_starts=poses[1:],
        objects=objects,
        goal=goal,
        instruction=kind.instruction(goal, objects),
        time_limit=rules.TIME_LIMIT_S,
        t_star=t_star,
    )


def _begin(
    house: HouseSpec, kind: TaskKind, goal: Goal, objects: tuple[Placement, ...], wanted: float, root: int
) -> tuple[float, tuple[Pose, ...]] | None:
    """T* and the starts of the person and two robots, T* as near to ``wanted`` [s] as the floor allows."""
    ground = Ground.of(house)
    target = next(placement for placement in objects if placement.id == goal.target)
    reach = ground.space.centres(ground.touching(target))
    rest = np.hypot(reach[:, 0] - target.position[0], reach[:, 1] - target.position[1])
    places = _places(house, root)
    places = places[ground.paths.field(reach, rest).at(places) >= AWAY_M]
    seeing = ground.seeing(target)
    places = places[np.array([not seeing[ground.space.cell_of(x, y)] for x, y in places], dtype=bool)]
    times = kind.least_times(house, objects, goal)(places)
    places, times = places[np.isfinite(times)], times[np.isfinite(times)]
    if kind.solved(goal, objects, house) or not len(places):
        return None
    first = int(np.argmin(np.abs(times - wanted)))
    chosen = [places[first]]
    for place in places:
        if len(chosen) < 3 and all(math.dist(place, other) >= APART_M for other in chosen):
            chosen.append(place)
    if len(chosen) < 3:
        return None
    poses = tuple(_pose(place, root, number) for number, place in enumerate(chosen))
    return round(float(times[first]), 3), poses


def _places(house: HouseSpec, root: int) -> Floats:
    """(N, 2) [m] places to start from, in random order: ample free floor that the house's start is joined to."""
    ground, ample = Ground.of(house), FreeSpace.of(house, START_MARGIN_M, HEIGHT_M)
    joined = ground.space.component(*ground.space.nearest_free(house.start.x, house.start.y))
    cells = ample.centres(ample.free & joined & (ample.components == _largest(ample)))
    picks = [int(seeds.draw(root, "start", number) * len(cells)) for number in range(_STARTS)]
    return np.round(cells[list(dict.fromkeys(picks))], 4)


def _largest(space: FreeSpace) -> int:
    """The number of the component with the most cells."""
    return int(np.bincount(space.components[space.free]).argmax()) if space.free.any() else 0


def _pose(place: Sequence[float] | Floats, root: int, number: int) -> Pose:
    yaw = math.pi * (2 * seeds.draw(root, "yaw", number) - 1)
    return Pose(x=float(place[0]), y=float(place[1]), yaw=round(yaw, 4))


def main(arguments: Sequence[str]) -> int:
    """Write the suite of the given name."""
    try:
        if not arguments or arguments[0] not in PLANS:
            raise UnknownName("suite plan", arguments[0] if arguments else "", PLANS)
        path = Path(arguments[1]) if len(arguments) > 1 else library.path_of(arguments[0])
        jsonio.write(path, library.encode(build(PLANS[arguments[0]])))
    except HthorError as error:
        sys.stderr.write(f"{error}\n")
        return error.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
