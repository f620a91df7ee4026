"""Selects trials to show: where a run's robots helped most and least, and the first trial with each kind of fault."""

import shlex

from msgspec import Struct

from hthor import documents, rules
from hthor.eval.config import cli_command
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.results import group_difference
from hthor.report.analysis.document import ExampleTrial, FaultGroup
from hthor.report.analysis.load_runs import Run, pairing_key

EACH = 2
"""How many of the best trials to show, and how many of the worst."""
_DETAIL_MAX, _OUTPUT_MAX = 4000, 2000
_FOLDER = "faults"


def best_and_worst(run: Run, alone: Run | None, each: int = EACH) -> list[ExampleTrial]:
    """The ``each`` best and worst trials of a run with robots, each trial at most once.

    If there is a run of the same people without a robot, trials are ranked by the time saved against it, then by
    time-weighted success. Otherwise they are ranked by time-weighted success, then by the time spent.
    """
    if alone is not None and group_difference.are_groups(alone.plan, run.plan):
        alone = None
    others = alone.by_pair if alone is not None else {}
    ranked = [record for record in run.records if alone is None or pairing_key(record) in others]

    def worth(record: ScoredTrial) -> tuple[float, float, str]:
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


def _saved_s(record: ScoredTrial, alone: ScoredTrial) -> float:
    return round(alone.metrics.number("time_s") - record.metrics.number("time_s"), 6)


def _shown(run: Run, rank: str, record: ScoredTrial, other: ScoredTrial | None) -> ExampleTrial:
    task = record.spec.task
    return ExampleTrial(
        arm=run.label,
        rank="best" if rank == "best" else "worst",
        key=record.key,
        task=task.id,
        instruction=task.instruction,
        house=task.house,
        session=record.spec.session,
        index=record.spec.index,
        met=record.met,
        time_s=record.metrics.number("time_s"),
        t_star=task.t_star,
        alone_met=other.met if other is not None else None,
        alone_s=other.metrics.number("time_s") if other is not None else None,
        gain_s=_saved_s(record, other) if other is not None else None,
        replay=replay_command(run, record),
    )


def replay_command(run: Run, record: ScoredTrial) -> str:
    """The command that draws a trial, to be typed in the folder in which the report was written."""
    return shlex.join(["hthor", "replay", str(cli_command.relative_path(run.folder)), record.key])


class _Left(Struct):
    """The data that a run kept of one robot's failure, as far as the report shows it."""

    seat: str = ""
    kind: str = ""
    detail: str = ""
    output: str = ""


class _Remains(Struct):
    failures: tuple[_Left, ...] = ()
    again: str = ""


def fault_summary(run: Run) -> list[FaultGroup]:
    """One entry for each seat and kind of fault, described by its first trial; the most frequent first."""
    agents = {robot.seat: robot.agent.name for robot in run.plan.seats}
    cases: dict[tuple[str, str], list[ScoredTrial]] = {}
    for record in run.records:
        for seat, kind in dict.fromkeys((fault.seat, fault.kind) for fault in record.faults):
            cases.setdefault((seat, kind), []).append(record)
    found = [_failure(run, seat, agents.get(seat, ""), kind, held) for (seat, kind), held in cases.items()]
    return sorted(found, key=lambda one: -one.trials)


def _failure(run: Run, seat: str, agent: str, kind: str, held: list[ScoredTrial]) -> FaultGroup:
    first = held[0]
    fault = next(one for one in first.faults if (one.seat, one.kind) == (seat, kind))
    remains = _remains(run, first)
    left = next((one for one in remains.failures if (one.seat, one.kind) == (seat, kind)), _Left())
    return FaultGroup(
        run=run.name,
        seat=seat,
        agent=agent,
        kind=kind,
        trials=len(held),
        whole=len(run.records),
        key=first.key,
        task=first.spec.task.id,
        session=first.spec.session,
        index=first.spec.index,
        after_s=round(fault.tick * rules.TICK_S, 1),
        detail=(left.detail or fault.detail).strip()[-_DETAIL_MAX:],
        output=left.output.strip()[-_OUTPUT_MAX:],
        again=_here(remains.again, run),
        replay=replay_command(run, first),
    )


def _here(again: str, run: Run) -> str:
    """The command that plays a trial again, with a path to the run's folder that is valid from here."""
    try:
        *words, _, key = shlex.split(again)
    except ValueError:  # the command is missing, or somebody changed it
        return again
    return shlex.join([*words, str(cli_command.relative_path(run.folder)), key])


def _remains(run: Run, record: ScoredTrial) -> _Remains:
    """What the run kept of a trial's faults; empty if missing or unreadable, because no number depends on it."""
    path = run.folder / _FOLDER / f"{record.key}.json"
    try:
        return documents.decode(path.read_bytes(), _Remains)
    except (OSError, documents.Unreadable):
        return _Remains()
