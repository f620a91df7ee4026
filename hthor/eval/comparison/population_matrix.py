"""Agents evaluated with several human populations: every score, the worst population, and which conclusions hold.

Of the two extreme human models a greedy human accepts every message and searches without a plan, and a random one never
accepts: real participants are assumed to lie between them (`hthor.humans.models.greedy`, `hthor.humans.models.random`).
A conclusion, such as "oracle is better than frontier", that changes its sign at one extreme depends on how humans are
modelled, and is flagged.
"""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Literal

from msgspec import Struct

from hthor.errors import HthorError
from hthor.eval.config.human_populations import EXTREMES, HumanModelRef
from hthor.eval.config.run_config import SuiteRef
from hthor.eval.metrics import registry
from hthor.eval.results.result_file import RunResult
from hthor.eval.statistics.intervals import Estimate

SCHEMA, EVAL_SCHEMA = "hthor.peoples/2", "hthor.eval/1"
METRICS = ("sr", "twsr")
"""The metrics that conclusions are drawn from."""
Verdict = Literal["holds", "vanishes", "flips"]


class PopulationGap(Struct, frozen=True, kw_only=True):
    """How much better one robot did than the other with a human population, as a fraction.

    ``ci95`` is a conservative 95 % interval: Newcombe's, from both runs' own intervals, as if the runs were unrelated.
    They share participants and tasks, so the true interval is narrower.
    """

    people: str
    better: float
    worse: float
    ci95: tuple[float, float]

    @property
    def mean(self) -> float:
        """The difference."""
        return self.better - self.worse

    @property
    def beyond_noise(self) -> bool:
        """Whether the interval excludes 0."""
        return self.ci95[0] > 0.0 or self.ci95[1] < 0.0


class Conclusion(Struct, frozen=True, kw_only=True):
    """Which of two robots is better in one metric with a population, and whether the extremes agree.

    ``verdict``: "holds" if both extremes agree, "flips" if one says the opposite, "vanishes" if one shows no difference
    at all. ``helps`` says that the worse run has no robot, so that the claim is that a robot helps. ``gaps`` has the
    population first, then the extremes.
    """

    better: str
    worse: str
    metric: str
    helps: bool
    verdict: Verdict
    gaps: tuple[PopulationGap, ...]
    sentence: str


class Cell(Struct, frozen=True, kw_only=True):
    """One agent with one population: success, time-weighted success and adoption, as fractions."""

    sr: Estimate
    twsr: Estimate
    adoption: Estimate


class WorstPopulation(Struct, frozen=True, kw_only=True):
    """The population with which an agent succeeds least; several populations if they are equal.

    ``behind`` is how much less [fraction] it succeeds than with the first population, ``base``.
    """

    peoples: tuple[str, ...]
    sr: float
    base: str
    behind: float


