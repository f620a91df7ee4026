"""A robot's answers to people's questions about things."""

import re
from collections.abc import Callable, Collection

from hthor import catalog
from hthor.agents.skills.conversation.sightings import Sightings
from hthor.agents.skills.message_timing import kind_title, place_phrase
from hthor.agents.skills.task_allocation import seat_order
from hthor.types import Briefing, Message, Observation, Send, ThingState, is_person


class Answers:
    """Answers each question once and at once: with the place of what it asks for, or that the robot has not seen it.

    While the task has things of the kind in question that are not where they belong yet, it is about these. If all
    robots are asked and one does not know, it leaves the answer to the others, unless its seat is the first.

    Args:
        unfinished: the objects of the task that are not where they belong yet, as far as the robot knows.
    """

    def __init__(self, briefing: Briefing, sightings: Sightings, unfinished: Callable[[], Collection[str]]) -> None:
        self.seat, self.sightings, self.unfinished = briefing.seat, sightings, unfinished
        robots = [seat for seat in (briefing.seat, *briefing.teammates) if not is_person(seat)]
        self._speaks_for_all = min(robots, key=seat_order, default=briefing.seat) == briefing.seat
        self._left: set[int] = set()

    def due(self, observation: Observation) -> Send | None:
        """The answer to the oldest open question, None if there is none to answer."""
        for question in observation.inbox:
            if question.question and question.id not in self._left:
                answer = self._answer(question, observation)
                if answer is not None:
                    return answer
                self._left.add(question.id)
        return None

    def _answer(self, question: Message, observation: Observation) -> Send | None:
        name = question.object or named_kind(question.text)
        known = self._meant(name, observation)
        if known is not None:
            text, position = self._told(known, question.sender, observation), known.position
            return Send(text=text, object=known.id, position=position, to=question.sender, answers=question.id)
        if question.to == "" and not self._speaks_for_all:
            return None
        text = f"I have not seen {kind_title(kind_of(name))} yet." if name else "I do not know."
        return Send(text=text, object=name, to=question.sender, answers=question.id)

    def _meant(self, name: str, observation: Observation) -> ThingState | None:
        """The thing that a question means, if it is known; rather one that nobody holds."""
        known = self.sightings.named(name, observation) if name else []
        wanted = [target for target in self.unfinished() if name in (target, kind_of(target))]
        if wanted:
            known = [state for state in known if state.id in wanted]
        return next((state for state in known if not state.held_by), known[0] if known else None)

    def _told(self, known: ThingState, asker: str, observation: Observation) -> str:
        """Where a known thing is, in words."""
        title = kind_title(known.kind)
        if known.held_by:
            return f"{self._holder(known.held_by, asker)} {title}."
        in_view = any(seen.id == known.id for seen in observation.detections)
        kind = self.sightings.kind(known.support)
        if kind:
            return f"I {'found' if in_view else 'saw'} {title} {place_phrase(kind)}{' in front of me' * in_view}."
        return f"I {'found' if in_view else 'saw'} {title} {'in front of me' if in_view else 'here'}."

    def _holder(self, seat: str, asker: str) -> str:
        if seat in (self.seat, asker):
            return "I have" if seat == self.seat else "You have"
        return f"Another {'person' if is_person(seat) else 'robot'} has"


def kind_of(name: str) -> str:
    """The kind of a thing that was never seen, by its name: "apple_2" is an apple."""
    return re.sub(r"_\d+$", "", name)


def named_kind(text: str) -> str:
    """The kind of thing that a text names, the longest name if it names several; empty if it names none."""
    words = f" {' '.join(re.findall(r'[a-z]+', text.lower()))} "
    named = [kind for kind in catalog.names() if f" {kind.replace('_', ' ')} " in words]
    return max(named, key=len, default="")
