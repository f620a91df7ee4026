"""A person without doubts, mistakes or chance: the nearest unvisited option next, and every message is believed.

With `hthor.humans.models.random` it brackets what real people may do: who helps such a person is of use at all. It has
the mean body of its population and its own head:

- It notices what it looks for at once and for certain within `SIGHT_M`, and never beyond; furniture and doorways at
  once, wherever they are in view. It forgets nothing.
- It knows nothing of where things are kept: it goes to the nearest option, rooms not yet seen and pieces of furniture
  alike, and comes back to a piece only when it has searched them all.
- It confirms every message as soon as it has read it, useful or not, and follows it.
- It misses nothing, does not get better with practice, and its trust stays where it was.

Everybody is this person: participants differ in their tasks only.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import msgspec

from hthor.humans.core.policy import Answer, Offer, Situation
from hthor.humans.memory.object_memory import Known
from hthor.humans.models import proxy
from hthor.humans.perception.detection_rate import Head
from hthor.humans.perception.perception import Eyes
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import Person
from hthor.types import Detection

SIGHT_M = 3.0
_VISITED = 0.5
_PLAIN: dict[str, float] = {
    **dict.fromkeys(("stop_every", "tau_mem", "tau_seen"), math.inf),  # no stops to look, no forgetting
    **dict.fromkeys(("lam0", "manip_sd", "p_fail", "read_sd", "p_slip", "p_ignore", "tour_sd", "tour_forget"), 0.0),
    **dict.fromkeys(("w_s", "w_f", "sd_report", "sigma", "learn", "w_prior"), 0.0),
}


class Model(proxy.Model):
    """The greedy person.

    Args:
        person: whose traits are the population's mean; who it is makes no difference.
    """

    alike = True

    def __init__(self, person: Person, state: Mapping[str, Any] | None = None) -> None:
        super().__init__(Anybody(seed=0, participant=0, traits=plain(person.traits)), state)
        self.policy, self.eyes = Nearest(), SharpEyes


class Anybody(Person, frozen=True, kw_only=True):
    """A person to whom every trial brings the same chances."""

    def trial(self, index: int) -> int:  # noqa: ARG002  the same each time
        """Root of the chances of any trial."""
        return self.root


class Nearest:
    """Takes the nearest option that was not visited, and confirms everything."""

    def choose(self, situation: Situation) -> int:
        """The nearest; those that were visited come last."""
        options = situation.options
        return min(range(len(options)), key=lambda k: (options[k].exposure > _VISITED, options[k].metres, k))

    def answer(self, offer: Offer) -> Answer:  # noqa: ARG002  whatever it says
        """Yes."""
        return "confirm"


class SharpEyes(Eyes):
    """Notices for certain within `SIGHT_M`, and nothing beyond."""

    def _notices(self, known: Known, seen: Detection, head: Head, seconds: float) -> bool:  # noqa: ARG002
        return seen.distance <= SIGHT_M

    def _gather(self, name: str, amount: float, again: int) -> bool:  # noqa: ARG002
        return True


def plain(traits: Parameters) -> Parameters:
    """The same body without chance, doubt, forgetting or practice."""
    return msgspec.structs.replace(traits, **_PLAIN)
