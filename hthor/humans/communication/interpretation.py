"""What a robot's message means to the person, and what of it they still mean to follow.

A message names an object, or something to look into, or where to bring what is in hand.
"""

from __future__ import annotations

import math

from msgspec import Struct

from hthor.humans.core.trial_context import Subject
from hthor.humans.memory.location_priors import holders
from hthor.humans.memory.spatial_memory import Memory, Place
from hthor.humans.memory.subgoals import Duties, Duty, kind_of
from hthor.types import Message, Vec3

_SAME_M = 1.0


class Claim(Struct, frozen=True, kw_only=True):
    """What message number ``number`` says: that what matters is at ``position`` [m], None when it does not say where.

    It is about the object of ``duty``; without one, ``errand`` tells whether it is something to look into ("look") or
    where to bring what is held ("bring").
    """

    number: int
    position: Vec3 | None
    duty: Duty | None = None
    errand: str = ""

    @property
    def subject(self) -> str:
        """What it is about, in a word: a later claim about the same replaces it."""
        return self.duty.target if self.duty is not None else f"{self.errand} {self.position}"


class Claims:
    """Understands messages, and keeps those that were confirmed until they were followed. ``news`` counts changes."""

    def __init__(self, me: Subject, memory: Memory, duties: Duties) -> None:
        self.me, self.memory, self.duties = me, memory, duties
        self.kept: dict[str, Claim] = {}
        self.news = 0

    def meaning(self, message: Message) -> Claim | None:
        """What use a message still is, None when it is none."""
        held = self.duties.all.get(self.me.now.holding)
        about = message.object
        if self.me.now.holding and (not self.duties.many or (held is not None and self._names_home(held, about))):
            if held is None or not self._names_home(held, about) or self.duties.knows(held):
                return None
            return Claim(number=message.id, position=message.position, errand="bring")
        duty = self._meant(about, message.position)
        if duty is not None:
            return Claim(number=message.id, position=message.position, duty=duty)
        return self._look(message) if self.duties.many else None

    def concerns(self, message: Message) -> bool:
        """Whether a message is about anything that there is to do, even if the person knows it already.

        What is said of the thing in hand, and where it was, is out of date. Words that name nothing are about nothing:
        a place without a name matters only while something is missing, which `meaning` judges.
        """
        about, held = message.object, self.me.now.holding
        if not about:
            return False
        named = (duty for duty in self.duties.all.values() if duty.target != held)
        if any(about in (duty.target, duty.kind) for duty in named):
            return True
        if any(self._names_home(duty, about) for duty in self.duties.all.values()):
            return True
        return self.duties.many and kind_of(about) in holders()

    @property
    def lead(self) -> Vec3 | None:
        """Where a robot says that what is held may be put [m]."""
        leads = [claim.position for claim in self.kept.values() if claim.errand == "bring"]
        return leads[-1] if leads else None

    def believe(self, claim: Claim) -> None:
        """Mean to follow what a robot said, or be content that something is done."""
        position, duty = claim.position, claim.duty
        if position is None:
            return
        self.news += 1
        place = self.memory.at(position)
        if duty is not None and self.duties.many and self.duties.at_home(duty, position, place.id if place else ""):
            duty.done = "told"
            return
        self.kept[claim.subject] = claim

    def drop(self, claim: Claim) -> None:
        """The claim was followed, or is of no use any more."""
        if self.kept.pop(claim.subject, None) is not None:
            self.news += 1

    def forget(self, duty: Duty) -> None:
        """Of this object the person now knows themselves; and where to bring the last one matters no more."""
        for claim in tuple(self.kept.values()):
            if claim.duty is duty or claim.errand == "bring":
                self.drop(claim)

    def _names_home(self, duty: Duty, about: str) -> bool:
        return any(about.startswith(home) for home in duty.job.destinations)

    def _meant(self, about: str, position: Vec3 | None) -> Duty | None:
        """The job that a name is about: of an object that the person does not know of, the first of its kind."""
        if not about and position is None:
            return None
        missing = [duty for duty in self.duties.open() if duty.known.lies is None]
        if position is not None and self.duties.many and self._is_known(about, position):
            return None
        for duty in missing:
            if about == duty.target:
                return duty
        if not self.duties.many:
            return missing[0] if missing and not about else None
        told = [duty for duty in missing if not about or about == duty.kind]
        return next((duty for duty in told if duty.target not in self.kept), told[0] if told else self._help(about))

    def _help(self, about: str) -> Duty | None:
        """A job for several hands that the robot speaks of, though the person knows of the thing."""
        return next(
            (duty for duty in self.duties.open() if duty.job.hands > 1 and about in (duty.target, duty.kind)), None
        )

    def _is_known(self, about: str, position: Vec3) -> bool:
        """Whether the person has seen an object of this kind just there."""
        return any(
            duty.known.lies is not None and math.dist(duty.known.lies.position, position) < _SAME_M
            for duty in self.duties.all.values()
            if about in ("", duty.kind) and duty.job.hands == 1
        )

    def _look(self, message: Message) -> Claim | None:
        """A wish that the person look into or at a piece of furniture, while anything is missing."""
        if all(duty.known.lies is not None for duty in self.duties.open()):
            return None
        if kind_of(message.object) not in holders():
            return None
        place = self._named(message)
        if place is None and message.position is None:
            return None
        if place is not None and place.state != "closed":
            return None
        position = message.position if place is None else place.centre
        return Claim(number=message.id, position=position, errand="look")

    def _named(self, message: Message) -> Place | None:
        """The place known that a message names by its id, or by its kind when it is the one at that position."""
        named = self.memory.places.get(message.object)
        if named is not None or message.position is None:
            alike = [place for place in self.memory.places.values() if place.kind == message.object]
            return named or (alike[0] if len(alike) == 1 else None)
        return self.memory.at(message.position)
