"""One run: its result, its trials one by one, and commands that continue from it."""

import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path

from msgspec import Struct

from hthor import rules
from hthor.eval.config import cli_command
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import aggregate, result_file
from hthor.eval.results.result_file import RunResult
from hthor.eval.runner import fault_report

SCHEMA = "hthor.run-view/1"


class TrialFilter(Struct, frozen=True, kw_only=True):
    """Which trials to list; an empty or None field takes all."""

    task: str = ""
    kind: str = ""
    house: str = ""
    participant: int | None = None
    met: bool | None = None
    faulty: bool | None = None

    def fits(self, record: TrialRecord) -> bool:
        """Whether the filter takes a trial."""
        task = record.spec.task
        return (
            (not self.task or self.task in (task.id, task.goal.target))
            and (not self.kind or self.kind == task.kind)
            and (not self.house or self.house == task.house)
            and self.participant in (None, record.spec.participant)
            and self.met in (None, record.met)
            and self.faulty in (None, bool(record.faults))
        )


class TrialLine(Struct, frozen=True, kw_only=True):
    """A trial in one line. ``number`` is its place in the run, as `hthor replay` takes it; ``fault`` the first one."""

    number: int
    key: str
    task: str
    house: str
    participant: int
    met: bool
    time_s: float
    sent: int
    accepted: int
    trust: int | None
    fault: str


class RunView(Struct, frozen=True, kw_only=True):
    """The document of `hthor runs view`. ``result`` is None while trials are missing or there are none."""

    schema: str = SCHEMA
    folder: str
    name: str
    done: int
    total: int
    result: RunResult | None
    trials: tuple[TrialLine, ...]
    next: tuple[str, ...]


def view_run(folder: Path, wanted: TrialFilter) -> tuple[RunView, RunResult | None]:
    """A run, and its result so far, which is preliminary while trials are missing.

    Raises:
        RunError: when the folder holds no run, or the run cannot be read.
    """
    run = RunFolder(folder)
    plan = run.config
    _, records = run.digest()
    total = plan.shard.trials if plan.shard else plan.trials
    whole = len(records) >= total
    stored = None if result_file.is_outdated(folder / "result.json") else result_file.load_result(folder)
    so_far = stored if whole and stored else aggregate.rescore(folder)[1] if records else None
    lines = tuple(_line(number, one) for number, one in enumerate(records) if wanted.fits(one))
    view = RunView(
        folder=str(folder),
        name=plan.name,
        done=len(records),
        total=total,
        result=so_far if whole and not plan.shard else None,
        trials=lines,
        next=tuple(_next(folder, plan, records, whole=whole)),
    )
    return view, so_far


def _line(number: int, record: TrialRecord) -> TrialLine:
    spec, first = record.spec, record.faults[0] if record.faults else None
    return TrialLine(
        number=number,
        key=record.key,
        task=spec.task.id,
        house=spec.task.house,
        participant=spec.participant,
        met=record.met,
        time_s=round(record.ticks * rules.TICK_S, 1),
        sent=int(record.metrics["sent"] or 0),
        accepted=int(record.metrics["accepted"] or 0),
        trust=record.trust,
        fault=f"{first.kind} at {first.tick * rules.TICK_S:.1f} s" if first else "",
    )


def _next(folder: Path, plan: RunConfig, records: Sequence[TrialRecord], *, whole: bool) -> Iterator[str]:
    """Commands that continue from here."""
    run = shlex.quote(str(folder))
    if not whole:
        yield cli_command.resume_command(folder, plan)
    faulty = next((number for number, one in enumerate(records) if one.faults), None)
    if faulty is not None and (again := fault_report.rerun_command(folder, records[faulty].key)):
        yield again
    if records:
        yield f"hthor replay {run} {0 if faulty is None else faulty}"
    if whole and not plan.shard:
        yield f"hthor report {run}"
