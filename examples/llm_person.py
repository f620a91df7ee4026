"""A person whose decisions a language model makes: what to search next, what to say to messages.

    HTHOR_LLM_URL=https://HOST/v1/chat/completions HTHOR_LLM_MODEL=NAME \
        hthor eval --agent frontier --suite paper --humans examples/llm_person.py

Any OpenAI-compatible chat endpoint will do; HTHOR_LLM_KEY is sent as its bearer token. HTHOR_LLM_URL=stub stands for a
rule that needs no model. Answers are kept in llm_answers.jsonl (HTHOR_LLM_CACHE names another file): a second run takes
them from there, asks nobody, and gives the same bytes.

A language model is a plug-in under test here, not the truth about people. Simulated users that language models play are
known to be too easy to help; see what `hthor humans validate examples/llm_person.py` says before you believe it.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from hthor.humans.llm import backends
from hthor.humans.models import proxy
from hthor.humans.population.participant import Participant
from hthor.types import HUMAN, Briefing, Event


class Model(proxy.Model):
    """The proxy's eyes, memory, legs and hands, with a language model for a head."""

    def __init__(self, person: Participant, state: Mapping[str, Any] | None = None) -> None:
        super().__init__(person, state)
        self.policy = self.head = backends.make_policy(person, backends.settings())

    def begin(self, briefing: Briefing) -> None:
        """A trial begins."""
        self.head.questions = self.head.fallbacks = 0
        super().begin(briefing)

    @property
    def journal(self) -> Sequence[Event]:
        """What the recorder holds, and how often the model was asked and could not be understood."""
        asked = {"questions": self.head.questions, "fallbacks": self.head.fallbacks}
        return (*super().journal, Event(tick=0, seat=HUMAN, kind="language_model", data=asked))


def ingredients(source: str = "") -> dict[str, Any]:  # noqa: ARG001  there is none
    """What decides how these people behave, besides this file and hthor itself: which model it is."""
    return {"language_model": backends.model_name(backends.settings())}
