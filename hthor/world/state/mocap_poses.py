"""The poses of people and robots in the engine, where they are mocap bodies: puppets that a pose moves, not a force."""

import math
from collections.abc import Iterable
from typing import Any

from hthor.types import Pose
from hthor.world.model.composer_env import LazyComposerEnv
from hthor.world.state.body_state import BodyState


class MocapPoses:
    """Copies the poses of one world's bodies to the engine's ``mocap_pos`` and ``mocap_quat``.

    A body stands on the floor and is turned by its ``yaw``; a turned head and a tilted camera are not in the engine.
    Mocap bodies wake nothing and nothing collides with them, so the rest of the engine's state does not depend on them.
    """

    def __init__(self, env: LazyComposerEnv, seats: Iterable[BodyState]) -> None:
        self._seats = tuple(enumerate(seats))
        self._written: list[Pose | None] = [None] * len(self._seats)
        data = env.data  # views whose numbers are written one by one faster than those of arrays
        self._positions: list[Any] = [memoryview(data.mocap_pos[number]) for number, _ in self._seats]
        self._turns: list[Any] = [memoryview(data.mocap_quat[number]) for number, _ in self._seats]

    def write(self) -> None:
        """Write the poses of the bodies that have moved since the last call."""
        written = self._written
        for number, seat in self._seats:
            pose, before = seat.pose, written[number]
            if pose is before:
                continue
            written[number] = pose
            position = self._positions[number]
            position[0], position[1] = pose.x, pose.y
            if before is None or pose.yaw != before.yaw:
                turn, half = self._turns[number], pose.yaw / 2
                turn[0], turn[3] = math.cos(half), math.sin(half)

    def rewrite(self) -> None:
        """Write all poses, as the engine loses them when it is reset."""
        self._written = [None] * len(self._seats)
        for position, turn in zip(self._positions, self._turns, strict=True):
            position[2] = turn[1] = turn[2] = 0.0
        self.write()
