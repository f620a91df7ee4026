"""Everything a picture of one moment needs, copied so cheaply that every message can carry it; draws nothing."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from hthor.types import BodySpec, Pose


class Moment(NamedTuple):
    """``qpos``: the engine's positions. ``seats``: each seat's pose and body, in the order of the seats."""

    qpos: Any
    seats: Mapping[str, tuple[Pose, BodySpec]]
