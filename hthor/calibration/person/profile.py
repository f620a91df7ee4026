"""What the trials of a run say about each person, and how far each is from a population."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from msgspec import Struct

from hthor.calibration.from_logs import trial_features
from hthor.calibration.from_logs.trial_features import Sessions, Trial
from hthor.calibration.person import (
    clearance,
    hands,
    messages,
    population_comparison,
    trust,
    walking,
    words,
)
from hthor.calibration.person.measure import LEVEL, Measure, unknown
from hthor.calibration.person.population_comparison import PEOPLE, Row
from hthor.calibration.person.walking import Practice
from hthor.errors import RunError, UnknownName
from hthor.eval.records.trial_record import TrialRecord
from hthor.humans.population import parameter_registry, population_file, resolve
from hthor.humans.population.population import Population
from hthor.humans.population.resolve import PROXY
from hthor.report.drawing import render_trial
from hthor.types import HouseSpec
from hthor.types.events import Stick

SCHEMA = "hthor.person/1"


class PersonProfile(Struct, frozen=True, kw_only=True):
    """One person's numbers beside those of a population.

    Attributes:
        participant: the person's number in the run. trials: how many of their trials count.
        population: its name, ``people`` the number of people of it that were compared with, ``level`` the share of
            intervals that contain the person's own value.
        parameters: a row for each parameter of the model of people. others: what else was measured.
    """

    schema: str = SCHEMA
    participant: int
    trials: int
    population: str
    population_sha256: str
    people: int
    level: float
    parameters: tuple[Row, ...]
    others: tuple[Row, ...]

    @property
    def known(self) -> tuple[Row, ...]:
        """The parameters that were measured."""
        return tuple(row for row in self.parameters if row.measure.value is not None)

    @property
    def reasons(self) -> dict[str, list[str]]:
        """Why parameters are not known: the titles of those that each reason stands for."""
        found: dict[str, list[str]] = {}
        for row in self.parameters:
            if row.measure.value is None:
                found.setdefault(row.measure.unknown, []).append(row.title)
        return found


def profiles(run: Path, population: str = PROXY, person: int | None = None) -> tuple[PersonProfile, ...]:
    """The profile of each person in a run, or of one, in the order of their numbers.

    Raises:
        UnknownName: when the run has no such person.
        RunError: when the log cannot be read, or has no record of anybody's motions.
        HthorError: when there is no such population.
    """
    known = population_file.load_population(resolve.default_population() if population == PROXY else population)
    data = trial_features.read_sessions([run])
    if not any(isinstance(entry, Stick) for one in data.trials for entry in one.record.journal):
        raise RunError(f"{run} has no record of anybody's motions, so nobody can be measured from it.")
    numbers = sorted({one.record.spec.humans[0].participant for one in data.trials})
    if person is not None and person not in numbers:
        raise UnknownName("person", str(person), [str(number) for number in numbers], "These took part in the run.")
    people = population_comparison.people_of(known)

    def house_of(record: TrialRecord) -> HouseSpec:
        return render_trial.load_house(run, record)

    made = []
    for number in numbers if person is None else (person,):
        own = [one for one in data.trials if one.record.spec.humans[0].participant == number]
        parameters, others = measure_person(own, known, house_of)
        made.append(
            PersonProfile(
                participant=number,
                trials=len(own),
                population=known.name,
                population_sha256=known.sha256,
                people=PEOPLE,
                level=LEVEL,
                parameters=population_comparison.compare(parameters, words.PARAMETERS, people),
                others=population_comparison.compare(others, words.OTHERS, {}),
            )
        )
    return tuple(made)


def measure_person(
    trials: Sequence[Trial], population: Population, house_of: Callable[[TrialRecord], HouseSpec]
) -> tuple[list[Measure], list[Measure]]:
    """Every parameter of one person, and what else can be measured, from their trials in order."""
    practice = _practice(population)
    features = trial_features.extract_features(Sessions(trials=tuple(trials), people=1, sessions=1))
    answers = messages.answers_of(trials)
    first, *ratings = trust.trust(features, population)
    willing, *confirmed = messages.acceptance(answers, population)
    measured = [
        *walking.walking(features, practice),
        *hands.hands(features, practice),
        *messages.reading(features),
        willing,
        first,
    ]
    by_name = {one.name: one for one in measured}
    parameters = [
        by_name.get(name) or unknown(name, _unit(name), known.unknown) for name, known in words.PARAMETERS.items()
    ]
    ways = [
        messages.hidden_map(features),
        walking.look_round(trials),
        walking.starting(trials),
        clearance.clearance(trials, house_of),
    ]
    return parameters, [*confirmed, *ratings, *ways]


def _practice(population: Population) -> Practice:
    gains = (
        population.draws[:, population.names.index("learn")]
        if "learn" in population.names
        else np.full(len(population.draws), population.fixed["learn"])
    )
    return Practice(float(np.average(gains, weights=population.weights)), float(np.std(gains)))


def _unit(name: str) -> str:
    return parameter_registry.parameter(name).unit if name in parameter_registry.free_parameter_names() else ""
