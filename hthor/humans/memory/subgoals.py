"""The jobs of a trial, and which of them are done as far as the participant knows."""

import math
import re
from typing import Literal

from msgspec import Struct

from hthor.humans.core.trial_context import HumanContext
from hthor.humans.memory.object_memory import KnownObject
from hthor.humans.memory.spatial_memory import KnownPlace, SpatialMemory
from hthor.types import Job, Vec3

_SPOT_M = 0.2
"""[m] An object this near to its remembered spot is where it belongs. Our choice."""
_JOINT_SPOT_M = 0.6
"""[m] The same distance for an object that several people carry. Our choice."""
_ENOUGH_TRIES = 2
"""[count] How often people put an object down where it belongs, before they leave it where it is. Our choice."""


class Subgoal(Struct, kw_only=True):
    """One job as the participant sees it, about the object ``known`` of this ``kind``.

    ``spot`` [m] is the exact place where the object belongs, as remembered. ``done`` says how the participant knows
    that the job is done, empty while it is not; ``tries`` counts how often they put the object down where it belongs.
    """

    job: Job
    kind: str
    known: KnownObject
    spot: Vec3 | None = None
    done: Literal["", "seen", "told"] = ""
    tries: int = 0

    @property
    def target(self) -> str:
        """The object's id."""
        return self.job.target

    @property
    def by_room(self) -> bool:
        """Whether the object belongs in a room, at any place there."""
        return self.job.relation == "at" and bool(self.job.destinations)


class SubgoalTracker:
    """All jobs of a trial, by their objects' ids. ``many``: there are several, or one takes several carriers."""

    def __init__(self, human: HumanContext, memory: SpatialMemory, known: dict[str, KnownObject]) -> None:
        self.human, self.memory = human, memory
        jobs = human.task.todo
        self.many = len(jobs) > 1 or any(job.hands > 1 for job in jobs)
        self.all = {job.target: self._subgoal(job, known[job.target]) for job in jobs}

    def unfinished(self) -> list[Subgoal]:
        """Jobs not known to be done, in the order of the briefing."""
        return [subgoal for subgoal in self.all.values() if not subgoal.done]

    def update(self) -> None:
        """Mark jobs as done if their object was seen where it belongs, as not done if it was seen elsewhere since."""
        for subgoal in self.all.values():
            seen = subgoal.known.seen
            if seen is None or subgoal.known.at < 0 or (subgoal.by_room and subgoal.known.at != self.human.now.tick):
                continue
            resting = not seen.held_by and not seen.bearers
            if resting and self.is_at_destination(subgoal, seen.position, seen.support):
                subgoal.done = "seen"
            elif subgoal.done == "told" or (subgoal.done and subgoal.tries < _ENOUGH_TRIES):
                subgoal.done = ""

    def is_at_destination(self, subgoal: Subgoal, position: Vec3, support: str) -> bool:
        """Whether an object at ``position`` [m], on or in the thing of id ``support``, is where it belongs."""
        job = subgoal.job
        if job.relation in ("find", "back"):
            return False
        near = _JOINT_SPOT_M if job.hands > 1 else _SPOT_M
        if subgoal.spot is not None and math.dist(position[:2], subgoal.spot[:2]) > near:
            return False
        if subgoal.by_room:
            return self.room_of(position) in job.destinations
        if not job.destinations:
            return subgoal.spot is not None
        place = self.memory.places.get(support)
        return support in job.destinations or (place is not None and place.kind in job.destinations)

    def room_of(self, position: Vec3) -> str:
        """The room of a thing in view at ``position`` [m]: the current room, empty if it is seen through a doorway."""
        here, there = self.human.here, (position[0], position[1])
        through = any(doorway.is_crossed(here, there) for doorway in self.memory.doorways.values())
        return "" if through else self.human.now.room

    def is_destination(self, subgoal: Subgoal, place: KnownPlace) -> bool:
        """Whether the object belongs on or in a place."""
        return place.kind in subgoal.job.destinations or place.id in subgoal.job.destinations

    def known_destinations(self, subgoal: Subgoal) -> list[KnownPlace]:
        """The places where the object belongs that are known and not forgotten."""
        return [p for p in self.memory.places.values() if p.recalled and self.is_destination(subgoal, p)]

    def knows_destination(self, subgoal: Subgoal) -> bool:
        """Whether the participant knows where to bring the object."""
        return subgoal.spot is not None or bool(self.known_destinations(subgoal))

    def forgot_destination(self, subgoal: Subgoal) -> bool:
        """Whether the participant saw a place where the object belongs, and forgot where it is."""
        return any(not place.recalled and self.is_destination(subgoal, place) for place in self.memory.places.values())

    def _subgoal(self, job: Job, known: KnownObject) -> Subgoal:
        return Subgoal(job=job, kind=object_kind(job.target), known=known, spot=self._remembered(job))

    def _remembered(self, job: Job) -> Vec3 | None:
        """The exact place of an object as remembered from a tour of the house: with an error, or None if forgotten."""
        if job.place is None or job.hands > 1:
            return job.place
        human, off = self.human, self.human.traits.tour_sd
        if human.draw("tour", job.target, "forgotten") < human.traits.tour_forget:
            return None
        x, y, z = job.place
        dx, dy = (off * human.normal("tour", job.target, axis) for axis in ("x", "y"))
        return (x + dx, y + dy, z)


def object_kind(target: str) -> str:
    """The kind of an object by its id: "apple" of "apple" and of "apple_2"."""
    return re.sub(r"_\d+$", "", target)
