"""A human whose decisions were learnt from logs: what to search next, what to answer to messages.

    hthor eval --agent frontier --suite paper --humans examples/cloned_person.py

Two logits with a handful of weights each, in cloned_person.json beside this file; `examples/clone.py` learns them from
runs. Eyes, memory, legs, hands and reading times are the proxy's. All participants have the same policy, so differences
between their ways of deciding are lost.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec

from hthor import jsonio, seeds
from hthor.errors import HthorError
from hthor.humans.core.policy import Answer, Offer, OptionDescription, Situation
from hthor.humans.models import proxy
from hthor.humans.population.participant import Participant
from hthor.types import Briefing, events

WEIGHTS = Path(__file__).with_suffix(".json")
SCHEMA = "hthor.example.clone/1"
LEAST = 0.001  # a share of belief below which it makes no difference


class Model(proxy.Model):
    """The proxy with a cloned policy."""

    def __init__(self, participant: Participant, state: Mapping[str, Any] | None = None) -> None:
        super().__init__(participant, state)
        self._weights = load()

    def begin(self, briefing: Briefing) -> None:
        """Start a trial with random numbers of its own."""
        self.policy = Clone(self._weights, seeds.derive(self.participant.trial_root(self.trials), "clone"))
        super().begin(briefing)


class Clone:
    """Decides by the weights; random numbers are drawn by name, so that a message changes no others."""

    def __init__(self, weights: Mapping[str, Any], root: int) -> None:
        self.weights, self.root = weights, root

    def choose(self, situation: Situation) -> int:
        """A conditional logit over the options."""
        weights = self.weights["choice"]
        best, most = 0, -math.inf
        for number, option in enumerate(situation.options):
            luck = seeds.draw(self.root, situation.aim, situation.number, option.name)
            utility = dot(weights, features(row(option))) - math.log(-math.log(luck))
            best, most = (number, utility) if utility > most else (best, most)
        return best

    def answer(self, offer: Offer) -> Answer:
        """A logit of accepting; what is not accepted is left alone as often as in the logs."""
        chance = logistic(dot(self.weights["answer"], reasons(offer)))
        if seeds.draw(self.root, "accept", offer.number) < chance:
            return "accept"
        return "ignore" if seeds.draw(self.root, "ignore", offer.number) < self.weights["ignored"] else "decline"


def row(option: OptionDescription) -> list[float]:
    """An option as the journal's "choice" has it: `hthor.humans.search.option_description.FEATURES`."""
    is_door = option.verb == "pass"
    return [option.knowledge, option.uniform, option.metres, option.exposure, float(option.closed), float(is_door)]


def features(option: Sequence[float]) -> list[float]:
    """What the choice may depend on, of one row of the journal."""
    knowledge, uniform, metres, exposure, closed, is_door = option
    return [
        math.log(knowledge + LEAST),
        math.log(uniform + LEAST),
        math.log1p(metres),
        min(exposure, 5.0),
        closed,
        is_door,
    ]


def reasons(offer: Offer | events.Offer) -> list[float]:
    """What an answer may depend on, of an offer or of its record in the journal; a live person's trust is not known."""
    trust = 0.5 if offer.trust is msgspec.UNSET else offer.trust
    return [1.0, float(offer.useful), trust - 0.5, math.log1p(offer.gain), offer.load, min(offer.again, 3.0)]


def dot(weights: Sequence[float], values: Sequence[float]) -> float:
    """Their scalar product."""
    return sum(weight * value for weight, value in zip(weights, values, strict=True))


def logistic(logit: float) -> float:
    """The chance that a logit stands for."""
    return 1.0 / (1.0 + math.exp(-logit)) if logit > -700.0 else 0.0


def load(path: Path = WEIGHTS) -> dict[str, Any]:
    """The weights; says how to learn them when there are none."""
    try:
        found: dict[str, Any] = msgspec.json.decode(path.read_bytes())
    except OSError:
        raise HthorError(f"{path} is not there. Learn it from runs: python examples/clone.py RUN ...") from None
    if found.get("schema") != SCHEMA:
        raise HthorError(f"{path} is of schema {found.get('schema')}, not {SCHEMA}. Learn it again: examples/clone.py.")
    return found


def ingredients(source: str = "") -> dict[str, Any]:  # noqa: ARG001  there is none
    """What else decides how this model behaves: the weights."""
    weights = load()
    return {"weights_sha256": jsonio.sha256({name: weights[name] for name in ("choice", "answer", "ignored")})}
