"""Runs against each other, trial by trial, as `hthor compare` does it."""

import itertools
from collections.abc import Sequence

from hthor.eval.comparison import compare
from hthor.eval.comparison.compare import Comparison, LoadedRun
from hthor.eval.results import pairing
from hthor.report.analysis.document import IncomparablePair
from hthor.report.analysis.load_runs import Run


def compare_labelled(
    baseline: Run | None, runs: Sequence[Run]
) -> tuple[tuple[Comparison, ...], tuple[IncomparablePair, ...]]:
    """Every pair of runs, that without a robot as the first of its pairs, and the pairs that share no trial."""
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
    """For each human population, what the robots change against no robot."""
    found: dict[str, tuple[Comparison, ...]] = {}
    names = list(dict.fromkeys(run.plan.humans.name for run in runs))
    for name in names if len(names) > 1 else ():
        own = [run for run in runs if run.plan.humans.name == name]
        alone = next((run for run in own if run.condition == "none"), None)
        if alone is not None:
            found[name] = tuple(pair for pair in compare_labelled(alone, own)[0] if pair.first == alone.label)
    return found
