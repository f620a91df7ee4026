"""Names what a body ran into: the thing, wall or shut door nearest to a place."""

from collections.abc import Iterable

from hthor.geometry import plane
from hthor.houses.space import solids
from hthor.houses.space.free_space import STEP_M
from hthor.types import HouseSpec, Opening, Vec2
from hthor.world.state import doorways

WALL = "wall"
_JAMB_M = 0.05
"""[m] by which a wall next to a shut door may be nearer and the door still be named."""


class ObstacleFootprints:
    """The footprints of a house's walls and furniture."""

    def __init__(self, house: HouseSpec) -> None:
        self._slabs = [(WALL, slab) for slab in solids.wall_slabs(house)]
        self._slabs += [(thing.id, slab) for thing, slab in solids.furniture_slabs(house) if slab.high > STEP_M]

    def nearest(self, place: Vec2, height: float, shut: Iterable[Opening] = ()) -> str:
        """Id of the thing nearest to ``place`` [m] that stands in the way of a body ``height`` [m] tall, or "wall".

        Args:
            shut: the doorways that are shut now; they count before what is not nearer.
        """
        gaps = (
            (plane.distance_to_rectangle(place, slab.centre, slab.size, slab.yaw), index)
            for index, (_, slab) in enumerate(self._slabs)
            if slab.low < height
        )
        gap, index = min(gaps, default=(0.0, -1))
        for opening in shut:
            x, y, half, deep, yaw = doorways.leaf_rectangle(opening)
            if plane.distance_to_rectangle(place, (x, y), (2 * half, 2 * deep), yaw) <= gap + _JAMB_M:
                return opening.id
        return self._slabs[index][0] if index >= 0 else WALL
