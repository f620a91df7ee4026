"""Truthful answers to questions, from what a participant did and believes.

Four questions are understood, by their words: where something is, whether it was found, whether it is somewhere, and
whether a suggestion was accepted. Any other question is left without an answer.
"""

import re

from hthor.humans.core.trial_context import HumanContext
from hthor.humans.memory.spatial_memory import KnownPlace, SpatialMemory
from hthor.humans.memory.subgoals import Subgoal, SubgoalTracker
from hthor.types import Message, Send

_PLACE_WORDS = frozenset({"where"})
_SUGGESTION_WORDS = frozenset({"accept", "accepted", "suggestion", "suggestions", "message"})
_FOUND_WORDS = frozenset({"find", "found", "have", "know", "see", "seen"})


class QuestionAnswering:
    """Answers questions; `note` is told what the participant did about each message."""

    def __init__(self, human: HumanContext, memory: SpatialMemory, subgoals: SubgoalTracker) -> None:
        self.human, self.memory, self.subgoals = human, memory, subgoals
        self._answered: list[tuple[Message, bool]] = []

    def note(self, message: Message, accepted: bool) -> None:
        """Remember the answer to a message that was no question."""
        self._answered.append((message, accepted))

    def answer(self, question: Message) -> bool | Send | None:
        """Yes or no, a message that tells a place, or None if the question is not understood.

        A participant who is asked for a place and does not know it says no.
        """
        words = frozenset(re.findall("[a-z]+", question.text.lower()))
        if words & _PLACE_WORDS:
            return self._place(question) or False
        if words & _SUGGESTION_WORDS:
            return self._has_accepted(question)
        if words & _FOUND_WORDS:
            return self._has_found(question)
        return self._is_there(question) if question.text.lower().startswith("is ") else None

    def _has_accepted(self, question: Message) -> bool:
        """Whether the latest message of the person or robot who asks, about the same thing, was accepted."""
        for message, accepted in reversed(self._answered):
            if message.sender == question.sender and question.object in ("", message.object):
                return accepted
        return False

    def _has_found(self, question: Message) -> bool:
        """Whether the object, or all objects if none is named, or a piece of furniture is known."""
        if not question.object:
            return all(map(self._is_known, self.subgoals.all.values()))
        asked = self._asked(question)
        return any(map(self._is_known, asked)) or (not asked and self._furniture(question) is not None)

    def _is_there(self, question: Message) -> bool | None:
        """Whether an object is at the furniture that a question names too; None if either is not known."""
        places = [place for place in self.memory.places.values() if _says(question, place.kind)]
        seen = next((subgoal.known.seen for subgoal in self._asked(question)), None)
        if seen is None or not places:
            return None
        return any(place.id == seen.support or place.covers(seen.position) for place in places)

    def _is_known(self, subgoal: Subgoal) -> bool:
        return bool(subgoal.done) or subgoal.known.seen is not None or self.human.now.holding == subgoal.target

    def _place(self, question: Message) -> Send | None:
        """A message that tells where the thing is, None if it is not known."""
        asked = self._asked(question)
        for subgoal in [one for one in asked if not one.done] or asked:  # who searches wants what is still to be done
            seen = subgoal.known.seen
            if seen is not None:
                return self._told(question, subgoal.target, seen.position, self._words(subgoal, seen.support))
        place = self._furniture(question)
        return (
            None if place is None else self._told(question, place.id, place.centre, f"{_title(place.kind)} is there.")
        )

    def _words(self, subgoal: Subgoal, support: str) -> str:
        if self.human.now.holding == subgoal.target:
            return f"I have {_title(subgoal.kind).lower()}."
        place = self.memory.places.get(support)
        return f"{_title(subgoal.kind)} is {'there' if place is None else f'at {_title(place.kind).lower()}'}."

    def _told(self, question: Message, name: str, position: tuple[float, float, float], text: str) -> Send:
        return Send(text=text, object=name, position=position, to=question.sender, answers=question.id)

    def _asked(self, question: Message) -> list[Subgoal]:
        """The jobs whose object a question names, by its id or kind, or in its words."""
        return [one for one in self.subgoals.all.values() if _names(question, one.target, one.kind)]

    def _furniture(self, question: Message) -> KnownPlace | None:
        """The remembered piece of furniture that a question names."""
        places = (place for place in self.memory.places.values() if place.recalled)
        return next((place for place in places if _names(question, place.id, place.kind)), None)


def _names(question: Message, id: str, kind: str) -> bool:
    return question.object in (id, kind) if question.object else _says(question, kind)


def _says(question: Message, kind: str) -> bool:
    """Whether the words of a question name this kind."""
    return f" {kind.replace('_', ' ')} " in f" {' '.join(re.findall('[a-z]+', question.text.lower()))} "


def _title(kind: str) -> str:
    return f"The {kind.replace('_', ' ')}"
