"""What a page draws: the file of the house, and where everything that moves is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hthor.live import house_file, wire

if TYPE_CHECKING:
    from hthor.world.sensing_simulation import SensingSimulation


class Scenery:
    """The scenery of one world.

    Attributes:
        file: the house. own: the numbers of each seat's body and head, which its own page does not draw.
    """

    def __init__(self, world: SensingSimulation) -> None:
        self._world = world
        self.file = house_file.house_file(world.scene, world.house)
        self.own = dict(world.scene.seats)
        self._last = np.zeros((0, 7), np.int16)

    def restart(self) -> None:
        """Count everything as moved."""
        self._last = np.zeros((0, 7), np.int16)

    def moved(self) -> dict[int, bytes]:
        """What has moved since the last call, by its number, as `wire.encode_frame` takes it."""
        poses = wire.round_poses(self._world.scene_poses())
        if len(self._last) != len(poses):
            changed = np.arange(len(poses))
        else:
            changed = np.flatnonzero((poses != self._last).any(axis=1))
        self._last = poses
        return {int(number): poses[number].tobytes() for number in changed}
