"""A result from a run's records: metrics with intervals, counts and hashes."""

import hashlib
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

import msgspec

from hthor import code_identity
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records import opened_files
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.results import applied_corrections, baseline, estimates, result_file
from hthor.eval.results.result_file import (
    AppliedCorrections,
    Counts,
    Effort,
    Hashes,
    RunResult,
    Uplift,
    to_stored,
)
from hthor.guest import Isolation
from hthor.types import is_person
from hthor.types.events import Event, Sent


def make_result(
    plan: RunConfig,
    lines: Iterable[bytes],
    records: Sequence[ScoredTrial],
    effort: Effort | None = None,
    *,
    uplift: Uplift | None = None,
    isolation: Isolation | None = None,
    replays: int = 0,
    voided: int = 0,
    corrections: AppliedCorrections | None = None,
) -> RunResult:
    """The result of a run's records, complete or not.

    Args:
        lines: the log's lines, for their hash. records: with metrics as they are measured now, whenever they were run.
        replays: sessions that were run again because an agent was killed.
        voided: attempts at trials that were voided, and are not among the records.
        corrections: those that were applied to the records.
    """
    trials = hashlib.sha256()
    for line in lines:
        trials.update(line)
    kinds = sorted({record.spec.task.kind for record in records})
    whole = estimates.estimate_metrics(records)
    of_kind = {kind: [record for record in records if record.spec.task.kind == kind] for kind in kinds}
    by_kind = {kind: whole if len(kinds) == 1 else estimates.estimate_metrics(of_kind[kind]) for kind in kinds}
    return RunResult(
        name=plan.name,
        robots=plan.robots,
        agents=opened_files.complete_manifests(plan, records),
        humans=plan.humans,
        suite=plan.suite,
        kind=plan.kind,
        seed=plan.seed,
        mode=plan.mode,
        participants=plan.participants,
        design=plan.design,
        metrics=whole,
        by_kind=by_kind,
        trust_by_trial=estimates.trust_by_trial(records),
        uplift=to_stored(uplift),
        counts=Counts(
            trials=len(records),
            tasks=len({record.spec.task.id for record in records}),
            successes=sum(record.met for record in records),
            messages=sum(_is_robots_message(event) for record in records for event in record.events),
            faults=sum(bool(record.faults) for record in records),
            faults_by_seat={
                robot.seat: sum(any(fault.seat == robot.seat for fault in record.faults) for record in records)
                for robot in plan.seats
            },
            faults_by_kind=dict(sorted(Counter(fault.kind for one in records for fault in one.faults).items())),
            replays=replays,
            voided=voided or msgspec.UNSET,
        ),
        corrections=corrections or msgspec.UNSET,
        versions=plan.versions,
        hashes=Hashes(
            run=plan.sha256,
            human=plan.humans.sha256,
            rules=plan.rules_sha256,
            code=plan.code_sha256,
            scoring=code_identity.scoring_sha256(),
            trials=trials.hexdigest(),
        ),
        assets=plan.assets,
        isolation=isolation,
        effort=effort,
    )


def _is_robots_message(event: Event) -> bool:
    return isinstance(event, Sent) and not is_person(event.seat)


def score_run(
    run: RunFolder, lines: Iterable[bytes], records: Sequence[ScoredTrial], effort: Effort | None
) -> RunResult:
    """The result of a run from its records and the other files of its folder.

    Raises:
        RunError: also when the run has fewer corrections than when it was scored last.
    """
    applied_corrections.check_kept(run)
    uplift = baseline.uplift_or_stored(run.path, run.config, records)
    return make_result(
        run.config,
        lines,
        records,
        effort,
        uplift=uplift,
        isolation=run.isolation,
        replays=run.restarts,
        voided=len(run.voided),
        corrections=applied_corrections.applied(run),
    )


def score_shard(
    run: RunFolder, lines: Iterable[bytes], records: Sequence[ScoredTrial], effort: Effort | None
) -> RunResult:
    """The result of a shard, which is not stored and has no uplift."""
    held = applied_corrections.applied(run)
    return make_result(run.config, lines, records, effort, voided=len(run.voided), corrections=held)


def rescore(folder: Path) -> tuple[RunConfig, RunResult, RunResult | None]:
    """Score a run again from its log: its configuration, the new result, and the stored result if there is one.

    The effort is taken from the stored result, as the log does not have it. A stored result in another version of the
    format is ignored.
    """
    run = RunFolder(folder)
    lines, records = run.lines()
    stored = result_file.load_current(folder)
    return run.config, score_run(run, lines, records, stored.effort if stored else None), stored
