"""A robot's knowledge about objects and furniture, and about jobs that are done."""

import math
from collections.abc import Collection, Iterable, Mapping

from hthor import catalog
from hthor.geometry import plane
from hthor.types import HUMAN, Job, Observation, Place, Room, Thing, ThingState, Vec3

PAPER_KINDS = ("", "mobile_manipulation", "object_goal_navigation")
"""The two kinds of the paper, in which robots say and do what the paper's robots did; "" is an unnamed kind."""
CLOSE_M, TOGETHER_M = 0.25, 0.7
"""Distance [m] to its place at which an object is done; the second is for an object that several bodies carry."""

_STEP_M = 0.15


class Knowledge:
    """Furniture and objects that an agent knows.

    Attributes:
        things: furniture by id. states: objects, and furniture that opens, by id. rooms: empty without a map.
    """

    def __init__(self, things: Iterable[Thing] = (), rooms: Iterable[Room] = ()) -> None:
        self.things: dict[str, Thing] = {thing.id: thing for thing in things}
        self.rooms: dict[str, Room] = {room.id: room for room in rooms}
        self.states: Mapping[str, ThingState] = {}

    def is_done(self, job: Job) -> bool:
        """Whether the object is where it belongs; a search is never done.

        Nor is a job whose place is not told.
        """
        state = self.states.get(job.target)
        if state is None or state.held_by or state.bearers or job.relation in ("find", "back"):
            return False
        close = TOGETHER_M if job.hands > 1 else CLOSE_M
        if job.place is not None and math.dist(state.position[:2], job.place[:2]) > close:
            return False
        return not job.destinations or any(self._is_at(state, place) for place in job.destinations)

    def bearers(self, job: Job) -> list[Thing]:
        """The furniture that the object may be put on or in."""
        return [thing for thing in self.things.values() if self.serves(thing, job)]

    def serves(self, thing: Thing, job: Job) -> bool:
        """Whether the object belongs on or in this thing."""
        return thing.id in job.destinations or thing.kind in job.destinations

    def all_hold(self, people: Collection[str]) -> bool:
        """Whether each of these people is known to have something in hand."""
        holders = {state.held_by for state in self.states.values()}
        return all(seat in holders for seat in people or (HUMAN,))

    def is_shut(self, id: str) -> bool:
        """Whether this is a thing whose content is behind a door, and the door is closed."""
        thing, state = self.things.get(id), self.states.get(id)
        return thing is not None and has_door(thing) and (state is None or not state.open)

    def _is_at(self, state: ThingState, place: str) -> bool:
        if place in self.rooms:
            return plane.inside(state.position[:2], self.rooms[place].polygon)
        thing = self.things.get(state.support)
        return state.support == place or (thing is not None and thing.kind == place)


class ObservedKnowledge(Knowledge):
    """Knowledge from detections alone: things where they were seen last."""

    def __init__(self) -> None:
        super().__init__()
        self._known: dict[str, ThingState] = {}
        self.states = self._known

    def note(self, observation: Observation) -> None:
        """Update from the things in view."""
        for seen in observation.detections:
            if seen.family == "object":
                self._known[seen.id] = ThingState(
                    id=seen.id, kind=seen.kind, position=seen.position, support=seen.support, held_by=seen.held_by
                )
            elif seen.family == "furniture":
                if seen.id not in self.things:
                    self.things[seen.id] = Thing(
                        id=seen.id, kind=seen.kind, asset="", centre=seen.position, size=seen.size, yaw=seen.yaw
                    )
                if seen.state:
                    self._known[seen.id] = ThingState(
                        id=seen.id, kind=seen.kind, position=seen.position, open=seen.state == "open"
                    )

    def put(self, object: str, place: Place) -> None:
        """Note that the robot itself has put an object down there, in view or not."""
        state = self._known.get(object)
        if state is not None:
            position = place.position or state.position
            self._known[object] = ThingState(id=object, kind=state.kind, position=position, support=place.on)

    def forget(self, object: str) -> None:
        """Forget an object that is not where it was."""
        self._known.pop(object, None)

    def begin_again(self) -> None:
        """Keep only the furniture, because things were moved."""
        self._known.clear()

    def shut(self) -> list[Thing]:
        """Furniture whose inside is hidden by a closed door."""
        return [thing for thing in self.things.values() if has_door(thing) and self.is_shut(thing.id)]


def has_door(thing: Thing) -> bool:
    """Whether a thing must be opened before its inside can be seen."""
    return catalog.kind(thing.kind).hides


def resting_points(thing: Thing, inset_m: float) -> tuple[Vec3, ...]:
    """Points [m] on a thing's surfaces where an object of half width ``inset_m`` could lie."""
    points = []
    for surface in catalog.kind(thing.kind).rests(thing.size):
        (x, y, z), (w, d) = surface.centre, surface.half
        us, vs = _steps(w - inset_m), _steps(d - inset_m)
        points += [plane.to_house((x + u, y + v, z), thing.centre, thing.yaw) for u in us for v in vs]
    return tuple(points)


def _steps(half: float) -> list[float]:
    """Evenly spaced coordinates on a line that is twice ``half`` [m] long."""
    if half <= 0.0:
        return [0.0]
    count = math.ceil(2.0 * half / _STEP_M)
    return [half * (2.0 * k / count - 1.0) for k in range(count + 1)]
