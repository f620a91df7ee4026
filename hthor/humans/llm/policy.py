"""A language model in a participant's place: it is asked what to do next and how to answer messages.

Eyes, memory, legs, hands and reading times remain those of the proxy; the time that the model takes to answer does not
count as simulated time. If an answer cannot be read, the question is repeated once; if that fails too, the participant
goes to the nearest option, or ignores the message.
"""

import fcntl
import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import msgspec
from msgspec import Struct

from hthor import documents, jsonio
from hthor.humans.core.policy import Answer, Offer, Situation
from hthor.humans.llm import prompts
from hthor.humans.population.participant import Participant

MAX_TOKENS = 16
"""[tokens] Greatest length of an answer. Our choice."""
_MAX_CHARACTERS = 200
"""[characters] Length to which an answer is cut. Our choice."""
_SEED_BITS = 31
"""[bits] Part of a participant's root that is the model's seed. Our choice."""
_COOLEST = 0.2
"""[temperature] Lowest temperature of a model. Our choice."""
_HOTTEST = 1.5
"""[temperature] Highest temperature of a model. Our choice."""
_T = TypeVar("_T")

Backend = Callable[[str], str]
"""A function that takes a question and returns an answer."""


class LanguageModelPolicy:
    """Choices and answers of a language model: a `hthor.humans.core.policy.Policy`.

    The traits are described to the model in words, and set its temperature and seed. The backend is asked only for
    answers that are not in the file of answers yet.
    """

    def __init__(self, participant: Participant, backend: Backend, cache: Path, model: str) -> None:
        self._who, self._backend = prompts.persona(participant.traits), backend
        self._answers = ResponseCache(
            cache, model=model, temperature=temperature(participant), seed=seed(participant), tokens=MAX_TOKENS
        )
        self.questions = self.fallbacks = 0

    def choose(self, situation: Situation) -> int:
        """The option that the model names; the nearest option if its answers cannot be read."""
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


class CachedResponse(Struct, frozen=True, kw_only=True):
    """One answer; ``key`` is the hash of everything that the answer depends on."""

    key: str
    model: str
    temperature: float
    seed: int
    tokens: int
    prompt: str
    answer: str


_decoder = msgspec.json.Decoder(CachedResponse)


class ResponseCache:
    """The answers of one model to one person, kept in a file so that no question is asked twice.

    One line of JSON per answer, append-only, safe for several processes at once; the key covers the model and its
    settings too. A run whose answers are all in the file needs no model and gives the same bytes again; publish the
    file with the run.
    """

    def __init__(self, path: Path, *, model: str, temperature: float, seed: int, tokens: int) -> None:
        self.path = path
        self._about = {"model": model, "temperature": temperature, "seed": seed, "tokens": tokens}
        self._known: dict[str, str] = {}
        self._read = 0

    def answer(self, prompt: str, ask: Callable[[str], str], most: int) -> str:
        """The answer from the file, or else from ``ask``, cut to ``most`` characters and added to the file."""
        key = jsonio.sha256({**self._about, "prompt": prompt})
        self._catch_up()
        if key not in self._known:
            self._keep(key, prompt, ask(prompt)[:most])
        return self._known[key]

    def _keep(self, key: str, prompt: str, answer: str) -> None:
        """Append an answer, unless another process was faster: the first one in the file counts."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        handle = os.open(self.path, os.O_RDWR | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC, 0o644)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX)
            self._catch_up()
            if key not in self._known:
                end = os.fstat(handle).st_size
                torn = end > 0 and os.pread(handle, 1, end - 1) != b"\n"
                line = msgspec.json.encode(CachedResponse(key=key, prompt=prompt, answer=answer, **self._about))  # type: ignore[arg-type]
                os.write(handle, (b"\n" if torn else b"") + line + b"\n")
                self._catch_up()
        finally:
            os.close(handle)

    def _catch_up(self) -> None:
        """Read the lines appended since the last reading; torn or damaged lines are skipped."""
        if not self.path.exists():
            return
        with self.path.open("rb") as file:
            file.seek(self._read)
            for line in file:
                if not line.endswith(b"\n"):
                    break
                self._read += len(line)
                try:
                    with documents.reading_errors():
                        asked = _decoder.decode(line)
                except documents.Unreadable:
                    continue
                self._known.setdefault(asked.key, asked.answer)
