"""Selects the trials of a run that get a map: those in which its robots helped most and least."""

import shlex

from hthor.eval.config import cli_command
from hthor.eval.records.trial_record import TrialRecord
from hthor.report.analysis.example_trials import ExampleTrial
from hthor.report.analysis.load_runs import Run, pairing_key

EACH = 2
"""So many of the best and of the worst."""


def best_and_worst(run: Run, alone: Run | None, each: int = EACH) -> list[ExampleTrial]:
    """The ``each`` best and worst trials of a run with robots, each trial at most once.

    Against the same person without a robot where there is such a run: by the time saved, and among equals by
    time-weighted success. Without one by time-weighted success, and among equals by the time spent.
    """
    others = alone.by_pair if alone is not None else {}
    ranked = [record for record in run.records if alone is None or pairing_key(record) in others]

    def worth(record: TrialRecord) -> tuple[float, float, str]:
        other, own = others.get(pairing_key(record)), record.metrics
        if other is None:
            return (own.number("twsr"), -own.number("time_s"), record.key)
        return (_saved_s(record, other), own.number("twsr"), record.key)

    ranked.sort(key=worth)
    each = min(each, len(ranked) // 2)
    worst, best = ranked[:each], ranked[len(ranked) - each :][::-1]
    return [
        *(_shown(run, "best", record, others.get(pairing_key(record))) for record in best),
        *(_shown(run, "worst", record, others.get(pairing_key(record))) for record in worst),
    ]


def _saved_s(record: TrialRecord, alone: TrialRecord) -> float:
    return round(alone.metrics.number("time_s") - record.metrics.number("time_s"), 6)


def _shown(run: Run, rank: str, record: TrialRecord, other: TrialRecord | None) -> ExampleTrial:
    task = record.spec.task
    return ExampleTrial(
        arm=run.label,
        rank="best" if rank == "best" else "worst",
        key=record.key,
        task=task.id,
        instruction=task.instruction,
        house=task.house,
        participant=record.spec.participant,
        index=record.spec.index,
        met=record.met,
        time_s=record.metrics.number("time_s"),
        t_star=task.t_star,
        alone_met=other.met if other is not None else None,
        alone_s=other.metrics.number("time_s") if other is not None else None,
        gain_s=_saved_s(record, other) if other is not None else None,
        replay=replay_command(run, record),
    )


def replay_command(run: Run, record: TrialRecord) -> str:
    """The command that draws a trial, as it can be typed where the report was written."""
    return shlex.join(["hthor", "replay", str(cli_command.relative_path(run.folder)), record.key])
