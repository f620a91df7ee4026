"""What a robot's message means to the participant, and which accepted messages are still to be followed.

A message names an object, furniture to look into, or a destination for the object in hand.
"""

import math
from typing import Literal

from msgspec import Struct

from hthor.humans.core.trial_context import HumanContext
from hthor.humans.memory.location_priors import receptacle_kinds
from hthor.humans.memory.spatial_memory import KnownPlace, SpatialMemory
from hthor.humans.memory.subgoals import Subgoal, SubgoalTracker, object_kind
from hthor.types import WALKERS, Message, Vec3

_SAME_OBJECT_M = 1.0
"""[m] A position this near to a known object of the named kind means that object. Our choice."""


class Advice(Struct, frozen=True, kw_only=True):
    """The advice in message number ``number``: to go to ``position`` [m], None when the message names no place.

    It is about the object of ``subgoal``; without a subgoal, ``request`` says whether the position is furniture to look
    into ("look") or the destination of the object in hand ("bring").
    """

    number: int
    position: Vec3 | None
    subgoal: Subgoal | None = None
    request: Literal["", "look", "bring"] = ""

    @property
    def topic(self) -> str:
        """The subject of the advice; later advice on the same topic replaces it."""
        return self.subgoal.target if self.subgoal is not None else f"{self.request} {self.position}"


class AdviceTracker:
    """Interprets messages, and keeps accepted advice until it was followed. ``changes`` counts updates."""

    def __init__(self, human: HumanContext, memory: SpatialMemory, subgoals: SubgoalTracker) -> None:
        self.human, self.memory, self.subgoals = human, memory, subgoals
        self.kept: dict[str, Advice] = {}
        self.changes = 0

    def interpret(self, message: Message) -> Advice | None:
        """The advice in a message, None when the message is of no use any more."""
        in_hand = self.subgoals.all.get(self.human.now.holding)
        name = message.object
        if self.human.task.relation == "go":
            return self._way_to_end(message)
        names_home = in_hand is not None and self._names_destination(in_hand, name)
        if self.human.now.holding and (not self.subgoals.many or names_home):
            if in_hand is None or not names_home or self.subgoals.knows_destination(in_hand):
                return None
            return Advice(number=message.id, position=message.position, request="bring")
        subgoal = self._meant_subgoal(name, message.position)
        if subgoal is not None:
            return Advice(number=message.id, position=message.position, subgoal=subgoal)
        return self._look_request(message) if self.subgoals.many else None

    def _way_to_end(self, message: Message) -> Advice | None:
        """Where the landmark is that the participant has to go to."""
        (walk,) = self.subgoals.all.values()
        mine = WALKERS[walk.target] == self.human.seat
        if not mine or message.position is None or not self._names_destination(walk, message.object):
            return None
        if any(place.recalled and place.covers(message.position) for place in self.memory.places.values()):
            return None  # it is known already
        return Advice(number=message.id, position=message.position)

    def is_relevant(self, message: Message) -> bool:
        """Whether a message is about anything in the task, even if the participant knows that already.

        A message about the object in hand is out of date; `interpret` judges messages without an object's name.
        """
        name, holding = message.object, self.human.now.holding
        if not name:
            return False
        others = (subgoal for subgoal in self.subgoals.all.values() if subgoal.target != holding)
        if any(name in (subgoal.target, subgoal.kind) for subgoal in others):
            return True
        if any(self._names_destination(subgoal, name) for subgoal in self.subgoals.all.values()):
            return True
        return self.subgoals.many and object_kind(name) in receptacle_kinds()

    @property
    def destination(self) -> Advice | None:
        """The advice of a robot on where to bring the object in hand; it has a position."""
        if not self.kept:
            return None
        brought = [advice for advice in self.kept.values() if advice.request == "bring"]
        return brought[-1] if brought else None

    @property
    def followed(self) -> tuple[int, ...]:
        """The numbers of the messages whose advice is still to be followed."""
        return tuple(advice.number for advice in self.kept.values()) if self.kept else ()

    def accept(self, advice: Advice) -> None:
        """Keep advice to follow it, or believe that its subgoal is done."""
        position, subgoal = advice.position, advice.subgoal
        if position is None:
            return
        self.changes += 1
        if subgoal is not None and self.subgoals.many:
            place = self.memory.at(position)
            if self.subgoals.is_at_destination(subgoal, position, place.id if place else ""):
                subgoal.done = "told"
                return
        self.kept[advice.topic] = advice

    def drop(self, advice: Advice) -> None:
        """Discard advice that was followed or is of no more use."""
        if self.kept.pop(advice.topic, None) is not None:
            self.changes += 1

    def drop_about(self, subgoal: Subgoal) -> None:
        """Discard advice about an object that is now known, and about the destination of the previous object."""
        for advice in tuple(self.kept.values()):
            if advice.subgoal is subgoal or advice.request == "bring":
                self.drop(advice)

    def _names_destination(self, subgoal: Subgoal, name: str) -> bool:
        return any(name.startswith(home) for home in subgoal.job.destinations)

    def _meant_subgoal(self, name: str, position: Vec3 | None) -> Subgoal | None:
        """The subgoal that a message means: of the missing object with this id, else the first of its kind."""
        if not name and position is None:
            return None
        missing = [subgoal for subgoal in self.subgoals.unfinished() if subgoal.known.lies is None]
        if position is not None and self.subgoals.many and self._is_known(name, position):
            return None
        for subgoal in missing:
            if name == subgoal.target:
                return subgoal
        if not self.subgoals.many:
            return missing[0] if missing and not name else None
        meant = [subgoal for subgoal in missing if not name or name == subgoal.kind]
        return next(
            (subgoal for subgoal in meant if subgoal.target not in self.kept), meant[0] if meant else self._joint(name)
        )

    def _joint(self, name: str) -> Subgoal | None:
        """The unfinished subgoal of this name whose object takes several carriers, even if the object is known."""
        unfinished = self.subgoals.unfinished()
        return next((one for one in unfinished if one.job.hands > 1 and name in (one.target, one.kind)), None)

    def _is_known(self, name: str, position: Vec3) -> bool:
        """Whether an object of this kind was seen at this position."""
        return any(
            subgoal.known.lies is not None and math.dist(subgoal.known.lies.position, position) < _SAME_OBJECT_M
            for subgoal in self.subgoals.all.values()
            if name in ("", subgoal.kind) and subgoal.job.hands == 1
        )

    def _look_request(self, message: Message) -> Advice | None:
        """A request to search a piece of furniture, None when no object is missing."""
        if all(subgoal.known.lies is not None for subgoal in self.subgoals.unfinished()):
            return None
        if object_kind(message.object) not in receptacle_kinds():
            return None
        place = self._named_place(message)
        if place is None and message.position is None:
            return None
        if place is not None and place.state != "closed":
            return None
        position = message.position if place is None else place.centre
        return Advice(number=message.id, position=position, request="look")

    def _named_place(self, message: Message) -> KnownPlace | None:
        """The known place that a message means: by its id, by its kind if only one is known, else by its position."""
        named = self.memory.places.get(message.object)
        if named is not None or message.position is None:
            alike = [place for place in self.memory.places.values() if place.kind == message.object]
            return named or (alike[0] if len(alike) == 1 else None)
        return self.memory.at(message.position)
