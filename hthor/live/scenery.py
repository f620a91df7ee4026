"""What a page draws: the file of the house, and where everything that moves is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hthor.live import wire
from hthor.live.gltf import house_file

if TYPE_CHECKING:
    from hthor.world import World


class Scenery:
    """The scenery of one world.

    Attributes:
        world: the world. file: the house.
        own: the numbers of each seat's body and head, which its own page does not draw.
    """

    def __init__(self, world: World) -> None:
        self.world = world
        self.file = house_file.house_file(world.scene, world.house)
        self.own = dict(world.scene.seats)
        self._changes = PoseChanges()

    def restart(self) -> None:
        """Count everything as moved."""
        self._changes = PoseChanges()

    def moved(self) -> dict[int, bytes]:
        """What has moved since the last call, by its number, as `wire.encode_frame` takes it."""
        poses, changed = self._changes.take(self.world.scene_poses())
        return {number: poses[number].tobytes() for number in changed}


class PoseChanges:
    """What moves from one look at all poses to the next; at the first look everything has."""

    def __init__(self) -> None:
        self._last: NDArray[np.int16] = np.zeros((0, 7), np.int16)

    def take(self, poses: NDArray[np.float64]) -> tuple[NDArray[np.int16], list[int]]:
        """The poses (P, 7) as `wire.round_poses` rounds them, and the numbers of those that differ from the last."""
        before, self._last = self._last, wire.round_poses(poses)
        if len(before) != len(self._last):
            return self._last, list(range(len(self._last)))
        changed: list[int] = np.flatnonzero((self._last != before).any(axis=1)).tolist()
        return self._last, changed
