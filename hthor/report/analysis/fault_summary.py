"""In what ways a run's robots failed, how often, and what is left of the first."""

import shlex

from msgspec import Struct

from hthor import documents, rules
from hthor.eval.config import cli_command
from hthor.eval.records.trial_record import TrialRecord
from hthor.report.analysis import trial_selection
from hthor.report.analysis.example_trials import FaultGroup
from hthor.report.analysis.load_runs import Run

_DETAIL_MAX, _OUTPUT_MAX = 4000, 2000
_FOLDER = "faults"


class _Left(Struct):
    """What a run kept of one robot that failed, as far as it is shown."""

    seat: str = ""
    kind: str = ""
    detail: str = ""
    output: str = ""


class _Remains(Struct):
    failures: tuple[_Left, ...] = ()
    again: str = ""


def fault_summary(run: Run) -> list[FaultGroup]:
    """One entry for each seat and sort of fault, by the first trial that it came in, the most frequent first."""
    agents = {robot.seat: robot.agent.name for robot in run.plan.seats}
    cases: dict[tuple[str, str], list[TrialRecord]] = {}
    for record in run.records:
        for seat, kind in dict.fromkeys((fault.seat, fault.kind) for fault in record.faults):
            cases.setdefault((seat, kind), []).append(record)
    found = [_failure(run, seat, agents.get(seat, ""), kind, held) for (seat, kind), held in cases.items()]
    return sorted(found, key=lambda one: -one.trials)


def _failure(run: Run, seat: str, agent: str, kind: str, held: list[TrialRecord]) -> FaultGroup:
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
        participant=first.spec.participant,
        index=first.spec.index,
        after_s=round(fault.tick * rules.TICK_S, 1),
        detail=(left.detail or fault.detail).strip()[-_DETAIL_MAX:],
        output=left.output.strip()[-_OUTPUT_MAX:],
        again=_here(remains.again, run),
        replay=trial_selection.replay_command(run, first),
    )


def _here(again: str, run: Run) -> str:
    """The command that plays a trial again, with the run's folder as it is reached from here."""
    try:
        *words, _, key = shlex.split(again)
    except ValueError:  # there is none, or somebody changed it
        return again
    return shlex.join([*words, str(cli_command.relative_path(run.folder)), key])


def _remains(run: Run, record: TrialRecord) -> _Remains:
    """What the run kept of a trial; nothing where it kept none, or what nobody can read: no number depends on it."""
    path = run.folder / _FOLDER / f"{record.key}.json"
    try:
        return documents.decode(path.read_bytes(), _Remains)
    except (OSError, documents.Unreadable):
        return _Remains()
