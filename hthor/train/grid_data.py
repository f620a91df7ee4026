"""Pose grids of many houses, built in parallel and kept in the user's cache."""

from __future__ import annotations

import io
import multiprocessing
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

import numpy as np

from hthor import code_identity, installation, jsonio
from hthor.errors import HthorError
from hthor.train import houses
from hthor.train.pose_grid import PoseGrid, build_grid

ROBOT = "scout"
"""The body whose sensors and reach the grids have."""

Progress = Callable[[int, int], None]
"""Is called with the number of grids that are there, and of all."""


def load_grids(
    split: houses.Split, count: int, arrangements: int, *, jobs: int | None = None, progress: Progress | None = None
) -> list[PoseGrid]:
    """The grids of the first ``count`` houses of a split with so many arrangements each, in the order of the houses.

    An arrangement whose objects have no place in its house is left out, and so is a seed that gives no house. Grids
    that are not yet in the cache are built by ``jobs`` processes, one for each processor if None; each takes seconds.

    Raises:
        HthorError: when none is left.
    """
    places = {(split, house, one): _place(split, house, one) for house in range(count) for one in range(arrangements)}
    waiting = [one for one, place in places.items() if not place.is_file()]
    if waiting:
        _build(waiting, len(places), jobs, progress)
    elif progress is not None:
        progress(len(places), len(places))
    grids = [grid for place in places.values() if (grid := _read(place)) is not None]
    if not grids:
        raise HthorError(f"none of the first {count} houses of the split {split!r} has room for its objects; take more")
    return grids


def _build(
    waiting: list[tuple[houses.Split, int, int]], total: int, jobs: int | None, progress: Progress | None
) -> None:
    code_identity.keep_compiled()
    context = multiprocessing.get_context("spawn")  # threads of the caller do not survive a fork
    with ProcessPoolExecutor(jobs or os.cpu_count(), mp_context=context) as pool:
        building = [pool.submit(_write, *one) for one in waiting]
        for done, future in enumerate(as_completed(building), total - len(waiting) + 1):
            future.result()
            if progress is not None:
                progress(done, total)


def _write(split: houses.Split, house: int, arrangement: int) -> None:
    """Build a grid and keep it; an empty file stands for a house or an arrangement that there is none of."""
    out = io.BytesIO()
    try:
        spec = houses.make_house(split, house)
        grid = build_grid(spec, houses.make_arrangement(spec, arrangement), ROBOT)
    except HthorError:
        pass
    else:
        np.savez_compressed(out, **{name: getattr(grid, name) for name in PoseGrid.__struct_fields__})
    jsonio.write(_place(split, house, arrangement), out.getvalue())


def _read(place: Path) -> PoseGrid | None:
    data = place.read_bytes()
    if not data:
        return None
    with np.load(io.BytesIO(data)) as held:
        return PoseGrid(**{name: held[name] for name in PoseGrid.__struct_fields__})


def _place(split: str, house: int, arrangement: int) -> Path:
    """The file of a grid, named by the hash of all that it depends on."""
    modules, parts = ("hthor.train.houses", "hthor.train.pose_grid"), (code_identity.SIMULATION, code_identity.PICTURES)
    code = code_identity.modules_sha256(modules, parts)
    key = jsonio.sha256([split, house, arrangement, ROBOT, code_identity.robot_sha256(ROBOT), code])
    return installation.cache() / "pose_grids" / f"{key}.npz"
