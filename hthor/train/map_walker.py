"""Robots with a map and an ideal detector on pose grids: the controls ``frontier`` and ``nearest``.

A scan shows them, 5 m far, the places that they can stand at, and where these border on places not seen yet. They say
"here it is" as soon as the detector reports the goal.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from hthor import rules
from hthor.train.grid_worlds import DONE, GridWorlds
from hthor.train.pose_grid import HEADINGS, STEP_M, TILTS_RAD, Ints

SCAN_M = 5.0
"""[m] Range of the scan."""
VIEW_RAD = 2.0
"""[rad] Horizontal field of view of the robot scout."""
KEEP = 4
"""Hysteresis of ``nearest``: another place must be nearer than the present one by so many actions. It chooses again
after so many, too."""
LOOK_ROUND = 3
"""Turns at the beginning, in which the whole surroundings come into view."""
_LEFT = 1
_AT_ONCE = 256
Bools = NDArray[np.bool_]
Kind = Literal["frontier", "nearest"]


class Terrain:
    """What there is to be seen in a zone of N places. Poses are places with 8 headings, without tilts.

    Attributes:
        ahead: (N, 8) see `PoseGrid`. successors: (N * 8, 3) poses that ahead, left and right lead to.
        seen: (N * 8, N) the places that a scan shows from a pose. near: those within the detector's range.
    """

    def __init__(self, places: NDArray[np.float64], ahead: Ints) -> None:
        self.ahead = ahead
        place, heading = (part.ravel() for part in np.indices(ahead.shape))
        turned = [place * HEADINGS + (heading + by) % HEADINGS for by in (1, -1)]
        self.successors = np.stack([ahead[place, heading] * HEADINGS + heading, *turned], axis=1)
        offset = places[None, :] - places[:, None]
        apart = np.hypot(offset[..., 0], offset[..., 1])
        facing = np.arange(HEADINGS) * (2.0 * math.pi / HEADINGS)
        angle = np.arctan2(offset[..., 1], offset[..., 0])[:, None] - facing[:, None]
        in_view = (np.abs(np.remainder(angle + math.pi, 2.0 * math.pi) - math.pi) <= VIEW_RAD / 2.0) | (
            apart < STEP_M / 2.0
        )[:, None]
        clear = _clear_lines(places, apart <= SCAN_M)
        self.seen = (in_view & clear[:, None]).reshape(-1, len(places))
        self.near = self.seen & np.repeat(apart <= rules.DETECTOR_RANGE_M, HEADINGS, axis=0)


def _clear_lines(places: NDArray[np.float64], wanted: Bools) -> Bools:
    """(N, N) whether the straight line between two places leads over places only."""
    steps = np.rint((places - places.min(axis=0)) / STEP_M).astype(np.int64)
    there = np.zeros(steps.max(axis=0) + 1, np.bool_)
    there[steps[:, 0], steps[:, 1]] = True
    a, b = np.nonzero(wanted)
    clear = np.ones(len(a), np.bool_)
    for share in np.linspace(0.0, 1.0, 2 * round(SCAN_M / STEP_M) + 1)[1:-1]:
        at = np.rint(steps[a] + (steps[b] - steps[a]) * share).astype(np.int64)
        clear &= there[at[:, 0], at[:, 1]]
    found = np.zeros_like(wanted)
    found[a, b] = clear
    return found


class Explorer:
    """Explores a zone in one episode.

    The ``frontier`` goes to the nearest place that borders on one not seen yet, and if there is none, to the nearest
    from which it sees a place close by that it has not looked at from close by. For the ``nearest`` both are the same,
    and it keeps to a place unless another is much nearer.
    """

    def __init__(self, terrain: Terrain, kind: Kind) -> None:
        self._terrain, self._kind = terrain, kind
        count = len(terrain.ahead)
        self._known, self._looked = np.zeros(count, np.bool_), np.zeros(count, np.bool_)
        self._turns, self._since = LOOK_ROUND, 0
        self._path: list[int] = []  # poses to go to, the next one last

    def act(self, pose: int) -> int:
        """The next action: 0 for ahead, 1 for left, 2 for right."""
        self._known |= self._terrain.seen[pose]
        self._looked |= self._terrain.near[pose]
        if self._turns:
            self._turns -= 1
            return _LEFT
        self._since += 1
        impatient = self._kind == "nearest" and self._since >= KEEP
        if self._path and pose == self._path[-1]:
            self._path.pop()
        on_the_way = self._path and self._path[-1] in self._terrain.successors[pose]
        if not on_the_way or impatient or not self._worth(np.array(self._path[:1]))[0]:
            self._choose(pose)
        if not self._path:
            return _LEFT
        return int(np.flatnonzero(self._terrain.successors[pose] == self._path[-1])[0])

    def _choose(self, pose: int) -> None:
        """Plan a path to the nearest place worth going to."""
        order, before = self._reached(pose)
        last, self._since = self._path[:1], 0
        self._path = next((_path(int(one), before) for one in self._in_order(order)), [])
        if not self._path:
            self._looked[:] = False  # there is nothing left: look at everything again
        elif self._kind == "nearest" and last and self._worth(np.array(last))[0]:
            kept = _path(last[0], before)
            if 0 < len(kept) <= len(self._path) + KEEP:
                self._path = kept

    def _reached(self, pose: int) -> tuple[Ints, Ints]:
        """The poses that known ways lead to, nearest first, and (P,) the pose before each on a shortest path."""
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import breadth_first_order

        successors = self._terrain.successors
        walkable = np.repeat(self._known, HEADINGS)
        ways = walkable[:, None] & walkable[successors]
        first = np.concatenate(([0], np.cumsum(np.count_nonzero(ways, axis=1))))
        graph = csr_matrix((np.ones(first[-1], np.int8), successors[ways], first), shape=(len(walkable),) * 2)
        order, before = breadth_first_order(graph, pose)
        return order[1:], before

    def _in_order(self, order: Ints) -> Iterator[np.integer]:
        """The poses worth going to."""
        for begin in range(0, len(order), _AT_ONCE):
            some = order[begin : begin + _AT_ONCE]
            yield from some[self._worth(some)]

    def _worth(self, poses: Ints) -> Bools:
        """Whether there is something new to be seen from poses, as far as the map tells."""
        unknown = ~self._known[self._terrain.ahead]  # by the heading in which each neighbour lies
        edge = (unknown | np.roll(unknown, 1, axis=1) | np.roll(unknown, -1, axis=1)).ravel()
        if self._kind == "frontier" and (edge & np.repeat(self._known, HEADINGS)).any():
            return edge[poses]
        fresh = (self._terrain.near[poses] & (self._known & ~self._looked)).any(axis=1)
        return edge[poses] | np.asarray(fresh, np.bool_)


def _path(end: int, before: Ints) -> list[int]:
    """The poses on the way to ``end``, from there back to the one after the first; none if it is not reached."""
    path = []
    while before[end] >= 0:
        path.append(end)
        end = int(before[end])
    return path


class MapWalker:
    """Lets an explorer walk through each episode of a batch, as `hthor.train.walkers.Walker`.

    Args:
        goal: (B,) what ends each episode when it is in view; None if somebody else says "here it is".
    """

    def __init__(self, worlds: GridWorlds, goal: Tensor | None, kind: Kind) -> None:
        self._worlds, self._goal, self._kind = worlds, goal, kind
        self._explorers: list[Explorer] = []
        self._first: list[int] = []

    def act(self, pose: Tensor, alive: Tensor) -> Tensor:
        """The next actions, see `hthor.train.walkers.Walker.act`."""
        if not self._explorers:
            self._begin(pose)
        action = torch.zeros_like(pose)
        if self._goal is not None:
            action[self._worlds.found(pose, self._goal)] = DONE
        for number in torch.nonzero((alive > 0) & (action != DONE)).squeeze(1).tolist():
            here = (int(pose[number]) - self._first[number]) // len(TILTS_RAD)
            action[number] = self._explorers[number].act(here)
        return action

    def _begin(self, pose: Tensor) -> None:
        zone = torch.bucketize(pose, self._worlds.first[1:], right=True).tolist()
        self._first = self._worlds.first[zone].tolist()
        terrains = {one: Terrain(*self._worlds.lattices[one]) for one in sorted(set(zone))}
        self._explorers = [Explorer(terrains[one], self._kind) for one in zone]
