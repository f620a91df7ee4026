"""What a mind may use to map, plan, find frontiers and walk; knows nothing of engines, tasks or messages.

Names are imported on first use, because the compiled parts take a moment to load.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hthor.navigation.courtesy import Courtesy
    from hthor.navigation.field import Field
    from hthor.navigation.follow import Follower, face
    from hthor.navigation.frontier import Frontier, Survey, frontiers, unvisited
    from hthor.navigation.map import FREE, OCCUPIED, UNKNOWN, GridMap
    from hthor.navigation.parking import park, retreat
    from hthor.navigation.planner import Planner

_HOMES = {
    "Courtesy": "courtesy",
    "park": "parking",
    "retreat": "parking",
    "Follower": "follow",
    "face": "follow",
    "Frontier": "frontier",
    "Survey": "frontier",
    "frontiers": "frontier",
    "unvisited": "frontier",
    "FREE": "map",
    "OCCUPIED": "map",
    "UNKNOWN": "map",
    "GridMap": "map",
    "Field": "field",
    "Planner": "planner",
}

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
