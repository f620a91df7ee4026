"""The whole truth of a world, worked out anew only where something changed; knows nothing of who may learn it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from hthor import rules
from hthor.types import HUMAN, Snapshot, ThingState
from hthor.world.doors import Doors
from hthor.world.gaze import Gaze
from hthor.world.objects import Objects
from hthor.world.seats import Seat


class Truth:
    """States of all objects and of all things that open, and what the person has in view."""

    def __init__(self, objects: Objects, doors: Doors, gaze: Gaze, seats: Sequence[Seat]) -> None:
        self._objects, self._doors, self._gaze, self._seats = objects, doors, gaze, seats
        self._human = next(seat for seat in seats if seat.name == HUMAN)
        self._things: dict[str, ThingState] = {}
        self._version = (-1, -1)
        self._view: tuple[Any, tuple[str, ...]] = (None, ())

    def snapshot(self, tick: int) -> Snapshot:
        """Everything at this tick."""
        return Snapshot(
            tick=tick,
            poses={seat.name: seat.pose for seat in self._seats},
            things=self.states(),
            in_view={HUMAN: self._in_view()},
            holding={seat.name: seat.holding for seat in self._seats},
        )

    def states(self) -> dict[str, ThingState]:
        """By id: a fresh dict whenever anything changed, the same one as long as nothing did."""
        version = (self._objects.changes, self._doors.changes)
        if version != self._version:
            states = [*(item.state() for item in self._objects if item.present), *self._doors.states()]
            self._things = {state.id: state for state in sorted(states, key=lambda state: state.id)}
            self._version = version
        return self._things

    def _in_view(self) -> tuple[str, ...]:
        key = (self._human.pose, self._objects.changes, self._doors.changes)
        if self._view[0] is None or key != self._view[0]:
            self._view = (key, self._gaze.in_view(self._human, rules.FIND_RANGE_M))
        return self._view[1]
