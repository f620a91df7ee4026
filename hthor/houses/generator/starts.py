"""Where a body starts: roomy floor of a random room."""

from __future__ import annotations

import numpy as np

from hthor.houses.generator.draws import Dice
from hthor.houses.space.free_space import Bools, FreeSpace
from hthor.types import HouseSpec

_GRID_M = 0.25
_ROOMY_M = 0.45
_SHARES = {"living_room": 4.0, "kitchen": 3.0, "bedroom": 2.0, "bathroom": 0.4}


def choose_start(house: HouseSpec, space: FreeSpace, reached: Bools, dice: Dice) -> tuple[float, float, int] | None:
    """A place (x, y) [m] on the quarter-metre grid and quarter turns clockwise from +y; None when no place is roomy."""
    weights = [_SHARES[room.kind] for room in house.rooms]
    for attempt in range(20):
        room = dice.weighted(house.rooms, weights, "room", attempt)
        spots = _spots(space, reached & space.room_mask(room))
        if len(spots):
            x, y = spots[dice.whole(0, len(spots) - 1, "spot", attempt)]
            return float(x), float(y), dice.whole(0, 3, "turn", attempt)
    return None


def _spots(space: FreeSpace, floor: Bools) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """(N, 2) places of the quarter-metre grid with free floor all round."""
    reach = round((_ROOMY_M - space.radius) / space.cell)
    roomy = floor.copy()
    for shift in range(1, reach + 1):
        roomy[shift:, :] &= floor[:-shift, :]
        roomy[:-shift, :] &= floor[shift:, :]
        roomy[:, shift:] &= floor[:, :-shift]
        roomy[:, :-shift] &= floor[:, shift:]
    places = np.unique(np.round(space.centres(roomy) / _GRID_M), axis=0) * _GRID_M
    return np.array([place for place in places if roomy[space.cell_of(place[0], place[1])]]).reshape(-1, 2)
