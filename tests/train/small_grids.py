"""Pose grids that are made in no time, for tests of what learns from them."""

from __future__ import annotations

import numpy as np

from hthor.agents.skills.semantic_cells import CELLS, CLASSES, GOALS
from hthor.train.grid_worlds import TURNS
from hthor.train.pose_grid import PoseGrid

SIDE = 5
STEPS = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))


def make_grid(seed: int) -> PoseGrid:
    """Two square rooms side by side that are joined at one place between them; cells show random classes, but a goal in
    view is always shown in the middle.
    """
    rng = np.random.default_rng(seed)
    where = [(i, j) for i in range(2 * SIDE + 1) for j in range(SIDE) if i != SIDE or j == SIDE // 2]
    index = {key: number for number, key in enumerate(where)}
    ahead = np.array(
        [[index.get((i + di, j + dj), number) for di, dj in STEPS] for number, (i, j) in enumerate(where)], np.int32
    )
    rooms = np.array([-1 if i == SIDE else int(i > SIDE) for i, _ in where], np.int32)
    poses = len(where) * TURNS
    shown = rng.integers(0, len(CLASSES), (poses, CELLS)).astype(np.uint8)
    goal = rng.integers(0, len(GOALS), poses)
    seen = rng.random(poses) < 0.3
    shown[seen, CELLS // 2] = [CLASSES.index(GOALS[one]) for one in goal[seen]]
    return PoseGrid(
        places=np.array(where) * 0.25,
        rooms=rooms,
        ahead=ahead,
        shown=shown,
        behind=np.zeros((poses, CELLS), np.uint8),
        depth=rng.integers(0, 256, (poses, CELLS)).astype(np.uint8),
        visible=np.where(seen, 1 << goal, 0).astype(np.uint16),
    )
