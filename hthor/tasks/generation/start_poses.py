"""Start poses of the person and the robots, chosen so that the size of the task is near an intended one."""

import math

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor import seeds
from hthor.houses.space.free_space import FreeSpace
from hthor.tasks.arrangement.reachability import HEIGHT_M, START_MARGIN_M, ReachableFloor, entry_cells
from hthor.tasks.kind import TaskKind
from hthor.types import Goal, HouseSpec, Placement, Pose

Floats = NDArray[np.float64]

AWAY_M = 3.0
"""Least distance of a start from the target: the way to a place within reach of it, plus the straight rest."""
APART_M = 1.2
"""Least distance between two starts."""
_STARTS = 400


class StartPoses(Struct, frozen=True, kw_only=True):
    """All start poses, the person's first, the ``least`` time [s] from there, and the `TaskKind.size_of` [s]."""

    least: float
    size: float
    poses: tuple[Pose, ...]


def draw_start_poses(
    house: HouseSpec,
    kind: TaskKind,
    goal: Goal,
    objects: tuple[Placement, ...],
    wanted: float,
    root: int,
    *,
    robots: int,
    strict: bool = True,
) -> StartPoses | None:
    """Starts of the person and of ``robots`` robots, with a size as near to ``wanted`` [s] as the floor allows.

    The person starts on ample floor, at least `AWAY_M` from the target, and does not see it from close by.

    Args:
        root: root of all draws.
        strict: whether the last two conditions must hold; otherwise a condition that leaves no place is dropped.

    Returns:
        None when the goal is met already at every possible start, or cannot be met from any.
    """
    if kind.solved(goal, objects, house):
        return None
    places = _places(house, root)
    target = next((placement for placement in objects if placement.id == goal.target), None)
    fits = places if target is None else _unseen(house, target, _away(house, target, places))
    fits, times = _possible(kind, house, objects, goal, fits)
    if not len(fits) and not strict:
        fits, times = _possible(kind, house, objects, goal, places)
    if not len(fits):
        return None
    sizes = kind.size_of(house, objects, goal, times)
    first = int(np.argmin(np.abs(sizes - wanted)))
    chosen = [fits[first]]
    for place in fits if strict else np.concatenate((fits, places)):
        if len(chosen) <= robots and all(math.dist(place, other) >= APART_M for other in chosen):
            chosen.append(place)
    if len(chosen) <= robots:
        return None
    poses = tuple(_pose(place, root, number) for number, place in enumerate(chosen))
    least, size = round(float(times[first]), 3), round(float(sizes[first]), 3)
    return StartPoses(least=least, size=size, poses=poses)


def _possible(
    kind: TaskKind, house: HouseSpec, objects: tuple[Placement, ...], goal: Goal, places: Floats
) -> tuple[Floats, Floats]:
    """The places from which the goal can be met, and the least time [s] from each."""
    if not len(places):
        return places, np.zeros(0)
    times = kind.least_times(house, objects, goal)(places)
    there = np.isfinite(times)
    return places[there], times[there]


def _away(house: HouseSpec, target: Placement, places: Floats) -> Floats:
    """The places that are at least `AWAY_M` from the target, by way of a cell from which it can just be reached."""
    ground = ReachableFloor.of(house)
    reach = ground.space.centres(entry_cells(ground.touching(target), ground.space.free))
    rest = np.hypot(reach[:, 0] - target.position[0], reach[:, 1] - target.position[1])
    far: Floats = places[ground.paths.field(reach, rest).at(places) >= AWAY_M]
    return far


def _unseen(house: HouseSpec, target: Placement, places: Floats) -> Floats:
    ground = ReachableFloor.of(house)
    seeing = ground.seeing(target)
    out: Floats = places[np.array([not seeing[ground.space.cell_of(x, y)] for x, y in places], dtype=bool)]
    return out


def _places(house: HouseSpec, root: int) -> Floats:
    """(N, 2) [m] places to start from, in random order: ample free floor connected to the house's start."""
    ground, ample = ReachableFloor.of(house), FreeSpace.of(house, START_MARGIN_M, HEIGHT_M)
    joined = ground.space.component(*ground.space.nearest_free(house.start.x, house.start.y))
    cells = ample.centres(ample.free & joined & (ample.components == _largest(ample)))
    picks = [int(seeds.draw(root, "start", number) * len(cells)) for number in range(_STARTS)]
    chosen: Floats = np.round(cells[list(dict.fromkeys(picks))], 4)
    return chosen


def _largest(space: FreeSpace) -> int:
    """The number of the component with the most cells."""
    return int(np.bincount(space.components[space.free]).argmax()) if space.free.any() else 0


def _pose(place: Floats, root: int, number: int) -> Pose:
    yaw = math.pi * (2 * seeds.draw(root, "yaw", number) - 1)
    return Pose(x=float(place[0]), y=float(place[1]), yaw=round(yaw, 4))
