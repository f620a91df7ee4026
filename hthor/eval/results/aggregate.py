"""A result from a run's records: metrics with intervals, counts and hashes."""

import hashlib
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

import msgspec

from hthor.eval.config.run_config import RunConfig
from hthor.eval.metrics import registry, trial_metrics
from hthor.eval.metrics.metric import Metric
from hthor.eval.records import opened_files
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import applied_corrections, baseline, result_file
from hthor.eval.results.result_file import (
    AppliedCorrections,
    Counts,
    Effort,
    Hashes,
    RunResult,
    Scores,
    Uplift,
    to_stored,
)
from hthor.eval.statistics import intervals
from hthor.eval.statistics.intervals import Estimate
from hthor.guest import Isolation
from hthor.types import is_person
from hthor.types.events import Event, Sent


def make_result(
    plan: RunConfig,
    lines: Iterable[bytes],
    records: Sequence[TrialRecord],
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
        lines: the log's lines, for their hash. replays: sessions that were run again because an agent was killed.
        voided: attempts at trials that were voided, and are not among the records.
        corrections: those that were applied to the records.
    """
    trials = hashlib.sha256()
    for line in lines:
        trials.update(line)
    kinds = sorted({record.spec.task.kind for record in records})
    whole = estimate_metrics(records)
    of_kind = {kind: [record for record in records if record.spec.task.kind == kind] for kind in kinds}
    by_kind = {kind: whole if len(kinds) == 1 else estimate_metrics(of_kind[kind]) for kind in kinds}
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
        trust_by_trial=trust_by_trial(records),
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
            trials=trials.hexdigest(),
        ),
        assets=plan.assets,
        isolation=isolation,
        effort=effort,
    )


def estimate_metrics(records: Sequence[TrialRecord]) -> Scores:
    """Means and intervals of every metric; trials for which a metric has no value do not count for it."""
    single = {metric.name: estimate_metric(records, metric) for metric in registry.SINGLE}
    by_seat = {metric.name: _by_seat(records, metric) for metric in registry.BY_SEAT}
    kept = {name: found for name, found in by_seat.items() if found or not registry.get(name).several}
    return Scores(**single, **kept)


def trust_by_trial(records: Sequence[TrialRecord]) -> tuple[Estimate, ...]:
    """Trust after each trial of a session, in their order."""
    rated = [record for record in records if record.metrics["trust"] is not None]
    last = max((record.spec.index for record in rated), default=-1)
    trust = registry.get("trust")
    return tuple(
        estimate_metric([record for record in rated if record.spec.index == index], trust) for index in range(last + 1)
    )


def _by_seat(records: Sequence[TrialRecord], metric: Metric) -> dict[str, Estimate]:
    """An estimate for each seat that the metric has values for, in order of first appearance."""
    seats = dict.fromkeys(seat for record in records for seat in record.metrics.by_seat(metric.name))
    return {seat: estimate_metric(records, metric, seat) for seat in seats}


def _is_robots_message(event: Event) -> bool:
    return isinstance(event, Sent) and not is_person(event.seat)


def estimate_metric(records: Sequence[TrialRecord], metric: Metric, seat: str = "") -> Estimate:
    """The estimate of a metric, of one seat where it has values by seat."""
    values: list[float] = []
    specs = []
    for record in records:
        value = record.metrics.by_seat(metric.name).get(seat) if metric.by_seat else record.metrics[metric.name]
        if value is not None:
            values.append(float(value))
            specs.append(record.spec)
    return intervals.estimate(
        values,
        [spec.task.id for spec in specs],
        [spec.session for spec in specs],
        within=metric.range_of(values, [spec.task.time_limit for spec in specs]),
    )


def score_run(
    run: RunFolder, lines: Iterable[bytes], records: Sequence[TrialRecord], effort: Effort | None
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
    run: RunFolder, lines: Iterable[bytes], records: Sequence[TrialRecord], effort: Effort | None
) -> RunResult:
    """The result of a shard, which is not stored and has no uplift."""
    held = applied_corrections.applied(run)
    return make_result(run.config, lines, records, effort, voided=len(run.voided), corrections=held)


def rescore(folder: Path) -> tuple[RunConfig, RunResult, RunResult | None]:
    """Score a run again from its log: its configuration, the new result, and the stored result if there is one.

    Every trial's metrics are measured again from its events. The effort is taken from the stored result, as the log
    does not have it. A stored result in another version of the format is ignored.
    """
    run = RunFolder(folder)
    lines, kept = run.lines()
    stored = result_file.load_current(folder)
    return run.config, score_run(run, lines, _measured(kept), stored.effort if stored else None), stored


def load_measured(folder: Path) -> tuple[RunFolder, list[TrialRecord]]:
    """A run, and its records with metrics measured again from their events."""
    run = RunFolder(folder)
    return run, _measured(run.records())


def _measured(kept: Iterable[TrialRecord]) -> list[TrialRecord]:
    return [msgspec.structs.replace(record, metrics=trial_metrics.measure(record.spec, record.log)) for record in kept]
