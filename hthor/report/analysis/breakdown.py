"""Success rates within parts of the trials and with each human population, and comparisons between runs."""

import itertools
from collections.abc import Callable, Sequence

from hthor.eval.comparison import compare
from hthor.eval.comparison.comparison import Comparison, LoadedRun
from hthor.eval.metrics import registry
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.results import estimates, pairing
from hthor.eval.statistics.intervals import Estimate
from hthor.report.analysis.document import Group, IncomparablePair, Split
from hthor.report.analysis.load_runs import Run

_LEVELS = ("easy", "medium", "hard")
_KINDS = "kind of task"


def all_splits(runs: Sequence[Run]) -> tuple[Split, ...]:
    """Every breakdown of the trials that has more than one group, and more than one trial in some group."""
    found = (
        _split("difficulty", runs, lambda one: one.spec.task.difficulty, _LEVELS),
        _split(_KINDS, runs, lambda one: one.spec.task.kind.replace("_", " ")),
        _split("split", runs, lambda one: one.spec.task.split, ("seen", "new")),
        _split("scene", runs, lambda one: one.spec.task.house),
    )
    return tuple(one for one in found if len(one.groups) > 1 and _tells(one))


def _tells(split: Split) -> bool:
    """Whether any group has more than one trial."""
    return any(one.n > 1 for group in split.groups for one in group.sr.values())


def split_by_population(runs: Sequence[Run]) -> Split | None:
    """Success with each human population, in the order of the runs; None if there is only one population."""
    names = list(dict.fromkeys(run.plan.humans.name for run in runs))
    groups = tuple(
        Group(name=name, sr={run.label: success_rate(run.records) for run in runs if run.plan.humans.name == name})
        for name in names
    )
    return Split(word="kind of person", groups=groups) if len(groups) > 1 else None


def _split(word: str, runs: Sequence[Run], part: Callable[[ScoredTrial], str], order: Sequence[str] = ()) -> Split:
    names = sorted({part(record) for run in runs for record in run.records} - {""})
    names.sort(key=lambda name: order.index(name) if name in order else len(order))
    groups = (
        Group(
            name=name, sr={run.label: success_rate([one for one in run.records if part(one) == name]) for run in runs}
        )
        for name in names
    )
    return Split(word=word, groups=tuple(groups))


def success_rate(records: Sequence[ScoredTrial]) -> Estimate:
    """Success rate with its interval."""
    return estimates.estimate_metric(records, registry.get("sr"))


def compare_labelled(
    baseline: Run | None, runs: Sequence[Run]
) -> tuple[tuple[Comparison, ...], tuple[IncomparablePair, ...]]:
    """Compare every two runs, a baseline always as the first; also return the pairs that share no trial."""
    order = [run for run in (baseline, *(one for one in runs if one is not baseline)) if run is not None]
    found = compare.compare_pairs(
        [LoadedRun(name=run.label, folder=run.folder, plan=run.plan, records=run.records) for run in order]
    )
    known = {(pair.first, pair.second) for pair in found}
    apart = tuple(
        IncomparablePair(first=one.label, second=other.label, field=pairing.differing_field(one.plan, other.plan))
        for one, other in itertools.combinations(order, 2)
        if (one.label, other.label) not in known
    )
    return found, apart


def uplift_by_population(runs: Sequence[Run]) -> dict[str, tuple[Comparison, ...]]:
    """For each human population, the comparisons of its robots with no robot."""
    found: dict[str, tuple[Comparison, ...]] = {}
    names = list(dict.fromkeys(run.plan.humans.name for run in runs))
    for name in names if len(names) > 1 else ():
        own = [run for run in runs if run.plan.humans.name == name]
        alone = next((run for run in own if run.condition == "none"), None)
        if alone is not None:
            found[name] = tuple(pair for pair in compare_labelled(alone, own)[0] if pair.first == alone.label)
    return found
