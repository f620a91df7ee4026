"""The state of each body in an episode: where it is, what it is doing, what it holds."""

from typing import Protocol

from hthor.errors import UnknownName
from hthor.houses.space.free_space import FreeSpace
from hthor.types import BodySpec, Event, Outcome, Pose


class Activity(Protocol):
    """A motion under way."""

    def advance(self, tick: int) -> tuple[Outcome | None, tuple[Event, ...]]:
        """Carry it on by one tick; the outcome is None while it goes on."""


class BodyState:
    """One body in an episode.

    Attributes:
        name: its seat. spec: what it can do. space: the free floor for it now, with shut doorways taken out.
        pose: where it is; replaced by a new record whenever the body moves, never changed in place.
        activity: the motion under way, None while idle. outcome: how the last one ended.
        holding: id of the object in hand or held by a handle, empty for none.
    """

    __slots__ = ("activity", "holding", "name", "outcome", "pose", "space", "spec")

    def __init__(self, name: str, spec: BodySpec, space: FreeSpace) -> None:
        self.name, self.spec, self.space = name, spec, space
        self.clear(Pose(x=0.0, y=0.0))

    def clear(self, pose: Pose) -> None:
        """Begin an episode at ``pose``: idle, with empty hands."""
        self.pose = pose
        self.activity: Activity | None = None
        self.outcome: Outcome | None = None
        self.holding = ""


class BodyStates(dict[str, BodyState]):
    """The bodies of one world by seat; an unknown seat raises UnknownName, which lists the seats."""

    def __missing__(self, name: str) -> BodyState:
        raise UnknownName("seat", name, self)
