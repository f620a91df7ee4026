"""What a participant remembers of the house during one trial: furniture, doorways, rooms."""

import math
from functools import cache

from msgspec import Struct

from hthor import catalog
from hthor.geometry.plane import distance_to_rectangle, turn
from hthor.types import Detection, Vec2, Vec3

_BEYOND_M = 0.6
"""[m] How far behind a doorway people walk when they go through it. Our choice."""
_TOUCH_M = 0.1
"""[m] A point this close to furniture's outline counts as on it. Our choice."""


class KnownPlace(Struct, kw_only=True):
    """A piece of furniture as last seen, and how well it was searched.

    ``exposure`` is the detection rate added up there, as of tick ``since``; it fades. ``at`` is the last tick at which
    it was in view, ``views`` how often it came into view. ``recalled`` says whether its position is remembered,
    ``lost`` how often it was forgotten.
    """

    id: str
    kind: str
    centre: Vec3
    size: Vec3
    yaw: float
    state: str = ""
    exposure: float = 0.0
    since: int = 0
    at: int = -1
    views: int = 0
    recalled: bool = True
    lost: int = 0

    def covers(self, point: Vec3) -> bool:
        """Whether a point [m] lies on or in it, seen from above."""
        return self.distance((point[0], point[1])) <= _TOUCH_M

    def distance(self, point: Vec2) -> float:
        """Distance from a point to the outline [m], zero inside."""
        return distance_to_rectangle(point, (self.centre[0], self.centre[1]), (self.size[0], self.size[1]), self.yaw)


class KnownDoorway(Struct, kw_only=True):
    """A doorway as seen: ``across`` is the direction through it, ``width`` [m] its opening.

    ``sides`` are the rooms from which it was seen directly; a doorway with two sides leads nowhere new. ``beyond`` [m]
    is a spot just behind it as seen from the first of these rooms.
    """

    id: str
    centre: Vec2
    across: Vec2
    width: float
    sides: list[str] = []
    beyond: Vec2 = (0.0, 0.0)
    passed: bool = False
    failures: int = 0

    @property
    def explored(self) -> bool:
        """Whether both its sides are known."""
        return self.passed or len(self.sides) > 1

    def is_crossed(self, a: Vec2, b: Vec2) -> bool:
        """Whether the segment from ``a`` to ``b`` [m] goes through the opening."""
        ax, ay = a[0] - self.centre[0], a[1] - self.centre[1]
        bx, by = b[0] - self.centre[0], b[1] - self.centre[1]
        deep_a, deep_b = ax * self.across[0] + ay * self.across[1], bx * self.across[0] + by * self.across[1]
        if (deep_a > 0.0) == (deep_b > 0.0):
            return False
        share = deep_a / (deep_a - deep_b)
        x, y = ax + share * (bx - ax), ay + share * (by - ay)
        return abs(x * self.across[1] - y * self.across[0]) <= self.width / 2.0


