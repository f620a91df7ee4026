"""What a robot has been close enough to detect in a trial so far."""

import math

from hthor.types import Detection, Observation, ThingState


class Sightings:
    """Things that the robot has detected, where they were last.

    A robot that gets true states (`Observation.truth`) knows where a thing is now, but speaks only of things that it
    has been close to: those that it has detected, or has told people about in front of a closed door.
    """

    def __init__(self) -> None:
        self._things: dict[str, Detection] = {}
        self._told: set[str] = set()
        self._last: tuple[Detection, ...] = ()
        self._new: list[tuple[Detection, ...]] = []  # only looked through when something is asked for

    def note(self, observation: Observation) -> None:
        """Remember what is in view; call at every act."""
        detections = observation.detections
        if detections is not self._last:
            self._last = detections
            self._new.append(detections)

    def note_told(self, object: str) -> None:
        """Remember that people were told where this thing is."""
        self._told.add(object)

    def named(self, name: str, observation: Observation) -> list[ThingState]:
        """The things of this id or kind, as far as they are known; first the one of this id, then the nearest."""
        truth = {state.id: state for state in observation.truth}
        known = {id: truth.get(id) or _state(seen) for id, seen in self._known().items()}
        known |= {id: truth[id] for id in self._told if id in truth}
        here = (observation.pose.x, observation.pose.y)
        alike = [state for state in known.values() if name in (state.id, state.kind)]
        return sorted(alike, key=lambda state: (state.id != name, math.dist(here, state.position[:2]), state.id))

    def kind(self, thing: str) -> str:
        """The kind of a thing that was detected, empty for any other."""
        seen = self._known().get(thing)
        return "" if seen is None else seen.kind

    def kinds(self) -> dict[str, str]:
        """The kind of everything that was detected, by id."""
        return {id: seen.kind for id, seen in self._known().items()}

    def _known(self) -> dict[str, Detection]:
        """The things that were detected, as seen last."""
        for detections in self._new:
            for seen in detections:
                if seen.family in ("object", "furniture"):
                    self._things[seen.id] = seen
        self._new.clear()
        return self._things


def _state(seen: Detection) -> ThingState:
    return ThingState(id=seen.id, kind=seen.kind, position=seen.position, support=seen.support, held_by=seen.held_by)
