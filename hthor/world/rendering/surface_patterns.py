"""Which pattern each solid of a house is drawn with."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from hthor.looks import finishes
from hthor.types import HouseSpec
from hthor.world.model import geoms
from hthor.world.rendering import shading

CODE_PART = "pictures"

_BOARDS = ("planks", "parquet", "herringbone", "wicker")
_CLOTH = ("armchair", "bed", "cloth", "curtain", "dog_bed", "ottoman", "pillow", "rug", "sofa", "teddy_bear", "towel")


def geom_patterns(model: Any, owners: Sequence[str], house: HouseSpec, rgba: Any) -> Any:
    """(N,) int32: the pattern of each geom, a number of `hthor.world.rendering.shading`."""
    floors = {f"floor of {room.id}": _floor(room.floor) for room in house.rooms}
    outside = {wall.id for wall in house.walls if wall.room == "exterior"}
    walls = {wall.id for wall in house.walls}
    cloth = {thing.id for thing in house.things if thing.kind in _CLOTH}
    things = {thing.id for thing in house.things}
    out = np.zeros(model.ngeom, np.int32)
    for geom, owner in enumerate(owners):
        if owner in floors:
            out[geom] = floors[owner]
        elif owner.startswith("ceiling of "):
            out[geom] = shading.GLOWING
        elif owner == "outdoors":
            out[geom] = shading.LAWN
        elif owner in walls:
            out[geom] = shading.BRICK if owner in outside else shading.PLASTER
        elif owner in things and model.geom_group[geom] == geoms.FURNITURE and _wooden(rgba[geom]):
            out[geom] = shading.GRAIN
        elif owner in cloth:
            out[geom] = shading.CLOTH
    return out


def _floor(material: str) -> int:
    texture = finishes.floor(material)[0]
    if texture == "carpet":
        return shading.CARPET
    return shading.PLANKS if texture.startswith(_BOARDS) else shading.TILES


def _wooden(rgba: Any) -> bool:
    """Whether a colour is that of wood, from walnut to birch, and not of rust, mustard or cream."""
    red, green, blue, _ = (float(value) for value in rgba)
    return red < 0.88 and red - blue > 0.15 and 0.38 < (green - blue) / (red - blue) < 0.62
