"""A human without doubts, mistakes or chance: the nearest unvisited option next, and every message is believed.

With `hthor.humans.models.random` it brackets what real people may do: a robot that does not help it is useless.
It has the mean body of its population, and differs from the proxy in that it

- notices what it looks for at once and for certain within `SIGHT_M`, never beyond, and furniture and doorways at once
  wherever they are in view; it forgets nothing;
- has no common knowledge: it goes to the nearest option, be it an unseen room or furniture, and returns to a piece of
  furniture only when it has searched them all;
- accepts every message as soon as it is read, useful or not, and follows it;
- never misses with its hands, does not get better with practice, and keeps its trust.

All participants are this human; they differ in their tasks only.
"""

import math
from collections.abc import Mapping
from typing import Any

import msgspec

from hthor.humans.core.policy import Answer, Offer, Situation
from hthor.humans.memory.object_memory import KnownObject
from hthor.humans.models import proxy
from hthor.humans.perception.detection_rate import Head
from hthor.humans.perception.perception import Eyes
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import Participant
from hthor.types import Detection

SIGHT_M = 3.0
"""[m] Distance within which the greedy human notices objects for certain. Our choice."""
_VISITED = 0.5
"""[exposure] Least exposure of a place that counts as visited. Our choice."""
_NOISELESS: dict[str, float] = {
    **dict.fromkeys(("stop_every", "tau_mem", "tau_seen"), math.inf),  # no stops to look, no forgetting
    **dict.fromkeys(("lam0", "manip_sd", "p_fail", "read_sd", "p_slip", "p_ignore", "tour_sd", "tour_forget"), 0.0),
    **dict.fromkeys(("w_s", "w_f", "sd_report", "sigma", "learn", "w_prior"), 0.0),
}


class Model(proxy.Model):
    """The greedy human, with the population's mean traits; the participant's seed and number make no difference."""

    alike = True

    def __init__(self, participant: Participant, state: Mapping[str, Any] | None = None) -> None:
        super().__init__(SameParticipant(seed=0, number=0, traits=without_noise(participant.traits)), state)
        self.policy, self.eyes = NearestFirst(), CertainEyes


class SameParticipant(Participant, frozen=True, kw_only=True):
    """A participant with the same random numbers in every trial."""

    def trial_root(self, index: int) -> int:  # noqa: ARG002  the same each time
        """Root of the random numbers of any trial."""
        return self.root


class NearestFirst:
    """Takes the nearest option that was not visited, and accepts everything."""

    def choose(self, situation: Situation) -> int:
        """The nearest option; visited options come last."""
        options = situation.options
        return min(range(len(options)), key=lambda k: (options[k].exposure > _VISITED, options[k].metres, k))

    def answer(self, offer: Offer) -> Answer:  # noqa: ARG002  always the same
        """Accept every message."""
        return "accept"


class CertainEyes(Eyes):
    """Notices for certain within `SIGHT_M`, and nothing beyond."""

    def _notices(self, known: KnownObject, seen: Detection, head: Head, seconds: float) -> bool:  # noqa: ARG002
        return seen.distance <= SIGHT_M

    def _gather(self, name: str, amount: float, again: int) -> bool:  # noqa: ARG002
        return True


def without_noise(traits: Parameters) -> Parameters:
    """The same body without chance, doubt, forgetting or practice."""
    return msgspec.structs.replace(traits, **_NOISELESS)
