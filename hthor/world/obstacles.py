"""Naming what a body ran into: the thing or wall nearest to a place; knows nothing of how bodies move."""

from __future__ import annotations

from hthor import geometry
from hthor.houses import solids
from hthor.types import HouseSpec, Vec2

WALL = "wall"


class Obstacles:
    """The footprints of a house's walls and furniture."""

    def __init__(self, house: HouseSpec) -> None:
        self._slabs = [(WALL, slab) for slab in solids.walls(house)]
        self._slabs += [(thing.id, slab) for thing, slab in solids.furniture(house)]

    def nearest(self, place: Vec2, height: float) -> str:
        """Id of the thing nearest to ``place`` [m] that stands in the way of a body ``height`` [m] tall, or "wall"."""
        gaps = (
            (geometry.distance_to_rectangle(place, slab.centre, slab.size, slab.yaw), index)
            for index, (_, slab) in enumerate(self._slabs)
            if slab.low < height
        )
        _, index = min(gaps, default=(0.0, -1))
        return self._slabs[index][0] if index >= 0 else WALL
