"""Kinds of people: a population with some parameters changed, one JSON file each.

A new file here is a new kind; a path to such a file works as well. The population's mean is changed, draw by draw; the
random effects between participants are added as before.
"""

from pathlib import Path
from typing import Literal

import msgspec
from msgspec import Struct

from hthor import documents
from hthor.errors import PopulationError, UnknownName
from hthor.humans.population import parameters
from hthor.humans.population.parameters import Parameters

SCHEMA = "hthor.people-kind/1"
FOLDER = Path(__file__).parent

Verb = Literal["add", "times", "set"]


class ParameterEdit(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A change of one parameter: ``value`` is added to it, multiplies it, or replaces it, within the range."""

    parameter: str
    verb: Verb
    value: float
    reason: str

    def apply(self, value: float) -> float:
        """The parameter's new value."""
        new = {"add": value + self.value, "times": value * self.value, "set": self.value}[self.verb]
        return parameters.clamp(self.parameter, new)


class PopulationKind(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A kind of people, changed from a population (``base``, or the default), and the reason to test robots with it."""

    schema: str = SCHEMA
    name: str
    purpose: str
    reason: str
    changes: tuple[ParameterEdit, ...]
    base: str = ""

    def change(self, population: Parameters) -> Parameters:
        """A population's parameters after the changes."""
        new = population
        for change in self.changes:
            value = change.apply(getattr(new, change.parameter))
            new = msgspec.structs.replace(new, **{change.parameter: value})
        return new

    @property
    def essence(self) -> list[tuple[str, str, float]]:
        """The changes without their reasons, for the hash."""
        return [(change.parameter, change.verb, change.value) for change in self.changes]


def names() -> tuple[str, ...]:
    """The kinds that ship with hthor."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.json")))


def load(name_or_path: str | Path) -> PopulationKind:
    """A kind by name, or from a file.

    Raises:
        UnknownName: when no kind has that name.
        PopulationError: when the file cannot be read, or changes an unknown parameter.
    """
    word = str(name_or_path)
    if word in names():
        return _read(FOLDER / f"{word}.json")
    if not word.endswith(".json"):
        raise UnknownName("kind of people", word, names(), "A path to a kind's file (.json) works too.")
    return _read(Path(word))


def _read(path: Path) -> PopulationKind:
    kind = documents.read(path, PopulationKind, PopulationError, schema=SCHEMA)
    if kind.name != path.stem:
        raise PopulationError(str(path), "name", f"it is '{kind.name}', but must be the file's name, '{path.stem}'")
    for number, change in enumerate(kind.changes):
        where = f"changes[{number}]"
        if change.parameter not in parameters.parameter_names():
            raise PopulationError(
                str(path),
                f"{where}.parameter",
                str(UnknownName("parameter", change.parameter, parameters.parameter_names())),
            )
        if change.verb == "set" and (problem := parameters.range_problem(change.parameter, change.value)):
            raise PopulationError(str(path), f"{where}.value", problem)
    return kind
