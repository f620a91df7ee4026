"""Batches of episodes of object navigation on pose grids, all tensors on one device. Needs the extra ``torch``.

An episode begins at a pose of a zone, a whole house or one room of it, and looks for a kind of thing. It ends when the
robot says "here it is"; that is right if its detector reports a thing of that kind from where it stands.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, Literal, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from hthor.agents.skills.detector_noise import DetectorNoise
from hthor.agents.skills.semantic_cells import CLASSES, GOALS, LEVELS
from hthor.train.grid_paths import UNREACHABLE, path_lengths
from hthor.train.pose_grid import HEADINGS, TILTS_RAD, Ints, PoseGrid, next_poses

Zones = Literal["rooms", "houses"]
BOTH: tuple[Zones, ...] = ("rooms", "houses")
DONE = 5
"""The action "here it is"; the five before it are those of `hthor.train.pose_grid.next_poses`."""
TURNS = HEADINGS * len(TILTS_RAD)
LEAST_PLACES = 12
"""A room with fewer places is no zone of its own."""
CLOSE = 8
"""A number of actions to a goal that is near."""


class Episodes(NamedTuple):
    """A batch of B episodes.

    Attributes:
        pose: (B,) int64, where each begins. goal: (B,) int64, an index of `GOALS`. least: (B,) int64, the least number
            of actions to succeed, the last "here it is" included.
    """

    pose: Tensor
    goal: Tensor
    least: Tensor


class GridWorlds:
    """The zones of many pose grids as one world of poses.

    Args:
        grids: the houses, each with one arrangement. zones: whether episodes are in whole houses or in single rooms.
        device: where the tensors are, such as "cpu".

    Attributes:
        next: (P, 5) int64. length: (P, goals) int16, least number of actions to a pose that sees the goal.
        house: (zones,) the number of each zone's grid. first: (zones + 1,) where each zone's poses begin.
        lattices: of each zone its places (N, 2) [m] and the places ahead (N, 8), see `PoseGrid`.
    """

    def __init__(self, grids: Iterable[PoseGrid], zones: Zones, device: str = "cpu") -> None:
        columns: list[tuple[NDArray[Any], ...]] = []
        self.lattices: list[tuple[NDArray[np.float64], Ints]] = []
        house, first = [], [0]
        for number, grid in enumerate(grids):
            for zone in _cut(grid, zones):
                visible, following = zone.visible, next_poses(zone.ahead)
                length = path_lengths(following, visible)
                if not (length < UNREACHABLE).any():
                    continue
                seen = (zone.shown, zone.behind, zone.depth) if zone.codes is None else (zone.codes,)
                columns.append((following + first[-1], length, *seen))
                self.lattices.append((zone.places, zone.ahead))
                house.append(number)
                first.append(first[-1] + len(visible))
        following, length, *views = (torch.from_numpy(np.concatenate(column)) for column in zip(*columns, strict=True))
        self.device = torch.device(device)
        self.next, self.length = following.to(self.device).long(), length.to(self.device)
        self._views = [part.to(self.device) for part in views]
        self.house, self.first = torch.tensor(house), torch.tensor(first, device=self.device)
        self.noise = DetectorNoise(CLASSES, self.device)

    def draw(self, batch: int, generator: torch.Generator, close: float = 0.0, house: int | None = None) -> Episodes:
        """Episodes whose zone, start and goal are drawn evenly among those where the goal is not in view.

        Args:
            close: share of the episodes that begin at most `CLOSE` actions from where the goal is in view.
            house: the number of the grid whose zones are drawn from; all if None.
        """
        among = torch.arange(len(self.house)) if house is None else torch.nonzero(self.house == house).squeeze(1)
        among = among.to(self.device)
        chance = torch.rand(batch, generator=generator, device=self.device)
        longest = torch.where(chance < close, CLOSE, UNREACHABLE - 1)
        pose, goal = (torch.empty(batch, dtype=torch.long, device=self.device) for _ in range(2))
        left = torch.arange(batch, device=self.device)
        while len(left):
            chance = torch.rand(3, len(left), generator=generator, device=self.device, dtype=torch.float64)
            zone = among[(chance[0] * len(among)).long()]
            here, size = self.first[zone], self.first[zone + 1] - self.first[zone]
            start = here + (chance[1] * (size // len(TILTS_RAD))).long() * len(TILTS_RAD)  # with a level camera
            aim = (chance[2] * len(GOALS)).long()
            away = self.length[start, aim]
            good = (away > 0) & (away <= longest[left])
            pose[left[good]], goal[left[good]] = start[good], aim[good]
            left = left[~good]
        return Episodes(pose, goal, self.length[pose, goal].long() + 1)

    def look(self, pose: Tensor, generator: torch.Generator | None) -> tuple[Tensor, ...]:
        """What a network reads at poses, see `hthor.agents.skills.savn_network.Network.forward`: the classes (B, cells)
        and the ranges (B, cells), from 0 to 1, or the codes of the pictures if the grids have any.

        Args:
            generator: draws the detector's noise; None for a detector without any.
        """
        if len(self._views) == 1:
            return (self._views[0][pose],)
        shown, behind, depth = (part[pose] for part in self._views)
        shown, ranges = shown.long(), depth.float() / LEVELS
        if generator is not None:
            shown = self.noise(shown, behind.long(), ranges, generator)
        return shown, ranges

    def go(self, pose: Tensor, action: Tensor) -> Tensor:
        """(B,) where actions lead; `DONE` and what is blocked leave a robot where it is."""
        moved = self.next[pose, action.clamp(max=DONE - 1)]
        return torch.where(action == DONE, pose, moved)

    def found(self, pose: Tensor, goal: Tensor) -> Tensor:
        """(B,) bool, whether the goal is in view."""
        return self.length[pose, goal] == 0


def _cut(grid: PoseGrid, zones: Zones) -> Iterator[PoseGrid]:
    """The zones of a grid, as grids."""
    if zones == "houses":
        yield grid
        return
    for room in range(int(grid.rooms.max()) + 1):
        inside = np.flatnonzero(grid.rooms == room)
        if len(inside) >= LEAST_PLACES:
            yield _part(grid, inside)


def _part(grid: PoseGrid, places: NDArray[np.int64]) -> PoseGrid:
    """The grid of some places only; steps out of them are blocked."""
    index = np.full(len(grid.places), -1, np.int32)
    index[places] = np.arange(len(places))
    there = index[grid.ahead[places]]
    ahead = np.where(there < 0, np.arange(len(places), dtype=np.int32)[:, None], there)
    poses = (places[:, None] * TURNS + np.arange(TURNS)).ravel()
    return PoseGrid(
        places=grid.places[places],
        rooms=grid.rooms[places],
        ahead=ahead,
        shown=grid.shown[poses],
        behind=grid.behind[poses],
        depth=grid.depth[poses],
        visible=grid.visible[poses],
        codes=None if grid.codes is None else grid.codes[poses],
    )
