"""Agents evaluated with several human populations: every score, and the worst population for each agent."""

from collections.abc import Sequence

from msgspec import Struct

from hthor.eval.comparison import robustness
from hthor.eval.comparison.robustness import Conclusion
from hthor.eval.config import human_populations
from hthor.eval.config.human_populations import HumanModelRef
from hthor.eval.config.run_config import SuiteRef
from hthor.eval.results.result_file import RunResult
from hthor.eval.statistics.intervals import Estimate

SCHEMA = "hthor.peoples/2"


class Cell(Struct, frozen=True, kw_only=True):
    """One agent with one population: success, time-weighted success and adoption, as fractions."""

    sr: Estimate
    twsr: Estimate
    adoption: Estimate


class WorstPopulation(Struct, frozen=True, kw_only=True):
    """The populations with which an agent succeeds least, several if they are equal.

    ``behind`` is how much less [fraction] it succeeds than with the first population, ``base``.
    """

    peoples: tuple[str, ...]
    sr: float
    base: str
    behind: float


class PopulationMatrix(Struct, frozen=True, kw_only=True):
    """The results of one evaluation with several human populations.

    Attributes:
        trials: with each population. peoples: the populations.
        cells: by the population's name, then by the agent's.
        worst: by the agent's name; the extreme models do not count.
        conclusions: about every two agents, and whether the extreme models agree; empty unless both were run.
    """

    schema: str = SCHEMA
    suite: SuiteRef
    seed: int
    trials: int
    agents: tuple[str, ...]
    peoples: tuple[HumanModelRef, ...]
    cells: dict[str, dict[str, Cell]]
    worst: dict[str, WorstPopulation]
    conclusions: tuple[Conclusion, ...]


def make_matrix(results: Sequence[RunResult]) -> PopulationMatrix:
    """The matrix of an evaluation's results, which are ordered by population, then by agent."""
    populations = {result.humans.name: result.humans for result in results}
    by_people = {name: [result for result in results if result.humans.name == name] for name in populations}
    first = results[0]
    return PopulationMatrix(
        suite=first.suite,
        seed=first.seed,
        trials=first.counts.trials,
        agents=tuple(dict.fromkeys(result.name for result in results)),
        peoples=tuple(populations.values()),
        cells={name: {result.name: _cell(result) for result in held} for name, held in by_people.items()},
        worst=_worst(results),
        conclusions=_conclusions(by_people),
    )


def _cell(result: RunResult) -> Cell:
    return Cell(sr=result.metrics["sr"], twsr=result.metrics["twsr"], adoption=result.metrics["adoption"])


def _worst(results: Sequence[RunResult]) -> dict[str, WorstPopulation]:
    """For each agent, the populations with the lowest success, without the extremes; empty with one other only."""
    found: dict[str, WorstPopulation] = {}
    for agent in dict.fromkeys(result.name for result in results):
        held = [
            result
            for result in results
            if result.name == agent and result.humans.model not in human_populations.EXTREMES
        ]
        if len(held) > 1:
            rates = {result.humans.name: result.metrics["sr"].mean or 0.0 for result in held}
            least, base = min(rates.values()), held[0].humans.name
            found[agent] = WorstPopulation(
                peoples=tuple(name for name, rate in rates.items() if rate == least),
                sr=least,
                base=base,
                behind=rates[base] - least,
            )
    return found


def _conclusions(by_people: dict[str, list[RunResult]]) -> tuple[Conclusion, ...]:
    """The conclusions, if both extreme models and another one were run."""
    models = {held[0].humans.model for held in by_people.values()}
    whole = models.issuperset(human_populations.EXTREMES) and len(models) > len(human_populations.EXTREMES)
    return robustness.draw_conclusions(by_people) if whole else ()
