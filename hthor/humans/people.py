"""Whom a trial's person comes from: a human model and the population that it draws people of, found by name.

Knows nothing of trials.
"""

from __future__ import annotations

from typing import Any

from msgspec import Struct

from hthor import jsonio, plugins
from hthor.humans import effects, person
from hthor.humans.parameters import Parameters
from hthor.humans.person import Person


class People(Struct, frozen=True, kw_only=True):
    """People of one sort: ``model`` is the human model's name or file; ``sha256`` hashes all that makes them."""

    name: str
    model: str
    sha256: str

    def person(self, seed: int, participant: int) -> Person:
        """Participant number ``participant`` of the study with this seed; the robots have no part in who that is."""
        traits = effects.individual(Parameters(), person.root(seed, participant))
        return Person(seed=seed, participant=participant, traits=traits)

    def make(self, seed: int, participant: int) -> Any:
        """The human model of that person, before their first trial."""
        return plugins.load("human model", self.model)(self.person(seed, participant))


def find(name: str) -> People:
    """The people that a name stands for.

    Raises:
        UnknownName: when there are none.
    """
    plugins.load("human model", name)
    return People(name=name, model=name, sha256=jsonio.sha256({"model": name, "parameters": Parameters()}))
