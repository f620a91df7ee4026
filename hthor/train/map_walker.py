"""Robots with a map and an ideal detector on pose grids: the controls ``frontier`` and ``nearest``.

A scan shows them, 5 m far, the places that they can stand at, and where these border on places not seen yet. They say
"here it is" as soon as the detector reports the goal.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from hthor import rules
from hthor.train.grid_paths import UNREACHABLE, Paths
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
Bools = NDArray[np.bool_]
Kind = Literal["frontier", "nearest"]


class Terrain:
    """What there is to be seen in a zone of N places. Poses are places with 8 headings, without tilts.

    Attributes:
        ahead: (N, 8) see `PoseGrid`. successors: (N * 8, 3) poses that ahead, left and right lead to.
        paths: along them.
        seen: (N * 8, N) the places that a scan shows from a pose. near: those within the detector's range.
    """

    def __init__(self, places: NDArray[np.float64], ahead: Ints) -> None:
        self.ahead = ahead
        place, heading = (part.ravel() for part in np.indices(ahead.shape))
        turned = [place * HEADINGS + (heading + by) % HEADINGS for by in (1, -1)]
        self.successors = np.stack([ahead[place, heading] * HEADINGS + heading, *turned], axis=1)
        self.paths = Paths(self.successors)
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
        self._turns, self._goal, self._since = LOOK_ROUND, -1, 0

    def act(self, pose: int) -> int:
        """The next action: 0 for ahead, 1 for left, 2 for right."""
        self._known |= self._terrain.seen[pose]
        self._looked |= self._terrain.near[pose]
        if self._turns:
            self._turns -= 1
            return _LEFT
        self._since += 1
        impatient = self._kind == "nearest" and self._since >= KEEP
        if self._goal < 0 or impatient or not self._worth(slice(self._goal, self._goal + 1))[0]:
            self._choose(pose)
        if self._goal < 0 or pose == self._goal:
            return _LEFT
        return int(self._length[self._terrain.successors[pose]].argmin())

    def _choose(self, pose: int) -> None:
        walkable = np.repeat(self._known, HEADINGS)
        worth = self._worth(slice(None)) & walkable
        length = self._terrain.paths.lengths(np.flatnonzero(worth), walkable)
        last, self._goal, self._since = self._goal, -1, 0
        if length[pose] == UNREACHABLE:
            self._looked[:] = False  # there is nothing left: look at everything again
            return
        self._goal = self._end(pose, length)
        if self._kind == "nearest" and last >= 0 and worth[last]:
            kept = self._terrain.paths.lengths(np.array([last]), walkable)
            self._goal = last if kept[pose] <= length[pose] + KEEP else self._goal
        self._length = self._terrain.paths.lengths(np.array([self._goal]), walkable)

    def _worth(self, poses: slice) -> Bools:
        """Whether there is something new to be seen from poses, as far as the map tells."""
        unknown = ~self._known[self._terrain.ahead]  # by the heading in which each neighbour lies
        edge = (unknown | np.roll(unknown, 1, axis=1) | np.roll(unknown, -1, axis=1)).ravel()
        if self._kind == "frontier" and (edge & np.repeat(self._known, HEADINGS)).any():
            return edge[poses]
        fresh = (self._terrain.near[poses] & (self._known & ~self._looked)).any(axis=1)
        return edge[poses] | np.asarray(fresh, np.bool_)

    def _end(self, pose: int, length: NDArray[np.int16]) -> int:
        """The pose to which a shortest path leads."""
        while length[pose] > 0:
            following = self._terrain.successors[pose]
            pose = int(following[length[following].argmin()])
        return pose


class MapWalker:
    """Lets an explorer walk through each episode of a batch, as `hthor.train.evaluation.Walker`."""

    def __init__(self, worlds: GridWorlds, goal: Tensor, kind: Kind) -> None:
        self._worlds, self._goal, self._kind = worlds, goal, kind
        self._explorers: list[Explorer] = []
        self._first: list[int] = []

    def act(self, pose: Tensor, alive: Tensor) -> Tensor:
        """The next actions, see `hthor.train.evaluation.Walker.act`."""
        if not self._explorers:
            self._begin(pose)
        action = torch.where(self._worlds.found(pose, self._goal), DONE, 0)
        for number in torch.nonzero((alive > 0) & (action != DONE)).squeeze(1).tolist():
            here = (int(pose[number]) - self._first[number]) // len(TILTS_RAD)
            action[number] = self._explorers[number].act(here)
        return action

    def _begin(self, pose: Tensor) -> None:
        zone = torch.bucketize(pose, self._worlds.first[1:], right=True).tolist()
        self._first = self._worlds.first[zone].tolist()
        terrains = {one: Terrain(*self._worlds.lattices[one]) for one in sorted(set(zone))}
        self._explorers = [Explorer(terrains[one], self._kind) for one in zone]
