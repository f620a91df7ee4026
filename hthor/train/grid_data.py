"""The grids of many houses, built in parallel and kept in the user's cache."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed

from hthor import code_identity
from hthor.errors import HthorError
from hthor.train import houses
from hthor.train.pose_grid import PoseGrid, load_grid

Progress = Callable[[int, int], None]
"""Is called with the number of grids that are there, and of all."""


def load_grids(
    split: houses.Split, count: int, arrangements: int, *, jobs: int | None = None, progress: Progress | None = None
) -> list[PoseGrid]:
    """The grids of the first ``count`` houses of a split with so many arrangements each, in the order of the houses.

    An arrangement whose objects have no place in its house is left out, and so is a seed that gives no house. Grids
    that are not yet in the cache are built by ``jobs`` processes, one for each processor if None.
    """
    code_identity.keep_compiled()
    wanted = [(split, house, one) for house in range(count) for one in range(arrangements)]
    context = multiprocessing.get_context("spawn")  # threads of the caller do not survive a fork
    with ProcessPoolExecutor(jobs or os.cpu_count(), mp_context=context) as pool:
        waiting = [pool.submit(_prepare, *one) for one in wanted]
        for done, _ in enumerate(as_completed(waiting), 1):
            if progress is not None:
                progress(done, len(wanted))
        there = [one for one, future in zip(wanted, waiting, strict=True) if future.result()]
    grids = [_load(*one) for one in there]
    return [grid for grid in grids if grid is not None]


def _prepare(split: str, house: int, arrangement: int) -> bool:
    """Build a grid unless it is in the cache; whether it is there now."""
    return _load(split, house, arrangement) is not None


def _load(split: str, house: int, arrangement: int) -> PoseGrid | None:
    try:
        spec = houses.make_house(split, house)
        objects = houses.make_arrangement(spec, arrangement)
    except HthorError:
        return None
    return load_grid(spec, objects)
