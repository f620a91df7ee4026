"""Pose grids of many houses, built in parallel and kept in the user's cache."""

from __future__ import annotations

from typing import TypeAlias

from hthor import code_identity
from hthor.errors import HthorError
from hthor.train import array_cache, houses
from hthor.train.array_cache import Arrays, Entry, Progress
from hthor.train.pose_grid import PoseGrid, build_grid

ROBOT = "scout"
"""The body whose sensors and reach the grids have."""
Key: TypeAlias = tuple[houses.Split, int, int]
"""A split, the number of a house in it, and that of an arrangement."""


def build_grids(
    split: houses.Split, count: int, arrangements: int, *, jobs: int | None = None, progress: Progress | None = None
) -> dict[Key, PoseGrid]:
    """The grids of the first ``count`` houses of a split with so many arrangements each, in the order of the houses.

    An arrangement whose objects have no place in its house is left out, and so is a seed that gives no house. Grids
    that are not yet in the cache are built by ``jobs`` processes, one for each processor if None; each takes seconds.

    Raises:
        HthorError: when none is left.
    """
    keys: list[Key] = [(split, house, one) for house in range(count) for one in range(arrangements)]
    entries = {key: _entry(key) for key in keys}
    array_cache.fill(list(entries.values()), jobs, progress)
    grids = {key: grid for key in keys if (grid := _read(entries[key])) is not None}
    if not grids:
        raise HthorError(f"none of the first {count} houses of the split {split!r} has room for its objects; take more")
    return grids


def load_grid(key: Key) -> PoseGrid:
    """A grid that is in the cache.

    Raises:
        OSError: when it is not. HthorError: when its house has no room for its objects.
    """
    grid = _read(_entry(key))
    if grid is None:
        raise HthorError(f"there is no pose grid of {key}")
    return grid


def origin(key: Key, *modules: str) -> tuple[object, ...]:
    """What a grid depends on, and with ``modules`` what else is made by them."""
    parts = (code_identity.SIMULATION, code_identity.PICTURES)
    code = code_identity.modules_sha256(("hthor.train.houses", "hthor.train.pose_grid", *modules), parts)
    return (*key, ROBOT, code_identity.robot_sha256(ROBOT), code)


def _entry(key: Key) -> Entry:
    return Entry(array_cache.place("pose_grids", *origin(key)), _make, key)


def _make(split: houses.Split, house: int, arrangement: int) -> Arrays | None:
    """The arrays of a grid; None for a house or an arrangement that there is none of."""
    try:
        spec = houses.make_house(split, house)
        grid = build_grid(spec, houses.make_arrangement(spec, arrangement), ROBOT)
    except HthorError:
        return None
    return {name: getattr(grid, name) for name in PoseGrid.__struct_fields__ if name != "codes"}


def _read(entry: Entry) -> PoseGrid | None:
    arrays = array_cache.read(entry)
    return None if arrays is None else PoseGrid(**arrays)
