"""The state of each body in an episode: its pose, motion, held object and room."""

import math
from collections.abc import Collection, Iterable, Sequence
from typing import Protocol

from hthor.errors import UnknownName
from hthor.geometry import plane
from hthor.houses.space.free_space import FreeSpace
from hthor.types import BodySpec, Drive, HouseSpec, Outcome, Pose, Vec2, Vec3, is_person
from hthor.types.events import Event
from hthor.world.records import ActivityState, Driving
from hthor.world.state.movable_object import MovableObject

_ROUNDING_M = 1e-9
"""[m] Safety margin against rounding on the distance within which a body cannot have left its room."""


class Activity(Protocol):
    """A motion under way.

    Attributes:
        of_hands: whether it keeps the hands busy, so that a `Drive` does not replace it.
    """

    of_hands: bool

    def advance(self, tick: int) -> tuple[Outcome | None, tuple[Event, ...]]:
        """Carry the motion on by one tick; the outcome is None until the motion has ended."""

    def state(self) -> ActivityState:
        """All that it needs to go on later."""


class Driver(Protocol):
    """Keeps the set-point that a body drives by; `hthor.world.motion.driving.DriveMotion`."""

    def keep(self, drive: Drive) -> None:
        """Take over a set-point."""

    def step(self, tick: int, last: bool) -> tuple[Event, ...]:
        """Make one of the steps of a tick, ``last`` the last of them; its events."""

    def state(self) -> Driving:
        """All that it needs to go on later."""


class PushedThings(Protocol):
    """The loose things on the floor; `hthor.world.motion.loose_things.LooseThings`."""

    @property
    def low(self) -> Collection[int]:
        """Numbers of the objects that lie on the floor, or fall."""

    def make_way(self, seat: "BodyState", step: Vec2, seconds: float = ...) -> bool:
        """Push what is in the way of a step [m]; False if a body cannot make the step."""

    def wedged(self, item: MovableObject) -> str:
        """The seat of a body that an object, where it is now, is in and could not be pushed out of; empty for none."""


class BodyState:
    """One body in an episode.

    Attributes:
        name: its seat. spec: what it can do. space: its free floor now, without shut doorways.
        pose: where it is; replaced by a new record whenever the body moves, never changed in place.
        activity: the motion under way, None while idle. outcome: how the last motion ended.
        drive: the set-point that it drives by, None if it does not drive. has_neck: whether its head turns by itself.
        holding: id of the object in hand or held by a handle, empty for none.
        loose: what it pushes, or is stopped by, on the floor; None for a body that never moves.
    """

    __slots__ = ("activity", "drive", "has_neck", "holding", "loose", "name", "outcome", "pose", "space", "spec")

    def __init__(self, name: str, spec: BodySpec, space: FreeSpace) -> None:
        self.name, self.spec, self.space = name, spec, space
        self.has_neck = is_person(name)
        self.loose: PushedThings | None = None
        self.clear(Pose(x=0.0, y=0.0))

    def clear(self, pose: Pose) -> None:
        """Begin an episode at ``pose``: idle, with empty hands."""
        self.pose = pose
        self.activity: Activity | None = None
        self.drive: Driver | None = None
        self.outcome: Outcome | None = None
        self.holding = ""


class BodyStates(dict[str, BodyState]):
    """The bodies of one world by seat; an unknown seat raises UnknownName, which lists the seats."""

    def __missing__(self, name: str) -> BodyState:
        raise UnknownName("seat", name, self)


class RoomTracker:
    """The room of each seat: between rooms, the one it was in last; before it was in any, the house's first room."""

    def __init__(self, house: HouseSpec, seats: Iterable[str]) -> None:
        self._rooms, self._seats = house.rooms, tuple(seats)
        self._lines = [_edge_lines(room.polygon) for room in house.rooms]
        self.reset()

    def reset(self) -> None:
        """Begin an episode."""
        self._last = dict.fromkeys(self._seats, 0)
        self._surely_within = dict.fromkeys(self._seats, (0.0, 0.0, 0.0))

    def record(self, seat: str) -> tuple[int, Vec3]:
        """The number of the seat's room, and the disc (x, y, radius) [m] in which it surely stays in that room."""
        return self._last[seat], self._surely_within[seat]

    def restore(self, seat: str, room: int, within: Vec3) -> None:
        """Go back to what `record` returned."""
        self._last[seat], self._surely_within[seat] = room, within

    def room(self, seat: str, pose: Pose) -> str:
        """Id of the room that the seat's body is in at ``pose``."""
        x, y, margin = self._surely_within[seat]
        if math.hypot(pose.x - x, pose.y - y) >= margin:
            self._look((pose.x, pose.y), seat)
        return self._rooms[self._last[seat]].id

    def _look(self, here: tuple[float, float], seat: str) -> None:
        """Find the room, and how far [m] the body can surely go from here without leaving it."""
        (x, y), margin = here, 0.0
        for number in (self._last[seat], *range(len(self._rooms))):
            if plane.inside(here, self._rooms[number].polygon):
                gaps = [abs(nx * x + ny * y - offset) for nx, ny, offset in self._lines[number]]
                self._last[seat], margin = number, min(gaps) - _ROUNDING_M
                break
        self._surely_within[seat] = (x, y, margin)


def _edge_lines(polygon: Sequence[Vec2]) -> list[Vec3]:
    """The lines (nx, ny, offset) through a polygon's edges: their points have nx * x + ny * y = offset [m].

    No point of an edge is nearer than its line, whose distance is cheaper to compute.
    """
    lines = []
    for (ax, ay), (bx, by) in zip(polygon, (*polygon[1:], polygon[0]), strict=True):
        if length := math.hypot(bx - ax, by - ay):
            nx, ny = (ay - by) / length, (bx - ax) / length
            lines.append((nx, ny, nx * ax + ny * ay))
    return lines
