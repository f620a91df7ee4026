"""A language model in a person's place: it is asked what to do next and what to say to messages.

Eyes, memory, legs and hands, reading times included, stay the proxy's; how long the model takes to answer is no
part of the simulated time. What it is asked stands in `hthor.humans.llm.prompts`, what it answered is kept by
`hthor.humans.llm.response_cache`. An answer that cannot be read is asked for once more; when that cannot be read
either, the person goes to the nearest option, or leaves the message alone. ``fallbacks`` counts how
often.humans.llm.backends`.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from hthor.humans.core.policy import Answer, Offer, Situation
from hthor.humans.llm import prompts
from hthor.humans.llm.response_cache import ResponseCache
from hthor.humans.population.participant import Participant

MAX_TOKENS = 16
"""Most tokens of an answer."""
_CHARACTERS = 200
_SEED_BITS = 31
_COOLEST, _HOTTEST = 0.2, 1.5
_T = TypeVar("_T")

Backend = Callable[[str], str]
"""Takes a question, gives an answer."""


class LanguageModelPolicy:
    """A person whose choices and answers a language model gives: a `hthor.humans.core.policy.Policy`.

    Args:
        person: whose traits are told to the model in words, and set its temperature and seed.
        backend: asks the model; called only for what the cache does not hold.
        cache: the file of answers.
        model: the model's name, for the cache.
    """

    def __init__(self, person: Participant, backend: Backend, cache: Path, model: str) -> None:
        self._who, self._backend = prompts.persona(person.traits), backend
        self._answers = ResponseCache(
            cache, model=model, temperature=temperature(person), seed=seed(person), tokens=MAX_TOKENS
        )
        self.questions = self.fallbacks = 0

    def choose(self, situation: Situation) -> int:
        """The option that the model names, else the nearest."""
        question = prompts.choice_question(self._who, situation)
        found = self._ask(question, lambda reply: prompts.read_choice(reply, situation))
        options = situation.options
        return min(range(len(options)), key=lambda k: (options[k].metres, k)) if found is None else found

    def answer(self, offer: Offer) -> Answer:
        """What the model says, else nothing."""
        found: Answer | None = self._ask(prompts.offer_question(self._who, offer), prompts.read_answer)
        return found or "ignore"

    def _ask(self, question: str, read: Callable[[str], _T | None]) -> _T | None:
        self.questions += 1
        reply = self._answers.of(question, self._backend, _CHARACTERS)
        found = read(reply)
        if found is None:
            reply = self._answers.of(
                prompts.repeated_question(question, reply, _CHARACTERS), self._backend, _CHARACTERS
            )
            found = read(reply)
        self.fallbacks += found is None
        return found


def temperature(person: Participant) -> float:
    """How much chance is in the model's answers: the inverse of the Luce exponent, which is a softmax's temperature."""
    return round(min(_HOTTEST, max(_COOLEST, 1.0 / person.traits.beta)), 1)


def seed(person: Participant) -> int:
    """The person's own seed for the model, so that two people who are asked the same may answer otherwise."""
    return person.root % (1 << _SEED_BITS)
