"""Shortest paths over the poses of a grid, in actions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hthor.agents.skills.semantic_cells import GOALS

UNREACHABLE = 10_000
"""A number of actions for "never"."""
_Bools = NDArray[np.bool_]
_Ints = NDArray[np.integer]


class Paths:
    """Shortest paths over poses.

    Args:
        successors: (P, actions) the poses that actions lead to.
    """

    def __init__(self, successors: _Ints) -> None:
        self._count, actions = successors.shape
        order = np.argsort(successors.ravel(), kind="stable")
        self._before = order // actions  # the poses that lead to pose 0, then those to pose 1, and so on
        self._first = np.searchsorted(successors.ravel()[order], np.arange(self._count + 1))

    def lengths(self, targets: _Ints, allowed: _Bools | None = None) -> NDArray[np.int16]:
        """(P,) least number of actions from each pose to one of the targets, `UNREACHABLE` for never.

        Args:
            targets: poses. allowed: (P,) the poses that a path may lead over, all if None.
        """
        length = np.full(self._count, UNREACHABLE, np.int16)
        edge, step = targets, 0
        while len(edge):
            length[edge] = step
            step += 1
            sizes = self._first[edge + 1] - self._first[edge]
            inside = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
            reached = self._before[np.repeat(self._first[edge], sizes) + inside]
            fresh = length[reached] == UNREACHABLE
            edge = np.unique(reached[fresh if allowed is None else fresh & allowed[reached]])
        return length


def path_lengths(successors: _Ints, visible: NDArray[np.uint16]) -> NDArray[np.int16]:
    """(P, goals) least number of actions from each pose to one where the goal is in view, `UNREACHABLE` for never.

    Args:
        successors: (P, actions) the poses that actions lead to. visible: (P,) bit g is set where goal g is in view.
    """
    paths = Paths(successors)
    return np.stack([paths.lengths(np.flatnonzero(visible >> goal & 1)) for goal in range(len(GOALS))], axis=1)
