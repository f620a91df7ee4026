"""A robot that is right about half of the time, for calibration: how people answer true and false messages."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hthor import catalog, seeds
from hthor.agents.nearest import Agent as Explorer
from hthor.agents.skills.message_timing import kind_title, place_phrase
from hthor.types import Action, Briefing, Observation, Send, Thing, Wait, is_person

if TYPE_CHECKING:
    from hthor.types import Vec3

_ROOT = seeds.derive(7, "unreliable")
FIRST_S, EVERY_S = 6.0, 15.0
"""[s] When its first message of a trial comes, and the time between two. Our choice: time to read and to follow."""
MOST = 5
"""[count] Messages in a trial at most. Our choice."""
_APART_M = 2.5
"""[m] So far a false place is from the true one at least. Our choice: nobody who goes there finds the object."""


class Agent(Explorer):
    """Explores, and says from time to time where the object that is missing is, or where it has to be brought.

    Which of its messages are wrong depends on the task alone: the first message of a trial and each later one are true
    or false by chance, and never more than two in a row are alike. Short and long messages take turns. It says nothing
    on a walk along a described way.
    """

    privileges: tuple[str, ...] = ("house_map", "ideal_detector", "object_poses")

    def begin(self, briefing: Briefing) -> None:
        """Look up which messages of this trial will be true."""
        super().begin(briefing)
        assert briefing.house is not None, "the agent needs the privilege house_map"
        self.house, self.said = briefing.house, 0
        self.key = f"{briefing.house.id} {briefing.instruction}"
        self.truths = truths(self.key)

    def act(self, observation: Observation) -> Action:
        """Explore, and say what is due."""
        if self.briefing.relation == "go":
            return Action(motion=Wait(seconds=1.0))
        motion = super().act(observation).motion
        due = self.said < MOST and observation.tick * self.briefing.tick_s >= FIRST_S + EVERY_S * self.said
        return Action(motion=motion, say=self._say(observation) if due else None)

    def _say(self, observation: Observation) -> Send | None:
        """The message that is due, about the object or, once a person has it, about its destination."""
        job = self.briefing.todo[0]
        target = next((one for one in observation.truth if one.id == job.target), None)
        if target is None:
            return None
        if not is_person(target.held_by):
            beside = next((one for one in self.house.things if one.id == target.support), None)
            return self._send(target.id, target.kind, beside, target.position)
        own = next((thing for thing in self.house.things if thing.kind in job.destinations), None)
        return None if own is None else self._send(own.kind, own.kind, own, own.centre, is_place=True)

    def _send(self, name: str, kind: str, true: Thing | None, position: Vec3, *, is_place: bool = False) -> Send:
        """A message that something of this name and kind is on a thing, None for the floor, or is that thing."""
        where = true
        if not self.truths[self.said]:
            where = self._elsewhere(position, true.room if true is not None else "")
            position = where.centre
        there = "on the floor" if where is None else self._room_phrase(where)
        if where is not None and not is_place:
            there = f"{place_phrase(where.kind)} {there}"
        text = f"{kind_title(kind).capitalize()} is {there}."
        if self.said % 2:
            text = f"I have been looking round for a while now, and I think that {kind_title(kind)} is {there}."
        self.said += 1
        return Send(text=text, object=name, position=position)

    def _room_phrase(self, thing: Thing) -> str:
        return next((f"in the {one.name}" for one in self.house.rooms if one.id == thing.room), "in this house")

    def _elsewhere(self, place: Vec3, room: str) -> Thing:
        """A piece of furniture that is far from a place, in another room, and no destination of the task."""
        ends = [kind for job in self.briefing.todo for kind in job.destinations]
        far = [
            one
            for one in self.house.things
            if one.kind in catalog.RECEPTACLES
            and one.kind not in ends
            and one.room != room
            and math.dist(one.centre[:2], place[:2]) >= _APART_M
        ]
        return far[seeds.choice([1.0] * len(far), _ROOT, self.key, "place", self.said)]


def truths(key: str) -> tuple[bool, ...]:
    """Which of a trial's messages are true; ``key`` is the house and the instruction."""
    found: list[bool] = []
    for number in range(MOST):
        drawn = seeds.draw(_ROOT, key, "true", number) < 0.5
        alike = len(found) > 1 and found[-1] == found[-2]
        found.append(not found[-1] if alike else drawn)
    return tuple(found)
