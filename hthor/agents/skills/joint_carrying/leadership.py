"""Which of the bodies that carry a thing together leads; all robots that see the same compute the same."""

import math
from collections.abc import Callable

from hthor.agents.skills.task_allocation import seat_order
from hthor.types import HUMAN, ThingState, Vec2, Vec3, is_person

_STALL_S = 4.0
"""Another robot leads when the thing has not moved for so long [s]."""
_ALONE_STALL_S = 10.0
"""The thing is stuck when it has not moved for so long with only one body that can lead [s]."""
_ROUNDS = 6
"""How often each of several robots leads until the thing counts as stuck."""
_MOVED_M = 0.1
"""The least distance [m] that counts as moved."""
_FRONT_M = 0.4
"""A person whose path to the destination is shorter by this [m] is in front of a robot."""


class Leadership:
    """The leader among the bearers of one thing.

    The one in front leads, whose path to the destination is the shortest: a body behind can only push, which does not
    take the thing round corners, and if it walks past the one in front, both end up on the same side of the thing. A
    robot goes before a person who is not clearly in front. Robots without a person take turns when the thing stands
    still.

    Args:
        place: position [m] of a seat's body. way: length [m] of the shortest path from one point to another.
    """

    def __init__(self, tick_s: float, place: Callable[[str], Vec2], way: Callable[[Vec2, Vec2], float]) -> None:
        self._tick_s, self._place, self._way = tick_s, place, way
        self._holders: list[str] = []
        self._leaders: list[str] = []
        self._turn, self._since, self._where = 0, 0, (math.inf, math.inf)

    def leader(self, tick: int, state: ThingState, destination: Vec3) -> str:
        """The seat that leads now; call it at every observation."""
        if not state.bearers:
            return HUMAN
        spot = state.position[:2]
        if sorted(state.bearers) != self._holders:
            self._holders, self._leaders = sorted(state.bearers), self._in_front(state, destination)
            self._turn, self._since, self._where = 0, tick, spot
        elif math.dist(spot, self._where) > _MOVED_M:
            self._since, self._where, self._turn = tick, spot, self._turn % len(self._leaders)
        elif tick - self._since >= round(self._patience() / self._tick_s):
            self._turn, self._since = self._turn + 1, tick
        return self._leaders[self._turn % len(self._leaders)]

    def standstill(self, tick: int) -> int:
        """For how many ticks the thing has not moved."""
        return tick - self._since

    def forget(self) -> None:
        """Forget everything, because the thing was put down."""
        self._holders, self._leaders = [], []

    @property
    def is_stuck(self) -> bool:
        """Whether all who can lead have done so in vain: it is better to put the thing down and take it again."""
        return bool(self._leaders) and self._turn >= max(len(self._leaders), _ROUNDS * (len(self._leaders) - 1))

    def _patience(self) -> float:
        """How long the thing may stand still until the next turn [s]."""
        return _STALL_S if len(self._leaders) > 1 else _ALONE_STALL_S

    def _in_front(self, state: ThingState, destination: Vec3) -> list[str]:
        """The bearer in front; if all are robots, all of them in order."""

        def behind(seat: str) -> tuple[float, tuple[bool, int, str]]:
            way = self._way(self._place(seat), destination[:2])
            return round(way + (_FRONT_M if is_person(seat) else 0.0), 2), seat_order(seat)

        order = sorted(state.bearers, key=behind)
        return order[:1] if any(is_person(seat) for seat in order) else order
