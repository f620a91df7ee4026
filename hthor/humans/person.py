"""One person of a population: who they are, and how they differ from the mean; knows nothing of trials' contents."""

from __future__ import annotations

import math

import msgspec
from msgspec import Struct

from hthor import seeds
from hthor.humans.parameters import Parameters

_HALF = ("v_pace",)
_LOG = ("lam0", "t_manip", "beta", "t_dwell")


class Person(Struct, frozen=True, kw_only=True):
    """Participant number ``participant`` of the study with this ``seed``: the same two numbers, the same person."""

    seed: int
    participant: int

    @property
    def root(self) -> int:
        """Root of everything that chance decides about this person; never depends on the robots."""
        return seeds.derive(self.seed, "participant", self.participant)

    def trial(self, index: int) -> int:
        """Root of the chances of this person's trial number ``index``."""
        return seeds.derive(self.root, "trial", index)

    def traits(self, population: Parameters) -> Parameters:
        """The population's parameters with this person's random effects."""
        sigma = population.sigma

        def effect(name: str) -> float:
            return sigma * seeds.normal(self.root, "effect", name)

        own = {name: getattr(population, name) * math.exp(0.5 * effect(name)) for name in _HALF}
        own |= {name: getattr(population, name) * math.exp(effect(name)) for name in _LOG}
        own["a0"] = population.a0 + 2.0 * effect("a0")
        logit = math.log(population.mu0 / (1.0 - population.mu0)) + 2.0 * effect("mu0")
        own["mu0"] = 1.0 / (1.0 + math.exp(-logit))
        return msgspec.structs.replace(population, **own)


def practised(traits: Parameters, index: int) -> Parameters:
    """The same person in their trial number ``index``, from 0: brisker with practice."""
    lift = 1.0 + traits.learn * (1.0 - math.exp(-index / traits.n_learn))
    return msgspec.structs.replace(
        traits, v_pace=traits.v_pace * lift, t_dwell=traits.t_dwell / lift, t_manip=traits.t_manip / lift
    )
