"""Everything that several runs say together, worked out of their trials; reads and draws nothing."""

from __future__ import annotations

from collections.abc import Sequence

from hthor.eval import score
from hthor.eval.pages import chosen, failures, paired, parted, sessions
from hthor.eval.pages.findings import Arm, Findings, Origin, Published
from hthor.eval.pages.gather import Run


def findings(runs: Sequence[Run], published: Published | None = None) -> Findings:
    """The document; the people of most of it are those of the first run.

    Args:
        runs: that belong together, as `hthor.eval.pages.gather` sees to.
        published: figures of a study to stand beside them.
    """
    people = runs[0].plan.humans.name
    own = [run for run in runs if run.plan.humans.name == people]
    baseline = next((run for run in own if run.condition == "none"), None)
    return Findings(
        suite=runs[0].plan.suite,
        people=people,
        baseline=baseline.label if baseline is not None else "",
        published=published,
        arms=tuple(_arm(run) for run in own),
        uplift=tuple(paired.uplift(baseline, run) for run in own if run is not baseline) if baseline else (),
        spent=tuple(sessions.spent(run) for run in own),
        trust=tuple(curve for run in own if (curve := sessions.trust(run)) is not None),
        splits=parted.splits(own),
        by_people=parted.by_people(runs),
        shown=tuple(one for run in own if run.plan.seats for one in chosen.extremes(run, baseline)),
        failures=tuple(one for run in runs for one in failures.of(run)),
        origins=tuple(_origin(run) for run in runs),
    )


def _arm(run: Run) -> Arm:
    return Arm(
        label=run.label,
        condition=run.condition,
        folder=run.folder.resolve().name,
        trials=len(run.records),
        people=len({record.spec.participant for record in run.records}),
        tasks=len({record.spec.task.id for record in run.records}),
        unfinished=run.plan.trials - len(run.records),
        scores=score.scores(run.records),
    )


def _origin(run: Run) -> Origin:
    plan = run.plan
    return Origin(
        name=run.folder.resolve().name,
        agent=plan.name,
        robots=plan.robots,
        humans=plan.humans,
        suite=plan.suite,
        kind=plan.kind,
        seed=plan.seed,
        participants=plan.participants,
        trials=len(run.records),
        whole=plan.trials,
        faulty=sum(bool(record.faults) for record in run.records),
        assets=plan.assets,
        versions=plan.versions,
        run_sha256=plan.sha256,
        rules_sha256=plan.rules_sha256,
        code_sha256=plan.code_sha256,
        trials_sha256=run.sha256,
    )
