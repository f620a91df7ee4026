"""Builds a report's document from runs."""

from collections.abc import Sequence

from hthor.eval.results import estimates
from hthor.report.analysis import (
    breakdown,
    run_provenance,
    session_statistics,
    trial_selection,
)
from hthor.report.analysis.document import Arm, Findings, Published
from hthor.report.analysis.load_runs import Run

_MANY = 8
"""With more runs than this, fewer trials are drawn, so that the page stays small."""
_STUDIED = {"object_goal_navigation", "mobile_manipulation"}
"""Task kinds for which a study has published figures."""


def build_findings(runs: Sequence[Run], published: Published | None = None) -> Findings:
    """Build the document; most of it is about the human population of the first run.

    Args:
        runs: as `hthor.report.analysis.load_runs` returns them.
        published: a study's figures to compare with; used only if the tasks are of the kinds that it studied.
    """
    people = runs[0].plan.humans.name
    own = [run for run in runs if run.plan.humans.name == people]
    baseline = next((run for run in own if run.condition == "none"), None)
    each = trial_selection.EACH if len(own) <= _MANY else 1
    compared, incomparable = breakdown.compare_labelled(baseline, own)
    return Findings(
        suite=runs[0].plan.suite,
        people=people,
        baseline=baseline.label if baseline is not None else "",
        published=published if _studied(runs) else None,
        arms=tuple(_arm(run) for run in own),
        comparisons=compared,
        apart=incomparable,
        spent=tuple(session_statistics.time_spent(run) for run in own),
        trust=tuple(curve for run in own if (curve := session_statistics.trust_curve(run)) is not None),
        splits=breakdown.all_splits(own),
        by_people=breakdown.split_by_population(runs),
        people_uplift=breakdown.uplift_by_population(runs),
        shown=tuple(
            one for run in own if run.plan.seats for one in trial_selection.best_and_worst(run, baseline, each)
        ),
        failures=tuple(one for run in runs for one in trial_selection.fault_summary(run)),
        origins=tuple(run_provenance.run_provenance(run) for run in runs),
    )


def _studied(runs: Sequence[Run]) -> bool:
    kinds = {record.spec.task.kind for run in runs for record in run.records}
    return bool(kinds & _STUDIED)


def _arm(run: Run) -> Arm:
    return Arm(
        label=run.label,
        condition=run.condition,
        folder=run.name,
        trials=len(run.records),
        people=len({human.participant for record in run.records for human in record.spec.humans}),
        tasks=len({record.spec.task.id for record in run.records}),
        unfinished=run.planned - len(run.records),
        scores=estimates.estimate_metrics(run.records),
    )
