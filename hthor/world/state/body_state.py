"""A body's state in one episode: where it is, what it does, what it holds."""

from __future__ import annotations

from typing import Protocol

from hthor.errors import UnknownName
from hthor.houses.space.free_space import FreeSpace
from hthor.types import BodySpec, Event, Outcome, Pose


class Activity(Protocol):
    """A motion under way."""

    def advance(self, tick: int) -> tuple[Outcome | None, tuple[Event, ...]]:
        """One tick of it; the outcome is None while it goes on."""


class BodyState:
    """One body. ``x``, ``y`` [m] and ``yaw``, ``pitch`` [rad] change through `put` only, which renews ``pose``."""

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
    """The bodies of one world by name; asking for one that is not there says which are."""

    def __missing__(self, name: str) -> BodyState:
        raise UnknownName("seat", name, self)
