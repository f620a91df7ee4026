"""A human whose decisions a language model makes: what to search next, what to answer to messages.

    HTHOR_LLM_URL=https://HOST/v1/chat/completions HTHOR_LLM_MODEL=NAME \
        hthor eval --agent frontier --suite paper --humans examples/llm_person.py

Any OpenAI-compatible chat endpoint will do; HTHOR_LLM_KEY is sent as its bearer token. HTHOR_LLM_URL=stub is a rule
that needs no model. Answers are kept in llm_answers.jsonl (HTHOR_LLM_CACHE names another file): a second run takes them
from there and gives the same bytes.

A language model is a plug-in under test here, not the truth about people. Language models that simulate users are known
to be too easy to help; see what `hthor humans validate examples/llm_person.py` says before you believe it.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from hthor.humans.llm import backends
from hthor.humans.models import proxy
from hthor.humans.population.participant import Participant
from hthor.types import HUMAN, Briefing
from hthor.types.events import JournalEntry, Note


class Model(proxy.Model):
    """The proxy with a language model as its policy."""

    def __init__(self, participant: Participant, state: Mapping[str, Any] | None = None) -> None:
        super().__init__(participant, state)
        self.policy = self.speaker = backends.make_policy(participant, backends.settings())

    def begin(self, briefing: Briefing) -> None:
        """Start a trial, counting questions again."""
        self.speaker.questions = self.speaker.fallbacks = 0
        super().begin(briefing)

    @property
    def journal(self) -> Sequence[JournalEntry]:
        """The proxy's journal, and how often the model was asked and could not be understood."""
        asked = {"questions": self.speaker.questions, "fallbacks": self.speaker.fallbacks}
        return (*super().journal, Note(tick=0, seat=HUMAN, topic="language_model", values=asked))


def ingredients(source: str = "") -> dict[str, Any]:  # noqa: ARG001  there is none
    """What else decides how this model behaves: which language model it is."""
    return {"language_model": backends.model_name(backends.settings())}
