"""One participant: the roots of their random numbers, how they differ from the mean, and what practice changes."""

import math
from collections.abc import Iterable
from typing import Protocol

import msgspec
from msgspec import Struct

from hthor import seeds
from hthor.humans.population.parameter_registry import PARAMETERS
from hthor.humans.population.parameters import Parameters

_LEAST_SHARE = 1e-3
"""[share] Least distance of shares from 0 and 1, where their logit has no value. Our choice."""


class Participant(Struct, frozen=True, kw_only=True):
    """Participant ``number`` of the study with this ``seed``, with these ``traits``.

    The same seed and number from the same population are the same participant, whichever robots they meet.
    """

    seed: int
    number: int
    traits: Parameters = Parameters()

    @property
    def root(self) -> int:
        """Root of all random numbers of this participant; never depends on the robots."""
        return participant_root(self.seed, self.number)

    def trial_root(self, index: int) -> int:
        """Root of the random numbers of trial ``index``, from 0."""
        return seeds.derive(self.root, "trial", index)


def participant_root(seed: int, number: int) -> int:
    """Root of all random numbers of participant ``number`` of a study."""
    return seeds.derive(seed, "participant", number)


class RandomEffect(Protocol):
    """Spread between participants in one parameter, as in `hthor.humans.population.parameter_registry.Parameter`."""

    @property
    def name(self) -> str: ...
    @property
    def effect(self) -> float: ...
    @property
    def scale(self) -> str: ...


def add_random_effects(population: Parameters, root: int, effects: Iterable[RandomEffect] = PARAMETERS) -> Parameters:
    """The population's parameters with the random effects of the participant with this ``root``."""
    own: dict[str, float] = {}
    for parameter in effects:
        if parameter.effect:
            off = population.sigma * parameter.effect * seeds.normal(root, "effect", parameter.name)
            own[parameter.name] = _moved(getattr(population, parameter.name), off, parameter.scale)
    return msgspec.structs.replace(population, **own)


def with_practice(traits: Parameters, index: int) -> Parameters:
    """The same participant in trial number ``index``, from 0: pace, handling and dwelling get quicker with practice.

    The stick, the controllers and the search are new to people; turning and reading are not, and stay the same.
    """
    lift = 1.0 + traits.learn * (1.0 - math.exp(-index / traits.n_learn))
    return msgspec.structs.replace(
        traits, v_pace=traits.v_pace * lift, t_dwell=traits.t_dwell / lift, t_manip=traits.t_manip / lift
    )


def _moved(value: float, off: float, scale: str) -> float:
    if scale == "log":
        return value * math.exp(off)
    if scale == "logit":
        share = min(max(value, _LEAST_SHARE), 1.0 - _LEAST_SHARE)
        return 1.0 / (1.0 + math.exp(-math.log(share / (1.0 - share)) - off))
    return value + off
