"""The true state of a world; only the parts that changed are recomputed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from hthor.errors import StaleObservation
from hthor.types import Pose, Snapshot, ThingState, is_person
from hthor.world.perception.visibility import Visibility
from hthor.world.state.body_state import BodyState
from hthor.world.state.doors import Doors
from hthor.world.state.objects import Objects

_Moment = tuple[int | Pose, ...]
"""What the people's objects in view depend on: the numbers of changes of objects and doors, and the people's poses."""


class GroundTruth:
    """The states of all objects and all things that open, and the objects that each person has in view."""

    def __init__(self, objects: Objects, doors: Doors, visibility: Visibility, seats: Sequence[BodyState]) -> None:
        self._objects, self._doors, self._visibility, self._seats = objects, doors, visibility, seats
        self._people = {seat.name: seat for seat in seats if is_person(seat.name)}
        self._names = tuple(self._people)
        self._first, *self._others = self._people.values()
        self._things: dict[str, ThingState] = {}
        self._version = (-1, -1)
        self._view: LazyInView | None = None  # the same record as long as nothing changes

    def snapshot(self, tick: int) -> Snapshot:
        """The true state at this tick."""
        poses, holding = {}, {}
        for seat in self._seats:  # called at every tick: one loop is cheaper than two comprehensions
            poses[seat.name], holding[seat.name] = seat.pose, seat.holding
        view, moment = self._view, self._moment()
        if view is None or view.moment != moment:
            self._view = view = LazyInView(self, self._names, moment, tick)
        return Snapshot(tick=tick, poses=poses, things=self.states(), in_view=view, holding=holding)

    def states(self) -> dict[str, ThingState]:
        """States by id; the same dict as before if nothing has changed, else a new one."""
        version = (self._objects.changes, self._doors.changes)
        if version != self._version:
            self._things = self._renewed(doors=version[1] != self._version[1])
            self._version = version
        return self._things

    def _renewed(self, doors: bool) -> dict[str, ThingState]:
        """The states, with those that changed replaced; ``doors`` says whether any door moved."""
        things, known = dict(self._things), len(self._things)
        gone = False
        for item in self._objects.news():
            if item.present:
                things[item.id] = item.state()
            else:
                gone = things.pop(item.id, None) is not None or gone
        if doors:
            things.update((state.id, state) for state in self._doors.states())
        return {id: things[id] for id in sorted(things)} if gone or len(things) != known else things

    def _moment(self) -> _Moment:
        if not self._others:
            return (self._objects.changes, self._doors.changes, self._first.pose)
        return (self._objects.changes, self._doors.changes, *(seat.pose for seat in self._people.values()))

    def look(self, seat: str, moment: _Moment, tick: int) -> tuple[str, ...]:
        """Ids of the objects that a person has in view.

        Raises:
            StaleObservation: when the world is no longer at this ``moment``.
        """
        if moment != self._moment():
            raise StaleObservation(
                f"in_view of the snapshot of tick {tick} was read after the world had moved on; "
                "read it while the snapshot is new"
            )
        return self._visibility.in_view(self._people[seat])


class LazyInView(Mapping[str, tuple[str, ...]]):
    """The value of `hthor.types.Snapshot.in_view`, computed at its first reading because few tasks read it."""

    __slots__ = ("_found", "_people", "_tick", "_truth", "moment")

    def __init__(self, truth: GroundTruth, people: tuple[str, ...], moment: _Moment, tick: int) -> None:
        self._truth, self._people, self._tick, self.moment = truth, people, tick, moment
        self._found: dict[str, tuple[str, ...]] = {}

    def __getitem__(self, seat: str) -> tuple[str, ...]:
        if seat not in self._found:
            if seat not in self._people:
                raise KeyError(seat)
            self._found[seat] = self._truth.look(seat, self.moment, self._tick)
        return self._found[seat]

    def __iter__(self) -> Iterator[str]:
        return iter(self._people)

    def __len__(self) -> int:
        return len(self._people)

    def __repr__(self) -> str:
        return repr(dict(self))
