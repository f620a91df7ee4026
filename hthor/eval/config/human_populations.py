"""The human populations of an evaluation, and whether each is used where it was calibrated."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import jsonio, plugins, rules
from hthor.errors import HthorError, UnknownName
from hthor.humans.population import kinds, parameter_registry, population_file, resolve
from hthor.humans.population.population import Validity
from hthor.humans.population.resolve import ParticipantSource
from hthor.tasks import Suite
from hthor.trials import human_team
from hthor.trials.human_team import HumanTeam
from hthor.trials.robot_team import RobotInfo, RobotTeam
from hthor.types import RobotSpec

KINDS, BRACKET = "kinds", "bracket"
"""Words for several populations: the default with every kind of people; the default with the two extremes."""
WORDS = (KINDS, BRACKET)
LIVE = "live"
"""The word for living people, who are at pages, and the name of their human model."""
_COMMA_HINT = "A comma joins the people of one trial, as in proxy,proxy."
EXTREMES = ("greedy", "random")
"""Human models that bound real people: one accepts every message, one accepts none."""


class HumanModelRef(Struct, frozen=True, kw_only=True):
    """The human participants of a run, or those in one seat of its trials.

    Attributes:
        name: their name in tables and sentences.
        source: the user's word for them on the command line, with paths cut to the file's name.
        model: the human model.
        kind: the kind of people that the population was changed into, empty for the population itself.
        population: the name of their distribution, empty where they replay a log; ``population_sha256`` is its hash.
        sha256: hash of everything that defines them, the population included.
        valid: whether the population is used where it was calibrated; ``notes`` say what differs.
        people: set only if a trial has several people: those in each seat, in order. The other fields then describe
            them together: names are joined by "+".
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
    people: "tuple[HumanModelRef, ...] | msgspec.UnsetType" = msgspec.UNSET

    @property
    def members(self) -> "tuple[HumanModelRef, ...]":
        """Those in each seat, in order: one, or several."""
        return self.people or (self,)

    @property
    def models(self) -> tuple[str, ...]:
        """The human model of each person."""
        return tuple(member.model for member in self.members)


def find_people(words: Sequence[str]) -> list[HumanTeam]:
    """The people that the words of ``--humans`` stand for, each once; a comma joins the people of one trial.

    Raises:
        UnknownName: when a word stands for no population.
        PopulationError: when a population's file cannot be used.
        HthorError: when two different populations have the same name.
    """
    teams: dict[str, HumanTeam] = {}
    for word in dict.fromkeys(word for several in words for word in _expand_word(several)):
        team = human_team.form_team([_find(part) for part in human_team.split_word(word)])
        if team.sha256 in {other.sha256 for other in teams.values()}:
            continue
        if team.name in teams:
            raise HthorError(f"two different populations are called '{team.name}'. Rename one of the files.")
        teams[team.name] = team
    return list(teams.values())


def robot_settings(robot: str | RobotInfo, detector: str) -> dict[str, str | float]:
    """The settings of a robot that affect human performance, as a population's file stores them.

    ``detector`` is spelled as `hthor.types.detector_specs.canonical_name` does.
    """
    info = RobotInfo(name=robot) if isinstance(robot, str) else robot
    spec: RobotSpec = plugins.load("robot", info.path or info.name)
    return {
        "robot": info.name,
        "speed_m_s": spec.speed,
        "turn_rate_rad_s": spec.turn_rate,
        "sight_m": spec.sight_range,
        "detector": detector,
    }


def human_model_ref(people: HumanTeam, suite: Suite, team: RobotTeam) -> HumanModelRef:
    """The people's entry in `run.json`, which says whether they were calibrated for this suite, world and robots."""
    members = tuple(_ref(member, suite, team) for member in people.members)
    if len(members) == 1:
        return members[0]
    hashes = dict.fromkeys(one.population_sha256 for one in members)
    return HumanModelRef(
        name=people.name,
        source=human_team.COMMA.join(one.source for one in members),
        model=_joined([one.model for one in members]),
        kind=_joined([one.kind for one in members]),
        population=_joined([one.population for one in members]),
        population_sha256=next(iter(hashes)) if len(hashes) == 1 else jsonio.sha256(list(hashes)),
        sha256=people.sha256,
        valid=all(one.valid for one in members),
        notes=tuple(dict.fromkeys(note for one in members for note in one.notes)),
        people=members,
    )


def _joined(names: Sequence[str]) -> str:
    """These names, each once."""
    return "+".join(dict.fromkeys(name for name in names if name))


def _ref(population: ParticipantSource, suite: Suite, team: RobotTeam) -> HumanModelRef:
    drawn = not population.source
    notes = tuple(_differences(population, suite, team)) if drawn else ()
    return HumanModelRef(
        name=population.name,
        source=re.sub(r"(^|[:@])[^:@]*/", r"\1", population.word),
        model=Path(population.model).stem if population.model.endswith(".py") else population.model,
        kind=population.kind.name if population.kind is not None else "",
        population=population_file.population_name(population.population.name) if drawn else "",
        population_sha256=population.population.sha256 if drawn else "",
        sha256=population.sha256,
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
        if word.partition("@")[0] in WORDS:
            raise HthorError(
                f"'{word}' stands for several populations, so it cannot be one of the people of a trial. Name one "
                "population for each of them, as in proxy,greedy."
            ) from None
        joined = f" {_COMMA_HINT}" if "+" in word else ""
        raise UnknownName("people", error.given, (*error.valid, *WORDS), error.hint + joined) from None


def _differences(people: ParticipantSource, suite: Suite, team: RobotTeam) -> Iterator[str]:
    """How this run differs from the conditions of the calibration, one sentence per difference."""
    drawn_from = people.population
    name, its = f"the population {population_file.population_name(drawn_from.name)}", drawn_from.validity
    if not its.suite_sha256:
        yield f"{name} was fitted to no data: every parameter is drawn from its prior"
    elif its.suite_sha256 != suite.sha256:
        others = "other tasks" if suite.name == its.suite else f"those of the suite {suite.name}"
        yield f"{name} was calibrated on the tasks of the suite {its.suite}, not on {others}"
    yield from _versions(name, its)
    if drawn_from.missing:
        yield f"{name} was made before there was {', '.join(drawn_from.missing)}; defaults stand in"
    yield from _robots(name, its.settings, team)


def _versions(name: str, its: Validity) -> Iterator[str]:
    pairs = (("world", its.simulation, rules.SIMULATION), ("proxy's mind", its.mind, parameter_registry.PROXY_VERSION))
    for what, then, now in pairs:
        if then != now:
            yield f"{name} was calibrated with version {then} of the {what}, this is version {now}"
    if its.simulation == rules.SIMULATION and its.rules_sha256 != rules.sha256():
        yield f"{name} was calibrated under other constants of the benchmark"


def _robots(name: str, its: dict[str, str | float], team: RobotTeam) -> Iterator[str]:
    robots = {robot.name: robot for robot, agent in team.robots if its and not agent.absent}
    for robot in robots.values():
        here = robot_settings(robot, team.detector)
        changed = [key for key in here if key in its and its[key] != here[key]]
        if changed:
            words = ", ".join(f"{key} {_short(its[key])}, not {_short(here[key])}" for key in changed)
            yield f"{name} was calibrated with another robot: {words}"


def _short(value: str | float) -> str:
    return value if isinstance(value, str) else f"{value:.3g}"
