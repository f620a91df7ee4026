"""Ways that one goes after another by, as points: where to head for, how long they are."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

from hthor.types import Vec2
from hthor.world.carrying import trailer_kernel

MARGINS_M = (0.25, 0.15, 0.05)
"""How clear of corners one goes after another: as clear as one can."""
AHEAD_M = 0.25
"""A point that is nearer than this is hardly ahead."""
TAUT_MARGIN_M = 0.05
"""How clear of corners a way is pulled taut."""


def aim_index(way: Sequence[Vec2], rows: Any) -> int:
    """Which of the points of a way to go to straight from its first: the last that keeps clear of corners.

    As clear as it can, but a point that is hardly ahead leads nowhere.
    """
    for margin in MARGINS_M:
        for there in range(len(way) - 1, 0, -1):
            if there < len(way) - 1 and math.dist(way[0], way[there]) < AHEAD_M:
                break
            if not trailer_kernel.is_line_blocked(*way[0], *way[there], rows, margin):
                return there
    return next((k for k in range(1, len(way)) if math.dist(way[0], way[k]) >= AHEAD_M), len(way) - 1)


def taut_length(way: Sequence[Vec2], rows: Any) -> float:
    """Length [m] of the way once its bends are pulled out of it, as far as walls and furniture let."""
    total, here = 0.0, 0
    while here < len(way) - 1:
        there = len(way) - 1
        while there > here + 1 and trailer_kernel.is_line_blocked(*way[here], *way[there], rows, TAUT_MARGIN_M):
            there -= 1
        total, here = total + math.dist(way[here], way[there]), there
    return total


def path_length(way: Sequence[Vec2]) -> float:
    """Length [m] of the way as it is."""
    return math.fsum(math.dist(a, b) for a, b in itertools.pairwise(way))
