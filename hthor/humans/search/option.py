"""One thing that a participant could do next while searching."""

from msgspec import Struct

from hthor.humans.memory.spatial_memory import KnownDoorway, KnownPlace
from hthor.types import Vec2


class Option(Struct, frozen=True, kw_only=True):
    """Search ``place``, or go through ``doorway``; ``value`` is what it promises for its time.

    ``spot`` [m] is where to go, ``metres`` the way there, ``seconds`` what all takes, ``exposure`` how well the place
    was searched already.
    """

    name: str
    value: float
    spot: Vec2
    place: KnownPlace | None = None
    doorway: KnownDoorway | None = None
    metres: float = 0.0
    seconds: float = 0.0
    exposure: float = 0.0

    @property
    def is_closed(self) -> bool:
        """Whether it is a place that must be opened first."""
        return self.place is not None and self.place.state == "closed"
