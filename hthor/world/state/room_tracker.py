"""Which room each body is in."""

import math
from collections.abc import Iterable

from hthor.geometry import plane
from hthor.types import HouseSpec, Pose

_ROUNDING_M = 1e-9
"""[m] Margin against rounding on the distance for which a body is surely still in its room."""


class RoomTracker:
    """The room of each seat: the last one while it is between rooms; before it is in any, the house's first."""

    def __init__(self, house: HouseSpec, seats: Iterable[str]) -> None:
        self._rooms, self._seats = house.rooms, tuple(seats)
        self.reset()

    def reset(self) -> None:
        """Begin an episode."""
        self._last = dict.fromkeys(self._seats, 0)
        self._surely_within = dict.fromkeys(self._seats, (0.0, 0.0, 0.0))

    def room(self, seat: str, pose: Pose) -> str:
        """Id of the room that the seat's body is in at ``pose``."""
        x, y, margin = self._surely_within[seat]
        if math.hypot(pose.x - x, pose.y - y) >= margin:
            self._look((pose.x, pose.y), seat)
        return self._rooms[self._last[seat]].id

    def _look(self, here: tuple[float, float], seat: str) -> None:
        """Find the room, and how far the body can go from here and surely still be in it."""
        margin = 0.0
        for number in (self._last[seat], *range(len(self._rooms))):
            polygon = self._rooms[number].polygon
            if plane.inside(here, polygon):
                self._last[seat], margin = number, plane.distance_to_edge(here, polygon) - _ROUNDING_M
                break
        self._surely_within[seat] = (*here, margin)
