"""The description of a population: parameters, where they come from, and how participants differ."""

from typing import Any

import msgspec
import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.humans.population import population_file
from hthor.humans.population.distributions import Prior
from hthor.humans.population.parameter_registry import Grade
from hthor.humans.population.population import Population, Validity
from hthor.humans.population.resolve import ParticipantSource

_COPIED = ("fixed", "statistics", "design_effects", "figures", "notes", "validity", "seed", "command")
_COPIED_OF_COLUMN = ("name", "unit", "meaning", "prior", "fitted", "grade", "contraction", "source")
QUANTILES = (0.05, 0.5, 0.95)
"""[probability] Quantiles of every described distribution. Our choice: median and 90 % interval."""


class ParameterDescription(Struct, frozen=True, kw_only=True):
    """One free parameter: ``mean`` over the draws after the kind's changes, quantiles at `QUANTILES`.

    ``person_sd`` is the spread between participants on the ``scale``; ``says``: whether the data determine it.
    """

    name: str
    unit: str
    meaning: str
    mean: float
    quantiles: tuple[float, ...]
    prior: Prior
    prior_quantiles: tuple[float, ...]
    person_sd: float
    scale: str
    fitted: bool
    grade: Grade
    contraction: float
    says: str
    source: str


class ParameterChange(Struct, frozen=True, kw_only=True):
    """How a kind changes one parameter; ``before`` and ``after`` are means over the draws."""

    parameter: str
    verb: str
    value: float
    before: float
    after: float
    reason: str


class PopulationDescription(Struct, frozen=True, kw_only=True):
    """Everything about the participants of one word of `--humans`."""

    name: str
    purpose: str
    sha256: str
    model: str
    kind: str
    reason: str
    changes: tuple[ParameterChange, ...]
    population: str
    population_sha256: str
    draws: int
    effective_draws: float
    traits: tuple[ParameterDescription, ...]
    fixed: dict[str, float]
    statistics: tuple[str, ...]
    design_effects: dict[str, float]
    figures: dict[str, float]
    notes: tuple[str, ...]
    validity: Validity
    seed: int
    command: str


def describe_population(source: ParticipantSource) -> PopulationDescription:
    """Everything about the participants of this source."""
    population = _changed_population(source)
    return PopulationDescription(
        name=source.name,
        purpose=source.purpose,
        sha256=source.sha256,
        model=source.model,
        kind=source.kind.name if source.kind else "",
        reason=source.kind.reason if source.kind else "",
        changes=_changes(source, population),
        population=population_file.population_name(population.name),
        population_sha256=source.population.sha256,
        draws=len(population.draws),
        effective_draws=round(population.ess, 1),
        traits=_parameters(population),
        **{name: getattr(population, name) for name in _COPIED},
    )


def sample_participants(source: ParticipantSource, count: int, seed: int) -> list[dict[str, Any]]:
    """The first participants of the study with this seed, with all their parameters.

    Raises:
        HthorError: when the seed is negative.
    """
    seeds.check_seed(seed)
    return [
        {"participant": number, **msgspec.structs.asdict(source.participant(seed, number).traits)}
        for number in range(count)
    ]


def varying_parameters(source: ParticipantSource) -> list[str]:
    """The parameters in which participants differ, in order."""
    return [spec.name for spec in source.population.specs if spec.effect]


def _changed_population(source: ParticipantSource) -> Population:
    """The population after the kind's changes, draw by draw."""
    if source.kind is None:
        return source.population
    rows = [source.kind.change(source.population.parameters(row)) for row in range(len(source.population.draws))]
    names = source.population.names
    draws = [[getattr(row, name) for name in names] for row in rows]
    fixed = {name: getattr(rows[0], name) for name in source.population.fixed}
    return msgspec.structs.replace(source.population, draws=np.array(draws), fixed=fixed)


def _changes(source: ParticipantSource, after: Population) -> tuple[ParameterChange, ...]:
    if source.kind is None:
        return ()
    before, now = source.population.mean(), after.mean()
    return tuple(
        ParameterChange(
            **msgspec.structs.asdict(change),
            before=getattr(before, change.parameter),
            after=getattr(now, change.parameter),
        )
        for change in source.kind.changes
    )


def _parameters(population: Population) -> tuple[ParameterDescription, ...]:
    mean, quantiles = population.mean(), population.quantiles(QUANTILES)
    return tuple(
        ParameterDescription(
            **{name: getattr(spec, name) for name in _COPIED_OF_COLUMN},
            mean=getattr(mean, spec.name),
            quantiles=tuple(quantiles[:, column].tolist()),
            prior_quantiles=tuple(spec.prior.quantile(level) for level in QUANTILES),
            person_sd=spec.effect * mean.sigma,
            scale=spec.scale if spec.effect else "",
            says=spec.word,
        )
        for column, spec in enumerate(population.specs)
    )
