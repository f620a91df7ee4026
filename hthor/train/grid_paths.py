"""Shortest paths over the poses of a grid, in actions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hthor.agents.skills.semantic_cells import GOALS

UNREACHABLE = 10_000
"""A number of actions for "never"."""
_Ints = NDArray[np.integer]


def path_lengths(successors: _Ints, visible: NDArray[np.uint16]) -> NDArray[np.int16]:
    """(P, goals) least number of actions from each pose to one where the goal is in view, `UNREACHABLE` for never.

    Args:
        successors: (P, actions) the poses that actions lead to. visible: (P,) bit g is set where goal g is in view.
    """
    order = np.argsort(successors.ravel(), kind="stable")
    before = order // successors.shape[1]  # the poses that lead to pose 0, then those to pose 1, and so on
    first = np.searchsorted(successors.ravel()[order], np.arange(len(successors) + 1))
    return np.stack(
        [_lengths(before, first, np.flatnonzero(visible >> goal & 1)) for goal in range(len(GOALS))], axis=1
    )


def _lengths(before: _Ints, first: _Ints, targets: _Ints) -> NDArray[np.int16]:
    """(P,) least number of actions from each pose to one of the targets."""
    length = np.full(len(first) - 1, UNREACHABLE, np.int16)
    edge, step = targets, 0
    while len(edge):
        length[edge] = step
        step += 1
        sizes = first[edge + 1] - first[edge]
        inside = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
        reached = before[np.repeat(first[edge], sizes) + inside]
        edge = np.unique(reached[length[reached] == UNREACHABLE])
    return length
