"""What has happened and what is true, and the shape of a mind."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from msgspec import Struct

from hthor.types.actions import Action
from hthor.types.house import Pose
from hthor.types.observations import Briefing, Observation, ThingState


class Event(Struct, frozen=True, kw_only=True):
    """Something that happened: who, when, what."""

    tick: int
    seat: str
    kind: str
    data: dict[str, Any] = {}


class Snapshot(Struct, frozen=True, kw_only=True):
    """The truth at one tick, for the umpire and the log, never for a mind.

    ``in_view`` lists, for the person's seat, the objects that are in view within `rules.FIND_RANGE_M`.
    """

    tick: int
    poses: Mapping[str, Pose]
    things: Mapping[str, ThingState]
    in_view: Mapping[str, tuple[str, ...]]
    holding: Mapping[str, str]


class Mind(Protocol):
    """What sits in a seat: an agent or a human model."""

    def begin(self, briefing: Briefing) -> None: ...
    def act(self, observation: Observation) -> Action: ...
