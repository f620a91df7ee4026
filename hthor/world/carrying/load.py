"""A thing held by its handles: the bearer at each end, its pose, and the mass that the bearers can lift."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from hthor import rules
from hthor.geometry.plane import turn
from hthor.types import Vec3
from hthor.world.model import geoms
from hthor.world.model.composer_env import QPose
from hthor.world.state.body_state import BodyState
from hthor.world.state.movable_object import MovableObject

LIFT_M = 0.30
"""[m] Height of the underside of a carried thing; our choice."""


class Load:
    """One thing with handles that at least one body holds.

    Attributes:
        ends: seat -> +1 or -1, the end that it holds, in the order in which the seats took hold.
        state: (3,) [m, rad] x, y and yaw. z: [m] height of its middle. half: (2,) [m] half its width and depth.
        up: whether it is off the floor.
    """

    def __init__(self, item: MovableObject, seats: Sequence[BodyState]) -> None:
        self.item, self.seats = item, tuple(seats)
        self._named = {seat.name: seat for seat in seats}
        self.ends: dict[str, int] = {}
        self.up, self._leader, self._tick = False, "", -1
        x, y, self.z = item.position
        self.state: Any = np.array((x, y, item.yaw))
        self.half: Any = np.array(item.size[:2]) / 2

    @property
    def bearers(self) -> tuple[BodyState, ...]:
        """The bodies that hold the thing, in the order in which they took hold."""
        return tuple(self._named[name] for name in self.ends)

    @property
    def lifted(self) -> float:
        """[kg] The mass that its bearers together can lift."""
        return math.fsum(rules.HANDLE_STRENGTH * seat.spec.strength for seat in self.bearers)

    @property
    def holders(self) -> str:
        """The seats that hold the thing, followed by the verb "lift", for messages."""
        return f"{' and '.join(self.ends)} {'lifts' if len(self.ends) == 1 else 'together lift'}"

    @property
    def pace(self) -> float:
        """[m/s] Speed at which it is carried."""
        return rules.HANDLE_PACE * min(seat.spec.speed for seat in self.bearers)

    def handle(self, end: int) -> Vec3:
        """Position of the handle at that end [m]."""
        x, y = turn((end * float(self.half[0]), 0.0), float(self.state[2]))
        return (float(self.state[0]) + x, float(self.state[1]) + y, self.z)

    def pose(self) -> QPose:
        """The thing's pose, for the engine."""
        return (float(self.state[0]), float(self.state[1]), self.z, *geoms.quaternion(float(self.state[2])))

    def follows(self, seat: BodyState, tick: int) -> bool:
        """Whether another bearer leads in this tick; if nobody does yet, ``seat`` does from now on."""
        if self._tick != tick:
            self._tick, self._leader = tick, seat.name
        return self._leader != seat.name