class SpatialMemory:
    """The house as far as it was seen in this trial. ``tau`` [ticks] is the time constant of forgetting searches.

    ``entered`` is where each room was entered first [m], ``heading`` the id of the furniture that the participant is
    bringing something to, empty at first.
    """

    def __init__(self, tau: float) -> None:
        self.tau = tau
        self.places: dict[str, KnownPlace] = {}
        self.doorways: dict[str, KnownDoorway] = {}
        self.entered: dict[str, Vec2] = {}
        self.heading = ""
        self._here: Vec2 | None = None
        self._at: dict[Vec3, tuple[int, KnownPlace | None]] = {}

    def begin_again(self, forget_searches: bool) -> None:
        """Begin another phase of a task, perhaps at another place.

        The house is still known. But if things may have been moved, it is not known any more where they are not, and
        every room is worth a look round again.
        """
        self._here = None
        if forget_searches:
            self.entered.clear()
        for place in self.places.values() if forget_searches else ():
            place.exposure = 0.0

    def visit(self, here: Vec2, room: str) -> bool:
        """Note the position ``here`` [m] in ``room``; returns whether the room is entered for the first time."""
        if self._here is not None and self._here != here:
            for doorway in self.doorways.values():
                if not doorway.passed and doorway.is_crossed(self._here, here):
                    doorway.passed = True
        self._here = here
        if room in self.entered:
            return False
        self.entered[room] = here
        return True

    def keep_place(self, seen: Detection) -> KnownPlace:
        """Remember furniture, or update it."""
        place = self.places.get(seen.id)
        if place is None:
            place = KnownPlace(id=seen.id, kind=seen.kind, centre=seen.position, size=seen.size, yaw=seen.yaw)
            self.places[seen.id] = place
        place.recalled = True
        place.state = seen.state if seen.state and _hides(seen.kind) else ""  # a drawer is not worth opening
        return place

    def lose(self, place: KnownPlace) -> None:
        """Forget where a place is; how well it was searched is kept for when it is seen again."""
        place.recalled, place.lost = False, place.lost + 1

    def keep_doorway(self, seen: Detection, here: Vec2, room: str) -> None:
        """Remember a doorway, and from which room it was seen directly."""
        doorway = self.doorways.get(seen.id)
        if doorway is None:
            doorway = _doorway(seen)
            self.doorways[seen.id] = doorway
        if doorway.explored or room in doorway.sides or self._is_behind_another(doorway, here):
            return
        if not doorway.sides:
            doorway.beyond = _beyond(doorway, here)
        doorway.sides.append(room)

    def unexplored_doorways(self) -> list[KnownDoorway]:
        """Doorways that may lead to a room not seen yet."""
        return [door for door in self.doorways.values() if door.sides and not door.explored]

    def _is_behind_another(self, doorway: KnownDoorway, here: Vec2) -> bool:
        others = (other for other in self.doorways.values() if other.id != doorway.id)
        return any(other.is_crossed(here, doorway.centre) for other in others)

    def exposure(self, place: KnownPlace, tick: int) -> float:
        """How well the place was searched, faded until ``tick``."""
        return place.exposure * math.exp((place.since - tick) / self.tau)

    def expose(self, place: KnownPlace, amount: float, tick: int) -> None:
        """Add to the exposure of a place that is looked at."""
        place.exposure = place.exposure * math.exp((place.since - tick) / self.tau) + amount
        place.since = tick

    def at(self, point: Vec3) -> KnownPlace | None:
        """The place that a point [m] lies on or in, the nearest of several."""
        count, place = self._at.get(point, (0, None))
        if count != len(self.places):  # places are never removed, and furniture does not move
            near = [place for place in self.places.values() if place.covers(point)]
            place = min(near, key=lambda place: (place.distance((point[0], point[1])), place.id), default=None)
            self._at[point] = len(self.places), place
        return place


@cache
def _hides(kind: str) -> bool:
    """Whether furniture of this kind hides something while it is closed."""
    return catalog.kind(kind).hides


def _doorway(seen: Detection) -> KnownDoorway:
    """A doorway from its detection; the opening runs along the longer side."""
    wide = seen.size[0] >= seen.size[1]
    across = turn((0.0, 1.0) if wide else (1.0, 0.0), seen.yaw)
    centre = (seen.position[0], seen.position[1])
    return KnownDoorway(id=seen.id, centre=centre, across=across, width=max(seen.size[0], seen.size[1]))


def _beyond(doorway: KnownDoorway, here: Vec2) -> Vec2:
    """The spot behind the doorway as seen from ``here``."""
    (cx, cy), (nx, ny) = doorway.centre, doorway.across
    side = (here[0] - cx) * nx + (here[1] - cy) * ny
    sign = -1.0 if side > 0.0 else 1.0
    return (cx + sign * _BEYOND_M * nx, cy + sign * _BEYOND_M * ny)
