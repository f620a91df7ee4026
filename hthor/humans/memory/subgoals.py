"""What there is to do, and what of it is done as far as the person knows."""

from __future__ import annotations

import math
import re
from typing import Literal

from msgspec import Struct

from hthor.humans.core.trial_context import Subject
from hthor.humans.memory.object_memory import Known
from hthor.humans.memory.spatial_memory import Memory, Place
from hthor.types import Briefing, Job, Vec3

_HOME_M, _TOGETHER_M = 0.2, 0.6
"""How near to where it belongs, as people remember it, they leave an object, and one that several carry."""
_RELATIONS: tuple[Literal["find", "on", "in", "at"], ...] = ("find", "on", "in", "at")
_ENOUGH = 2
"""So often people put an object down where it belongs before they leave it where it came to lie."""


class Duty(Struct, kw_only=True):
    """One job as the person sees it, about the object ``known`` of this ``kind``.

    ``spot`` [m] is where the object belongs exactly, as far as that is remembered. ``done`` says how the person knows
    that it is done, empty while it is not; ``tries`` how often they put the object down there.
    """

    job: Job
    kind: str
    known: Known
    spot: Vec3 | None = None
    done: Literal["", "seen", "told"] = ""
    tries: int = 0

    @property
    def target(self) -> str:
        """The object's id."""
        return self.job.target

    @property
    def by_room(self) -> bool:
        """Whether it belongs in a room, whatever it stands on there."""
        return self.job.relation == "at" and bool(self.job.destinations)


class Duties:
    """All jobs of a trial, by the ids of their objects. ``many``: more than one object for one pair of hands."""

    def __init__(self, me: Subject, memory: Memory, known: dict[str, Known]) -> None:
        self.me, self.memory = me, memory
        jobs = todo(me.task)
        self.many = len(jobs) > 1 or any(job.hands > 1 for job in jobs)
        self.all = {job.target: self._duty(job, known[job.target]) for job in jobs}

    def open(self) -> list[Duty]:
        """Those not known to be done, in the order of the briefing."""
        return [duty for duty in self.all.values() if not duty.done]

    def settle(self) -> None:
        """Judge by what was seen what is done: an object that lies where it belongs, and no more when it was moved."""
        for duty in self.all.values():
            seen = duty.known.seen
            if seen is None or duty.known.at < 0 or (duty.by_room and duty.known.at != self.me.now.tick):
                continue
            if not seen.held_by and not seen.bearers and self.at_home(duty, seen.position, seen.support):
                duty.done = "seen"
            elif duty.done == "told" or (duty.done and duty.tries < _ENOUGH):
                duty.done = ""

    def at_home(self, duty: Duty, position: Vec3, support: str) -> bool:
        """Whether an object at ``position`` [m], on or in the thing of id ``support``, is where it belongs."""
        job = duty.job
        if job.relation == "find":
            return False
        near = _TOGETHER_M if job.hands > 1 else _HOME_M
        if duty.spot is not None and math.dist(position[:2], duty.spot[:2]) > near:
            return False
        if duty.by_room:
            return self.room_of(position) in job.destinations
        if not job.destinations:
            return duty.spot is not None
        place = self.memory.places.get(support)
        return support in job.destinations or (place is not None and place.kind in job.destinations)

    def room_of(self, position: Vec3) -> str:
        """The room of something in view at ``position`` [m]: the person's own, empty when a doorway is between."""
        here, there = self.me.here, (position[0], position[1])
        through = any(doorway.crossed(here, there) for doorway in self.memory.doorways.values())
        return "" if through else self.me.now.room

    def serves(self, duty: Duty, place: Place) -> bool:
        """Whether a place is where the object belongs."""
        return place.kind in duty.job.destinations or place.id in duty.job.destinations

    def places(self, duty: Duty) -> list[Place]:
        """The places known where the object belongs, and not forgotten since."""
        return [place for place in self.memory.places.values() if place.recalled and self.serves(duty, place)]

    def knows(self, duty: Duty) -> bool:
        """Whether the person knows where to bring the object."""
        return duty.spot is not None or bool(self.places(duty))

    def forgot(self, duty: Duty) -> bool:
        """Whether the person came across a place where the object belongs, and could not tell any more where."""
        return any(not place.recalled and self.serves(duty, place) for place in self.memory.places.values())

    def _duty(self, job: Job, known: Known) -> Duty:
        return Duty(job=job, kind=kind_of(job.target), known=known, spot=self._remembered(job))

    def _remembered(self, job: Job) -> Vec3 | None:
        """Where exactly an object belongs, as a tour of the house left it in memory: somewhat off, or not at all."""
        if job.place is None or job.hands > 1:
            return job.place
        me, off = self.me, self.me.traits.tour_sd
        if me.draw("tour", job.target, "forgotten") < me.traits.tour_forget:
            return None
        x, y, z = job.place
        return (x + off * me.normal("tour", job.target, "x"), y + off * me.normal("tour", job.target, "y"), z)


def todo(task: Briefing) -> tuple[Job, ...]:
    """All there is to do; a briefing without a list of jobs tells of one."""
    if task.jobs:
        return task.jobs
    destinations = (task.destination,) if task.destination else ()
    relation = next((known for known in _RELATIONS if known == task.relation), _RELATIONS[0])
    return (Job(target=task.target, relation=relation, destinations=destinations),)


def kind_of(target: str) -> str:
    """The kind of an object by its id: "apple" of "apple" and of "apple_2"."""
    return re.sub(r"_\d+$", "", target)
