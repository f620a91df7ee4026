"""Lists for people who look through results: the runs below a folder, and one run with its trials."""

import datetime
import os
import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path

from msgspec import Struct

from hthor import code_identity, rules
from hthor.episode import task_part
from hthor.errors import HthorError
from hthor.eval.config import cli_command
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records import attempts, corrected_log
from hthor.eval.records.attempts import VoidedTrial
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.results import aggregate, applied_corrections, result_file
from hthor.eval.results.result_file import RunResult
from hthor.eval.runner import fault_report
from hthor.log_corrections import CorrectAdoption, VoidTrial

LIST_SCHEMA, VIEW_SCHEMA = "hthor.runs/1", "hthor.run-view/2"
_DEPTH = 6


class RunSummary(Struct, frozen=True, kw_only=True):
    """A run, as the files in its folder describe it.

    ``folder`` is relative to the folder that was searched, ``name`` is the user's or the agents', ``agents`` and
    ``bodies`` describe the robots in the order of their seats. ``success`` is the share of the trials played so far in
    which the goal was met, None before the first; ``faults`` the trials in which an agent failed; ``when`` the time of
    the last change, in UTC. ``problem`` says why a run cannot be read; other fields are then empty.
    """

    folder: str
    name: str = ""
    agents: tuple[str, ...] = ()
    bodies: tuple[str, ...] = ()
    suite: str = ""
    people: str = ""
    seed: int | None = None
    done: int = 0
    total: int = 0
    success: float | None = None
    faults: int = 0
    when: str = ""
    sha256: str = ""
    problem: str = ""


class RunList(Struct, frozen=True, kw_only=True):
    """The document of `hthor runs list`: all runs below a folder, sorted by last change, latest first."""

    schema: str = LIST_SCHEMA
    runs: tuple[RunSummary, ...]


def list_runs(folder: Path) -> RunList:
    """Every run in and below a folder; a run that cannot be read is listed with the reason."""
    found = [_seen(run, folder) for run in _folders(folder, _DEPTH)]
    found.sort(key=lambda one: one.folder)
    return RunList(runs=tuple(sorted(found, key=lambda one: one.when, reverse=True)))


def _folders(folder: Path, depth: int) -> Iterator[Path]:
    """Folders with a `run.json`, this one included; hidden folders and links are skipped."""
    if (folder / "run.json").is_file():
        yield folder
    if not depth:
        return
    try:
        inner = sorted(entry.path for entry in os.scandir(folder) if entry.is_dir(follow_symlinks=False))
    except OSError:
        return
    for path in map(Path, inner):
        if not path.name.startswith("."):
            yield from _folders(path, depth - 1)


def _seen(run: Path, root: Path) -> RunSummary:
    where = str(run.relative_to(root)) if run != root else str(run)
    when = _when(run)
    try:
        plan = RunFolder(run).config
        done, met, faults = _tally(run, plan)
    except (HthorError, OSError, ValueError, RecursionError) as error:
        return RunSummary(folder=where, when=when, problem=" ".join(str(error).split()))
    return RunSummary(
        folder=where,
        name=plan.name,
        agents=tuple(robot.agent.name for robot in plan.robots),
        bodies=tuple(robot.robot for robot in plan.seats),
        suite=plan.suite.name + (f" ({plan.limit})" if plan.limit else ""),
        people=plan.humans.name,
        seed=plan.seed,
        done=done,
        total=plan.expected_trials,
        success=round(met / done, 6) if done else None,
        faults=faults,
        when=when,
        sha256=plan.sha256,
    )


def _tally(run: Path, plan: RunConfig) -> tuple[int, float, int]:
    """Trials played, trials in which the goal was met, and trials with a fault: from the result, or else the log."""
    result = None if plan.shard else result_file.load_current(run)
    if result is not None and result.hashes.run == plan.sha256:
        return result.counts.trials, float(result.counts.successes), result.counts.faults
    kept = attempts.select_records(record for _, record in corrected_log.read(run / "trials.jsonl"))
    return len(kept), float(sum(one.met for one in kept)), sum(bool(one.faults) for one in kept)


