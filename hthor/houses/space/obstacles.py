"""The furniture that is in the way of a body: whole pieces, or for a flat body only those parts that it does not fit
under.
"""

from collections.abc import Iterator

from hthor.houses.space import boxes, solids
from hthor.houses.space.solids import Slab
from hthor.types import HouseSpec, Thing

STEP_M = 0.05
"""[m] Things up to this height, such as a rug, stop nobody; our choice."""
FLAT_M = 0.70
"""[m] A body up to this height passes under furniture. A taller one, which fits under no table, keeps off the whole
bounding box of a piece; our choice.
"""
CLEARANCE_M = 0.02
"""[m] Gap that a flat body needs between its top and what it passes under; our choice."""


def furniture_in_the_way(house: HouseSpec, height: float) -> Iterator[tuple[Thing, Slab]]:
    """The things that stop a body ``height`` [m] tall, each with an upright box that blocks the floor below it.

    For a body of at most `FLAT_M`, a thing is given once for each of its parts that is lower than the body needs, with
    its doors and drawers closed.
    """
    for thing, slab in solids.furniture_slabs(house):
        if height > FLAT_M:
            if slab.low < height and slab.high > STEP_M:
                yield thing, slab
        elif slab.low < height + CLEARANCE_M:
            for _, box in boxes.boxes_of(thing):
                part = boxes.bounding_slab(box)
                if part.low < height + CLEARANCE_M and part.high > STEP_M:
                    yield thing, part
