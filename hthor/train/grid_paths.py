"""Shortest paths over the poses of a grid, in actions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hthor.agents.skills.semantic_cells import GOALS
from hthor.train.pose_grid import Ints

UNREACHABLE = 10_000
"""A number of actions for "never"."""


def path_lengths(successors: Ints, visible: NDArray[np.uint16]) -> NDArray[np.int16]:
    """(P, goals) least number of actions from each pose to one where the goal is in view, `UNREACHABLE` for never.

    Args:
        successors: (P, actions) the poses that actions lead to. visible: (P,) bit g is set where goal g is in view.
    """
    count, actions = successors.shape
    order = np.argsort(successors.ravel(), kind="stable")
    before = (order // actions).astype(np.int32)  # the poses that lead to pose 0, then those to pose 1, and so on
    first = np.searchsorted(successors.ravel()[order], np.arange(count + 1))
    length = np.full((count, len(GOALS)), UNREACHABLE, np.int16)
    for goal in range(len(GOALS)):
        edge = np.flatnonzero(visible >> goal & 1)
        step = 0
        while len(edge):
            length[edge, goal] = step
            step += 1
            sizes = first[edge + 1] - first[edge]
            inside = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
            reached = before[np.repeat(first[edge], sizes) + inside]
            edge = np.unique(reached[length[reached, goal] == UNREACHABLE])
    return length
