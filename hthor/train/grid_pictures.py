"""What the robot's colour pictures show from the poses of grids: to train an encoder with, and encoded for robots that
read them. Kept in the user's cache like the grids.
"""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
import torch
from msgspec import structs
from numpy.typing import NDArray

from hthor import catalog, seeds
from hthor.agents.skills import picture_encoder
from hthor.agents.skills.semantic_cells import CLASSES, Bytes
from hthor.train import array_cache, houses
from hthor.train.array_cache import Arrays, Entry, Progress
from hthor.train.grid_data import ROBOT, Key, build_grids, load_grid, origin
from hthor.train.pose_grid import PoseGrid, draw_pictures

_AT_ONCE = 64
"""Pictures that an encoder gets at a time."""
_CODE = "hthor.agents.skills.picture_encoder"


class Pictures(NamedTuple):
    """Pictures (N, H, W, 3) uint8, and of their cells what they show and how far off it is, each (N, 49) uint8, see
    `hthor.agents.skills.semantic_cells.Cells`.
    """

    rgb: NDArray[np.uint8]
    shown: Bytes
    depth: Bytes


def load_pictures(
    split: houses.Split,
    count: int,
    each: int,
    *,
    jobs: int | None = None,
    building: Progress | None = None,
    drawing: Progress | None = None,
) -> Pictures:
    """``each`` pictures from each of the first ``count`` houses of a split.

    Their poses are drawn at random, half of them among those from which a thing to bring is in view, as far as there
    are so many: from most poses none is.

    Args:
        jobs: processes that make what is missing, one for each processor if None. building, drawing: are called with
            the number of grids, or of houses whose pictures are there, and of all.

    Raises:
        HthorError: when no house has room for its objects.
    """
    grids = build_grids(split, count, 1, jobs=jobs, progress=building)
    entries = [Entry(array_cache.place("pictures", *origin(key), each), _draw, (*key, each)) for key in grids]
    array_cache.fill(entries, jobs, drawing)
    rgb, shown, depth = [], [], []
    for grid, entry in zip(grids.values(), entries, strict=True):
        arrays = array_cache.read(entry) or {}
        rgb.append(arrays["rgb"])
        shown.append(grid.shown[arrays["pose"]])
        depth.append(grid.depth[arrays["pose"]])
    return Pictures(np.concatenate(rgb), np.concatenate(shown), np.concatenate(depth))


def load_grids(
    split: houses.Split,
    count: int,
    arrangements: int,
    *,
    encoder: bytes | None = None,
    jobs: int | None = None,
    building: Progress | None = None,
    drawing: Progress | None = None,
) -> list[PoseGrid]:
    """Grids as `build_grids` gives them, with an encoder's codes of the pictures from all poses if there is one.

    Drawing all pictures takes longer than building the grids.

    Args:
        encoder: weights, see `hthor.agents.skills.picture_encoder.dump`. jobs, building, drawing: see `load_pictures`.

    Raises:
        HthorError: when no house has room for its objects.
    """
    grids = build_grids(split, count, arrangements, jobs=jobs, progress=building)
    if encoder is None:
        return list(grids.values())
    weights = hashlib.sha256(encoder).hexdigest()
    entries = [
        Entry(array_cache.place("picture_codes", *origin(key, _CODE), weights), _encode, (*key, encoder))
        for key in grids
    ]
    array_cache.fill(entries, jobs, drawing)
    return [
        structs.replace(grid, codes=(array_cache.read(entry) or {})["codes"])
        for grid, entry in zip(grids.values(), entries, strict=True)
    ]


def _draw(split: houses.Split, house: int, arrangement: int, each: int) -> Arrays:
    key = (split, house, arrangement)
    grid = load_grid(key)
    chance = np.random.default_rng(seeds.derive(0, "pictures", *key))
    things = np.array([index for index, name in enumerate(CLASSES) if name in catalog.TARGETS])
    in_view = np.flatnonzero(np.isin(grid.shown, things).any(axis=1))
    some = chance.choice(in_view, min(each // 2, len(in_view)), replace=False)
    others = np.setdiff1d(np.arange(len(grid.visible)), some)
    poses = np.sort(np.append(some, chance.choice(others, min(each - len(some), len(others)), replace=False)))
    return {"pose": poses, "rgb": np.stack(list(_pictures(key, grid, poses.tolist())))}


def _encode(split: houses.Split, house: int, arrangement: int, encoder: bytes) -> Arrays:
    torch.set_num_threads(1)  # each process has one processor
    key = (split, house, arrangement)
    grid, network = load_grid(key), picture_encoder.load(encoder)
    pictures = _pictures(key, grid, range(len(grid.visible)))
    codes = [
        network.encode(torch.from_numpy(np.stack(some))).numpy()
        for some in iter(lambda: list(itertools.islice(pictures, _AT_ONCE)), [])
    ]
    return {"codes": np.concatenate(codes)}


def _pictures(key: Key, grid: PoseGrid, poses: Iterable[int]) -> Iterator[NDArray[np.uint8]]:
    spec = houses.make_house(key[0], key[1])
    return draw_pictures(spec, houses.make_arrangement(spec, key[2]), ROBOT, grid.places, poses)
