"""Several peoples for one evaluation, and where each is known to fit."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from msgspec import Struct

from hthor import plugins, rules
from hthor.errors import HthorError, UnknownName
from hthor.eval.config.robot_team import RobotInfo, RobotTeam
from hthor.humans.population import kinds, parameter_registry, population_file, resolve
from hthor.humans.population.population import Validity
from hthor.humans.population.resolve import ParticipantSource
from hthor.tasks import Suite
from hthor.types import RobotSpec

KINDS, BRACKET = "kinds", "bracket"
"""Words for several peoples: the population and every kind of people; the population between two extremes."""
WORDS = (KINDS, BRACKET)
EXTREMES = ("greedy", "random")
"""Human models that no person is beyond: takes every offer, takes none."""


class HumanModelRef(Struct, frozen=True, kw_only=True):
    """Who the people of a run are.

    Attributes:
        name: what to call them; ``source`` what they were asked for by, paths cut to the file's name.
        model: the human model; ``kind``: what is changed in the population, empty for nothing.
        population: whom they are drawn from; ``population_sha256`` its hash. Empty where it is a log that makes them.
        sha256: hash of all that makes these people, the population included.
        valid: whether that population is used where it was calibrated; ``notes`` say what is different.
    """

    name: str
    source: str
    model: str
    kind: str
    population: str
    population_sha256: str
    sha256: str
    valid: bool
    notes: tuple[str, ...]


def find_populations(words: Sequence[str]) -> list[ParticipantSource]:
    """The peoples that the words of ``--humans`` stand for, each once.

    Raises:
        UnknownName: when a word stands for none.
        PeopleError: when a file of people cannot be used.
        HthorError: when two different peoples are called the same.
    """
    found: dict[str, ParticipantSource] = {}
    for word in dict.fromkeys(word for several in words for word in _expand_word(several)):
        one = _find(word)
        if one.sha256 in {other.sha256 for other in found.values()}:
            continue
        if one.name in found:
            raise HthorError(f"two different peoples are called '{one.name}'. Rename one of the files.")
        found[one.name] = one
    return list(found.values())


def robot_settings(body: str | RobotInfo, detector: str) -> dict[str, str | float]:
    """What of a robot bears on how people fare beside it, as a population's file keeps it.

    Args:
        body: the robot's name, or a user's own body.
        detector: as `hthor.types.detector_specs.canonical_name` spells it.
    """
    shape = RobotInfo(name=body) if isinstance(body, str) else body
    spec: RobotSpec = plugins.load("robot", shape.path or shape.name)
    return {
        "robot": shape.name,
        "speed_m_s": spec.speed,
        "turn_rate_rad_s": spec.turn_rate,
        "sight_m": spec.sight_range,
        "detector": detector,
    }


def human_model_ref(found: ParticipantSource, suite: Suite, crew: RobotTeam) -> HumanModelRef:
    """Who they are, and whether they are known to fit this suite, this world and these robots."""
    drawn = not found.source
    notes = tuple(_differences(found, suite, crew)) if drawn else ()
    return HumanModelRef(
        name=found.name,
        source=re.sub(r"(^|[:@])[^:@]*/", r"\1", found.word),
        model=Path(found.model).stem if found.model.endswith(".py") else found.model,
        kind=found.kind.name if found.kind is not None else "",
        population=population_file.population_name(found.population.name) if drawn else "",
        population_sha256=found.population.sha256 if drawn else "",
        sha256=found.sha256,
        valid=not notes,
        notes=notes,
    )


def _expand_word(word: str) -> tuple[str, ...]:
    head, at, base = word.partition("@")
    population = base or resolve.default_population()
    if head == KINDS:
        return (population, *(name + at + base for name in kinds.names()))
    if head == BRACKET:
        return (*(name + at + base for name in EXTREMES), population)
    return (word,)


def _find(word: str) -> ParticipantSource:
    try:
        return resolve.resolve_humans(word)
    except UnknownName as error:
        if error.what != "people":
            raise
        raise UnknownName("people", error.given, (*error.valid, *WORDS), error.hint) from None


def _differences(found: ParticipantSource, suite: Suite, crew: RobotTeam) -> Iterator[str]:
    """What is other than where the population was fitted, a sentence each."""
    name, its = f"the population {population_file.population_name(found.population.name)}", found.population.validity
    if not its.suite_sha256:
        yield f"{name} was fitted to no data: every parameter is drawn from its prior"
    elif its.suite_sha256 != suite.sha256:
        again = "other tasks" if suite.name == its.suite else f"those of the suite {suite.name}"
        yield f"{name} was calibrated on the tasks of the suite {its.suite}, not on {again}"
    yield from _versions(name, its)
    if found.population.missing:
        listed = ", ".join(found.population.missing)
        yield f"{name} was made before there was {listed}; defaults stand in"
    yield from _robots(name, its.settings, crew)


def _versions(name: str, its: Validity) -> Iterator[str]:
    pairs = (("world", its.simulation, rules.SIMULATION), ("proxy's mind", its.mind, parameter_registry.PROXY_VERSION))
    for what, then, now in pairs:
        if then != now:
            yield f"{name} was calibrated with version {then} of the {what}, this is version {now}"
    if its.simulation == rules.SIMULATION and its.rules_sha256 != rules.sha256():
        yield f"{name} was calibrated under other constants of the benchmark"


def _robots(name: str, its: dict[str, str | float], crew: RobotTeam) -> Iterator[str]:
    if not its:
        return
    shapes = {shape.name: shape for shape, mind in crew.robots if not mind.absent}
    for shape in shapes.values():
        here = robot_settings(shape, crew.detector)
        other = [key for key in here if key in its and its[key] != here[key]]
        if other:
            told = ", ".join(f"{key} {_short(its[key])}, not {_short(here[key])}" for key in other)
            yield f"{name} was calibrated with another robot: {told}"


def _short(value: str | float) -> str:
    return value if isinstance(value, str) else f"{value:.3g}"
