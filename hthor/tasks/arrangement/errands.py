"""The least time to fetch and deliver several objects, one at a time, in the best order."""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from numpy.typing import ArrayLike

from hthor import rules
from hthor.houses.space.geodesic import DistanceField
from hthor.tasks.arrangement.reachability import SLACK_M, Bools, Floats, ReachableFloor, entry_cells

Remaining = tuple[int, ...]
"""Numbers of the objects that still have to be fetched, in ascending order."""


class Errand(Struct, frozen=True, kw_only=True):
    """An object to be fetched and delivered.

    Attributes:
        take, put: the cells from which it can be taken, and those from which it can be put down.
        handling: [s] of the hands. pace: [m/s] with the object in hand.
    """

    take: Bools
    put: Bools
    handling: float
    pace: float = rules.PACE_M_S


class Errands:
    """The shortest time of a person who knows all places, at `rules.PACE_M_S` with empty hands.

    They take an object and put it down before they take the next, in the order that takes the least time.
    """

    def __init__(self, ground: ReachableFloor, errands: Sequence[Errand]) -> None:
        self._ground, self._errands = ground, tuple(errands)
        self._fields: dict[tuple[int, Remaining, bool], DistanceField] = {}

    def seconds(self, starts: ArrayLike) -> Floats:
        """(N,) [s] for ``starts`` (N, 2) [m], less the slack of the grid; inf if an object cannot be delivered."""
        places = np.asarray(starts, dtype=float).reshape(-1, 2)
        walking = self._rest(places, tuple(range(len(self._errands))))
        slack = sum(2 * SLACK_M / rules.PACE_M_S + 2 * SLACK_M / one.pace for one in self._errands)
        slack -= SLACK_M / rules.PACE_M_S  # the start is exact
        least: Floats = np.maximum(walking - slack, 0.0) + sum(one.handling for one in self._errands)
        return least

    def _rest(self, places: Floats, remaining: Remaining) -> Floats:
        """(N,) [s] From ``places`` with empty hands, until all the objects that remain are delivered."""
        if not remaining:
            return np.zeros(len(places))
        walks = [self._to(places, one, tuple(n for n in remaining if n != one), False) for one in remaining]
        least: Floats = np.min(walks, axis=0)
        return least

    def _to(self, places: Floats, one: int, others: Remaining, loaded: bool) -> Floats:
        """(N,) [s] As above, but next comes the taking of object ``one``, or if ``loaded`` its putting down."""
        pace = self._pace(one, loaded)
        seconds: Floats = self._field(one, others, loaded).at(places) / pace
        if (there := self._ground.within(self._cells(one, loaded), places)).any():
            seconds[there] = self._after(places[there], one, others, loaded)
        return seconds

    def _after(self, places: Floats, one: int, others: Remaining, loaded: bool) -> Floats:
        return self._rest(places, others) if loaded else self._to(places, one, others, True)

    def _field(self, one: int, others: Remaining, loaded: bool) -> DistanceField:
        """Distances [m] to the cells of a stop, whose initial costs are what comes after it at this leg's pace."""
        key = (one, others, loaded)
        if key not in self._fields:
            edge = self._ground.space.centres(entry_cells(self._cells(one, loaded), self._ground.space.free))
            costs = self._after(edge, one, others, loaded) * self._pace(one, loaded)
            self._fields[key] = self._ground.paths.field(edge, costs)
        return self._fields[key]

    def _cells(self, one: int, loaded: bool) -> Bools:
        return self._errands[one].put if loaded else self._errands[one].take

    def _pace(self, one: int, loaded: bool) -> float:
        return self._errands[one].pace if loaded else rules.PACE_M_S