class PopulationMatrix(Struct, frozen=True, kw_only=True):
    """The results of one evaluation with several human populations.

    Attributes:
        trials: how many each agent has with each population. peoples: the populations.
        cells: results by the population's name, then by the agent's.
        worst: the worst populations by the agent's name; the extreme models do not count.
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


class EvaluatedRun(Struct, frozen=True, kw_only=True):
    """A whole run: its folder, and its result as `result.json` has it."""

    folder: str
    result: RunResult


class Evaluation(Struct, frozen=True, kw_only=True):
    """All runs of a command, by population and then by agent in the order of the command line.

    ``peoples`` compares the human populations if there were several, else it is null.
    """

    schema: str = EVAL_SCHEMA
    runs: tuple[EvaluatedRun, ...]
    peoples: PopulationMatrix | None = None


def make_evaluation(done: Iterable[tuple[str, RunResult]]) -> Evaluation:
    """The evaluation of whole runs, each by its folder, in the order of the command line."""
    runs = tuple(EvaluatedRun(folder=folder, result=result) for folder, result in done)
    results = [run.result for run in runs]
    several = len({result.humans.name for result in results}) > 1
    return Evaluation(runs=runs, peoples=make_matrix(results) if several else None)


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
    """For each agent, the populations with the lowest success, extremes left out; empty unless two others were run."""
    found: dict[str, WorstPopulation] = {}
    for agent in dict.fromkeys(result.name for result in results):
        held = [result for result in results if result.name == agent and result.humans.model not in EXTREMES]
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
    """The conclusions, if both extreme models and another model were run."""
    models = {held[0].humans.model for held in by_people.values()}
    whole = models.issuperset(EXTREMES) and len(models) > len(EXTREMES)
    return draw_conclusions(by_people) if whole else ()


def draw_conclusions(results: Mapping[str, Sequence[RunResult]]) -> tuple[Conclusion, ...]:
    """The conclusions about every two robots, in the robots' order.

    Args:
        results: by population, with the models "greedy" and "random" and at least one other; for each the results of
            the same robots in the same order, over the same tasks and seed.

    Raises:
        HthorError: when a model is missing, or the results differ in robots, suite, seed or trials.
    """
    _check(results)
    ends = [name for model in EXTREMES for name, runs in results.items() if runs[0].humans.model == model]
    found = []
    for population, metric in itertools.product((name for name in results if name not in ends), METRICS):
        runs = results[population]
        for one, other in itertools.combinations(range(len(runs)), 2):
            pair = (other, one) if _mean(runs[other], metric) > _mean(runs[one], metric) else (one, other)
            gaps = tuple(_gap(name, results[name], pair, metric) for name in (population, *ends))
            if gaps[0].mean > 0.0:
                found.append(_conclusion(runs, pair, metric, gaps))
    return tuple(found)


def _check(results: Mapping[str, Sequence[RunResult]]) -> None:
    models = {runs[0].humans.model for runs in results.values() if runs}
    if not all(results.values()) or not models.issuperset(EXTREMES) or len(models) == len(EXTREMES):
        raise HthorError(
            "the two bounds need results of people who accept everything, of random people and of a population, "
            f"got {sorted(results)}."
        )
    played = {name: [(r.name, r.suite.sha256, r.seed, r.counts.trials) for r in some] for name, some in results.items()}
    first, *others = played
    for name in others:
        if played[name] != played[first]:
            raise HthorError(
                f"the two bounds compare the same robots on the same trials, but {first} had {played[first]} and "
                f"{name} "
                f"{played[name]} (robot, suite, seed, trials)."
            )


def _conclusion(
    runs: Sequence[RunResult], pair: tuple[int, int], metric: str, gaps: tuple[PopulationGap, ...]
) -> Conclusion:
    better, worse = (runs[k] for k in pair)
    ends = gaps[1:]
    verdict: Verdict = "holds"
    if any(gap.mean < 0.0 for gap in ends):
        verdict = "flips"
    elif any(gap.mean == 0.0 for gap in ends):
        verdict = "vanishes"
    helps = all(not robot.seat for robot in worse.robots)
    return Conclusion(
        better=better.name,
        worse=worse.name,
        metric=metric,
        helps=helps,
        verdict=verdict,
        gaps=gaps,
        sentence=_sentence(better.label, worse.label, registry.get(metric).symbol, helps, verdict, gaps),
    )


def _sentence(
    better: str, worse: str, metric: str, helps: bool, verdict: Verdict, gaps: tuple[PopulationGap, ...]
) -> str:
    claim = f"{better} helps (over {worse})" if helps else f"{better} is better than {worse}"
    numbers = ", ".join(f"{100 * gap.mean:+z.1f} {gap.people}" for gap in gaps)
    return f"{claim} in {metric}: {numbers} points; {_word(verdict, gaps)}"


def _word(verdict: Verdict, gaps: tuple[PopulationGap, ...]) -> str:
    if verdict == "holds":
        weak = not all(gap.beyond_noise for gap in gaps)
        return "holds at both ends" + (", though not everywhere beyond chance" if weak else "")
    if verdict == "vanishes":
        return f"no difference at all with {_and(gap for gap in gaps[1:] if gap.mean == 0.0)} people"
    against = [gap for gap in gaps[1:] if gap.mean < 0.0]
    sure = any(gap.beyond_noise for gap in against)
    chance = "" if sure else " (within chance)"
    return f"flips with {_and(against)} people{chance}, so it rests on how people are modelled"


def _and(gaps: Iterable[PopulationGap]) -> str:
    return " and ".join(gap.people for gap in gaps)


def _gap(people: str, runs: Sequence[RunResult], pair: tuple[int, int], metric: str) -> PopulationGap:
    better, worse = (runs[k] for k in pair)
    return PopulationGap(
        people=people,
        better=_mean(better, metric),
        worse=_mean(worse, metric),
        ci95=_apart(better.metrics[metric], worse.metrics[metric]),
    )


def _mean(result: RunResult, metric: str) -> float:
    return result.metrics[metric].mean or 0.0


def _apart(better: Estimate, worse: Estimate) -> tuple[float, float]:
    """Newcombe's interval of the difference of two means that have intervals of their own."""
    (over_better, under_better), (over_worse, under_worse) = _arms(better), _arms(worse)
    gap = (better.mean or 0.0) - (worse.mean or 0.0)
    low, high = gap - math.hypot(under_better, over_worse), gap + math.hypot(over_better, under_worse)
    return round(low, 6), round(high, 6)


def _arms(one: Estimate) -> tuple[float, float]:
    """How far the interval reaches above the mean and below it."""
    if one.mean is None or one.ci95 is None:
        return 0.0, 0.0
    return one.ci95[1] - one.mean, one.mean - one.ci95[0]
