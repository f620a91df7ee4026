"""Mapping, planning, frontiers and walking, for agents and human models. Begin with `planner`.

All positions and lengths are in metres in the house frame. Names are imported on first use, because the compiled parts
take a moment to load.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hthor.navigation.distance_field import Field
    from hthor.navigation.frontier import Frontier, Survey, frontiers, unvisited
    from hthor.navigation.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
    from hthor.navigation.path_follower import Courtesy, Follower, face
    from hthor.navigation.planner import Planner
    from hthor.navigation.waiting_spots import park, retreat

_NAMES = {
    "distance_field": ("Field",),
    "frontier": ("Frontier", "Survey", "frontiers", "unvisited"),
    "grid_map": ("FREE", "OCCUPIED", "UNKNOWN", "GridMap"),
    "path_follower": ("Courtesy", "Follower", "face"),
    "planner": ("Planner",),
    "waiting_spots": ("park", "retreat"),
}
_HOMES = {name: module for module, names in _NAMES.items() for name in names}

__all__ = [
    "FREE",
    "OCCUPIED",
    "UNKNOWN",
    "Courtesy",
    "Field",
    "Follower",
    "Frontier",
    "GridMap",
    "Planner",
    "Survey",
    "face",
    "frontiers",
    "park",
    "retreat",
    "unvisited",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
