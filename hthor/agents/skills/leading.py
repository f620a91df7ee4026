"""Which of the bodies that carry a thing together leads; all robots that see the same compute the same."""

import math
from collections.abc import Callable

from hthor.agents.skills.task_allocation import seat_order
from hthor.types import HUMAN, ThingState, Vec2, Vec3, is_person

_STALL_S = 4.0
"""Another robot leads when the thing has not moved for so long [s]."""
_MOVED_M = 0.1
"""The least distance [m] that counts as moved."""


class Leadership:
    """The leader among the bearers of one thing.

    A robot leads people. Of several robots it is the one in front, whose path to the destination is the shortest: a
    body behind can only push, which does not take the thing round corners. When the thing is stuck, they take turns.

    Args:
        place: position [m] of a seat's body. way: length [m] of the shortest path from one point to another.
    """

    def __init__(self, tick_s: float, place: Callable[[str], Vec2], way: Callable[[Vec2, Vec2], float]) -> None:
        self._stall = round(_STALL_S / tick_s)
        self._place, self._way = place, way
        self._robots: list[str] = []
        self._turn, self._since, self._where = 0, 0, (math.inf, math.inf)

    def leader(self, tick: int, state: ThingState, destination: Vec3) -> str:
        """The seat that leads now; call it at every observation."""
        robots = [seat for seat in state.bearers if not is_person(seat)]
        if len(robots) < 2:
            return next(iter(robots), min(state.bearers, key=seat_order, default=HUMAN))
        spot = state.position[:2]
        if sorted(robots) != sorted(self._robots):
            ways = {seat: round(self._way(self._place(seat), destination[:2]), 2) for seat in robots}
            self._robots = sorted(robots, key=lambda seat: (ways[seat], seat_order(seat)))
            self._turn, self._since, self._where = 0, tick, spot
        elif math.dist(spot, self._where) > _MOVED_M:
            self._since, self._where = tick, spot
        elif tick - self._since >= self._stall:
            self._turn, self._since = self._turn + 1, tick
        return self._robots[self._turn % len(self._robots)]