def _when(run: Path) -> str:
    """The time of the last trial or, before the first, of the configuration."""
    for name in ("trials.jsonl", "run.json"):
        try:
            changed = (run / name).stat().st_mtime
        except OSError:
            continue
        return datetime.datetime.fromtimestamp(changed, datetime.UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    return ""


class TrialFilter(Struct, frozen=True, kw_only=True):
    """Which trials to list; an empty or None field takes all."""

    task: str = ""
    kind: str = ""
    house: str = ""
    participant: int | None = None
    met: bool | None = None
    faulty: bool | None = None

    def fits(self, record: ScoredTrial) -> bool:
        """Whether the filter takes a trial."""
        task = record.spec.task
        return (
            (not self.task or self.task in (task.id, task.goal.target))
            and (not self.kind or self.kind == task.kind)
            and (not self.house or self.house == task.house)
            and (self.participant is None or any(one.participant == self.participant for one in record.spec.humans))
            and self.met in (None, record.met)
            and self.faulty in (None, bool(record.faults))
        )


class TrialLine(Struct, frozen=True, kw_only=True):
    """A trial in one line. ``number``: its place in the run, as `hthor replay` takes it; ``fault``: its first fault."""

    number: int
    key: str
    task: str
    house: str
    session: int
    met: bool
    time_s: float
    sent: int
    accepted: int
    trust: float | None
    fault: str


class RunView(Struct, frozen=True, kw_only=True):
    """The document of `hthor runs view`. ``result`` is None while trials are missing, or if none was played.

    ``voided`` lists the attempts that do not count, ``corrections`` the corrections in effect. Trials that a correction
    voided for good are not among the ``total``.
    """

    schema: str = VIEW_SCHEMA
    folder: str
    name: str
    done: int
    total: int
    result: RunResult | None
    trials: tuple[TrialLine, ...]
    voided: tuple[VoidedTrial, ...]
    corrections: tuple[VoidTrial | CorrectAdoption, ...] = ()
    next: tuple[str, ...]


def view_run(folder: Path, wanted: TrialFilter) -> tuple[RunView, RunResult | None]:
    """A run, and its result so far, which is preliminary while trials are missing.

    Raises:
        RunError: when the folder holds no run, or the run cannot be read.
    """
    run = RunFolder(folder)
    plan = run.config
    played = run.played()
    records = [one for one in played if not one.log.voided]
    total = plan.expected_trials - run.given_up
    whole = len(records) >= total
    stored = result_file.load_current(folder)
    fresh = (
        stored is not None
        and (stored.corrections or None) == applied_corrections.applied(run)
        and stored.hashes.scoring == code_identity.scoring_sha256()
    )
    so_far = stored if whole and fresh else aggregate.rescore(folder)[1] if records else None
    lines = tuple(_line(number, one) for number, one in enumerate(played) if not one.log.voided and wanted.fits(one))
    view = RunView(
        folder=str(folder),
        name=plan.name,
        done=len(records),
        total=total,
        result=so_far if whole and not plan.shard else None,
        trials=lines,
        voided=run.voided,
        corrections=run.corrections.in_effect,
        next=tuple(_next(folder, plan, records, whole=whole)),
    )
    return view, so_far


def _line(number: int, record: ScoredTrial) -> TrialLine:
    spec, first = record.spec, record.faults[0] if record.faults else None
    return TrialLine(
        number=number,
        key=record.key,
        task=spec.task.id,
        house=spec.task.house,
        session=spec.session,
        met=record.met,
        time_s=round(task_part(record.log).ticks * rules.TICK_S, 1),
        sent=int(record.metrics["sent"] or 0),
        accepted=int(record.metrics["accepted"] or 0),
        trust=record.metrics["trust"],
        fault=f"{first.kind} at {first.tick * rules.TICK_S:.1f} s" if first else "",
    )


def _next(folder: Path, plan: RunConfig, records: Sequence[ScoredTrial], *, whole: bool) -> Iterator[str]:
    """Commands that the user may want to give next."""
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
