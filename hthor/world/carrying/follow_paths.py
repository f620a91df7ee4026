"""Paths that a bearer or a carried thing follows, as points: where to head for, how long they are."""

import itertools
import math
from collections.abc import Sequence

from hthor.geometry.ray_casting import Floats
from hthor.types import Vec2
from hthor.world.carrying import trailer_kernel

MARGINS_M = (0.25, 0.15, 0.05)
"""[m] clear of corners that a follower tries to stay, the largest first; our choice."""
AHEAD_M = 0.25
"""[m] A point nearer than this gives no useful direction."""
TAUT_MARGIN_M = 0.05
"""[m] clear of corners at which a path is pulled taut."""


def aim_index(path: Sequence[Vec2], obstacles: Floats) -> int:
    """Index of the last point of a path that can be reached in a straight line from its first, clear of corners.

    The clearance is the largest of `MARGINS_M` with which there is such a point at least `AHEAD_M` away.
    """
    for margin in MARGINS_M:
        for there in range(len(path) - 1, 0, -1):
            if there < len(path) - 1 and math.dist(path[0], path[there]) < AHEAD_M:
                break
            if not trailer_kernel.is_line_blocked(*path[0], *path[there], obstacles, margin):
                return there
    return next((k for k in range(1, len(path)) if math.dist(path[0], path[k]) >= AHEAD_M), len(path) - 1)


def taut_length(path: Sequence[Vec2], obstacles: Floats) -> float:
    """Length [m] of the path when it is pulled taut around walls and furniture."""
    total, here = 0.0, 0
    while here < len(path) - 1:
        there = len(path) - 1
        while there > here + 1 and trailer_kernel.is_line_blocked(*path[here], *path[there], obstacles, TAUT_MARGIN_M):
            there -= 1
        total, here = total + math.dist(path[here], path[there]), there
    return total


def path_length(path: Sequence[Vec2]) -> float:
    """Length [m] of the path."""
    return math.fsum(math.dist(a, b) for a, b in itertools.pairwise(path))
