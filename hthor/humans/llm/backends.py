"""Where language models' answers come from: an endpoint over HTTP, or a rule that needs no model."""

import os
import re
import urllib.error
import urllib.request
from pathlib import Path
from urllib.parse import urlsplit

import msgspec
from msgspec import Struct

from hthor import documents
from hthor.errors import HthorError
from hthor.humans.llm import policy
from hthor.humans.population.participant import Participant

STUB = "stub"
"""The word that selects a rule instead of a language model."""
URL, MODEL, KEY, CACHE = "HTHOR_LLM_URL", "HTHOR_LLM_MODEL", "HTHOR_LLM_KEY", "HTHOR_LLM_CACHE"
"""Environment variables with the settings of the language model."""
_TIMEOUT_S = 120.0
"""[s] Longest wait for an answer of the endpoint. Our choice."""
_SHOWN = 200
"""[bytes] Length to which an endpoint's error message is cut. Our choice."""


class Settings(Struct, frozen=True, kw_only=True):
    """A language model: ``url`` of an OpenAI-compatible chat endpoint, or `STUB`; ``key`` is sent as a bearer token."""

    url: str = ""
    model: str = ""
    key: str = ""
    cache: str = "llm_answers.jsonl"

    @property
    def name(self) -> str:
        """The model's name in the cache and in hashes; it does not depend on where the model runs."""
        return STUB if self.url == STUB else self.model


def settings() -> Settings:
    """The settings in the environment variables."""
    given = {"url": URL, "model": MODEL, "key": KEY, "cache": CACHE}
    return Settings(**{field: os.environ[name] for field, name in given.items() if os.environ.get(name)})


def model_name(chosen: Settings) -> str:
    """The model's name.

    Raises:
        HthorError: when the settings do not name a model.
    """
    if not chosen.name:
        raise HthorError(
            f"no language model is named. Set {MODEL} to its name and {URL} to the address of an OpenAI-compatible "
            f"chat endpoint (https://HOST/v1/chat/completions), or {URL}={STUB} for a rule that needs no model. With "
            f"every answer in the cache ({CACHE}) the name alone will do."
        )
    return chosen.name


def make_policy(participant: Participant, chosen: Settings) -> policy.LanguageModelPolicy:
    """A policy that asks the language model in this participant's place.

    Raises:
        HthorError: when the settings do not name a model.
    """
    temperature, seed = policy.temperature(participant), policy.seed(participant)
    backend = answer_by_rule if chosen.url == STUB else Endpoint(chosen, temperature, seed)
    return policy.LanguageModelPolicy(participant, backend, Path(chosen.cache), model_name(chosen))


def answer_by_rule(question: str) -> str:
    """Answer by a rule instead of a model: choose the nearest option, and accept messages said to save time."""
    options = re.findall(r"^(\d+)\. (.*)$", question, re.MULTILINE)
    if not options:
        return "accept" if "would save you" in question else "decline"
    return str(
        min(options, key=lambda option: ("already searched" in option[1], _metres(option[1]), int(option[0])))[0]
    )


def _metres(text: str) -> int:
    match = re.search(r"(\d+) m away", text)
    return int(match[1]) if match else 0


class Endpoint:
    """An OpenAI-compatible chat endpoint."""

    def __init__(self, chosen: Settings, temperature: float, seed: int) -> None:
        self._chosen, self._temperature, self._seed = chosen, temperature, seed

    def __call__(self, question: str) -> str:
        """Send the question, and return the text of the reply's first choice.

        Raises:
            HthorError: when no answer came. The run can be continued by the same command.
        """
        url = self._chosen.url
        if urlsplit(url).scheme not in ("http", "https"):
            raise HthorError(
                f"a question is not in the cache {self._chosen.cache}, and {URL} is '{url}', no http address. Set it "
                f"to an OpenAI-compatible chat endpoint such as https://HOST/v1/chat/completions, or to {STUB}."
            )
        body = {
            "model": self._chosen.model,
            "messages": [{"role": "user", "content": question}],
            "temperature": self._temperature,
            "seed": self._seed,
            "max_tokens": policy.MAX_TOKENS,
        }
        headers = {"Content-Type": "application/json"}
        if self._chosen.key:
            headers["Authorization"] = f"Bearer {self._chosen.key}"
        request = urllib.request.Request(url, data=msgspec.json.encode(body), headers=headers)
        try:
            with urllib.request.urlopen(request, timeout=_TIMEOUT_S) as reply:
                return _text(reply.read())
        except urllib.error.HTTPError as error:
            text = error.read(_SHOWN).decode("utf-8", "replace")
            error.close()
            raise self._failed(f"HTTP {error.code}: {text}") from None
        except (OSError, ValueError) as error:  # an unreadable reply is a ValueError
            raise self._failed(str(error)) from None

    def _failed(self, why: str) -> HthorError:
        return HthorError(
            f"the language model at {urlsplit(self._chosen.url).netloc} gave no answer: {why}. Mend that and repeat "
            "the command; answers that came are in the cache."
        )


class _Said(Struct):
    content: str | None = None


class _Choice(Struct):
    message: _Said


class _Reply(Struct):
    choices: list[_Choice]


def _text(data: bytes) -> str:
    choices = documents.decode(data, _Reply).choices
    return (choices[0].message.content if choices else "") or ""
