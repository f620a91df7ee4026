"""A language model in a participant's place: it is asked what to do next and what to say to messages.

Eyes, memory, legs, hands and reading times stay the proxy's; the time that the model takes to answer is no part of the
simulated time. An answer that cannot be read is asked for once more; if that fails too, the participant goes to the
nearest option, or leaves the message alone.
"""

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from hthor.humans.core.policy import Answer, Offer, Situation
from hthor.humans.llm import prompts
from hthor.humans.llm.response_cache import ResponseCache
from hthor.humans.population.participant import Participant

MAX_TOKENS = 16
"""[tokens] Most of an answer. Our choice."""
_MAX_CHARACTERS = 200
"""[characters] Of an answer that are kept. Our choice."""
_SEED_BITS = 31
"""[bits] Of a participant's root that are the model's seed. Our choice."""
_COOLEST = 0.2
"""[temperature] Least of a model. Our choice."""
_HOTTEST = 1.5
"""[temperature] Greatest of a model. Our choice."""
_T = TypeVar("_T")

Backend = Callable[[str], str]
"""Takes a question, gives an answer."""


class LanguageModelPolicy:
    """Choices and answers of a language model: a `hthor.humans.core.policy.Policy`.

    Args:
        participant: the traits are given to the model in words, and set its temperature and seed.
        backend: asks the model; called only for what the cache does not hold.
        cache: the file of answers.
        model: the model's name, for the cache.
    """

    def __init__(self, participant: Participant, backend: Backend, cache: Path, model: str) -> None:
        self._who, self._backend = prompts.persona(participant.traits), backend
        self._answers = ResponseCache(
            cache, model=model, temperature=temperature(participant), seed=seed(participant), tokens=MAX_TOKENS
        )
        self.questions = self.fallbacks = 0

    def choose(self, situation: Situation) -> int:
        """The option that the model names; the nearest if its answers cannot be read."""
        question = prompts.choice_question(self._who, situation)
        result = self._ask(question, lambda reply: prompts.read_choice(reply, situation))
        options = situation.options
        return min(range(len(options)), key=lambda k: (options[k].metres, k)) if result is None else result

    def answer(self, offer: Offer) -> Answer:
        """The model's answer; "ignore" if its answers cannot be read."""
        result: Answer | None = self._ask(prompts.offer_question(self._who, offer), prompts.read_answer)
        return result or "ignore"

    def _ask(self, question: str, read: Callable[[str], _T | None]) -> _T | None:
        self.questions += 1
        reply = self._answers.answer(question, self._backend, _MAX_CHARACTERS)
        result = read(reply)
        if result is None:
            reply = self._answers.answer(
                prompts.repeated_question(question, reply, _MAX_CHARACTERS), self._backend, _MAX_CHARACTERS
            )
            result = read(reply)
        self.fallbacks += result is None
        return result


def temperature(participant: Participant) -> float:
    """Temperature of the model: the inverse of the Luce exponent, within the models' range."""
    return round(min(_HOTTEST, max(_COOLEST, 1.0 / participant.traits.beta)), 1)


def seed(participant: Participant) -> int:
    """The participant's own seed for the model, so that equal questions may get different answers."""
    return participant.root % (1 << _SEED_BITS)
