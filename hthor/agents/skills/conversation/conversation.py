"""A robot's part in talking with people, around a policy that only makes suggestions.

    heard = conversation.hear(observation)
    action = conversation.speak(heard, policy.act(heard))

The policy gets no questions: the receipt in its observation is that of its own last suggestion.
"""

from collections.abc import Callable, Collection
from typing import Literal

import msgspec

from hthor.agents.skills.conversation.answers import Answers, kind_of
from hthor.agents.skills.conversation.queries import Queries
from hthor.agents.skills.conversation.sightings import Sightings
from hthor.types import Action, Briefing, Observation, Receipt, Send

_OPEN = ("sent", "shown")
_Sort = Literal["suggestion", "answer", "question"]


class Conversation:
    """Answers people's questions, and may ask what became of the policy's suggestions.

    Args:
        unfinished: the objects of the task that are not where they belong yet, as far as the policy knows.
        asks: whether the robot asks questions of its own.
    """

    def __init__(self, briefing: Briefing, unfinished: Callable[[], Collection[str]], asks: bool = False) -> None:
        self.unfinished = unfinished
        self.sightings = Sightings()
        self.answers = Answers(briefing, self.sightings, unfinished)
        self.queries = Queries(briefing) if asks else None
        self._said: _Sort = "suggestion"
        self._last: _Sort = "suggestion"  # the sort of the last message that there was a receipt of, and its number
        self._number = -1
        self._suggestion: Send | None = None  # the policy's last one, and what became of it
        self._receipt: Receipt | None = None

    def hear(self, observation: Observation) -> Observation:
        """The observation for the policy."""
        self.sightings.note(observation)
        receipt = observation.receipt
        if receipt is None:
            return observation
        if receipt.message != self._number:
            self._number, self._last = receipt.message, self._said
        if self._last == "suggestion":
            self._receipt = receipt
            return observation
        if self._last == "question" and self.queries is not None and self._receipt is not None:
            self._receipt = self.queries.updated(self._receipt, receipt)
        return msgspec.structs.replace(observation, receipt=self._receipt)

    def speak(self, observation: Observation, action: Action) -> Action:
        """The action with what the robot says: an answer that is due, else the policy's suggestion, else a question."""
        if action.say is None and not observation.inbox and self.queries is None:
            return action
        suggestion = action.say if isinstance(action.say, Send) else None
        answer = self.answers.due(observation) if observation.inbox else None
        say: Send | None = None
        if answer is not None:
            say = self._answer(observation, answer, suggestion)
        elif suggestion is not None:
            say = self._suggestion = suggestion
            self._said = "suggestion"
            self.sightings.note_told(suggestion.object)
        elif self.queries is not None:
            say = self._ask(observation, self.queries)
        return action if say is action.say else msgspec.structs.replace(action, say=say)

    def _answer(self, observation: Observation, answer: Send, suggestion: Send | None) -> Send:
        """Give an answer; an answer about what the policy suggests stands for the suggestion.

        Another suggestion of this moment is left out, as if the answer had covered it.
        """
        about = suggestion or self._suggestion
        if about is not None and answer.position is not None and answer.object == about.object:
            text = answer.text if suggestion is None else suggestion.text
            self._suggestion, self._said = msgspec.structs.replace(answer, text=text), "suggestion"
            return self._suggestion
        self._said = "answer"
        if suggestion is not None:
            self._suggestion = suggestion
            self._receipt = Receipt(message=-1, status="covered", tick=observation.tick, by=answer.to)
        else:
            self._cover(observation.tick, answer.to)
        return answer

    def _ask(self, observation: Observation, queries: Queries) -> Send | None:
        """A question about the last suggestion, if that is the last thing that the robot said."""
        suggestion, receipt = self._suggestion, self._receipt
        if suggestion is None or receipt is None or not self._last == self._said == "suggestion":
            return None
        kind = self.sightings.kind(suggestion.object) or kind_of(suggestion.object)
        question = queries.due(observation.tick, suggestion, kind, receipt)
        if question is None or suggestion.object not in self.unfinished():
            return None
        if any(state.held_by for state in self.sightings.named(suggestion.object, observation)):
            return None
        self._said = "question"
        self._cover(observation.tick, question.to)
        return question

    def _cover(self, tick: int, reader: str) -> None:
        """Note that a message covers the suggestion, if it is open on this reader's panel."""
        if self._receipt is not None and self._receipt.status in _OPEN and self._receipt.by == reader:
            self._receipt = msgspec.structs.replace(self._receipt, status="covered", tick=tick)
