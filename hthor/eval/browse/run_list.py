"""The runs below a folder, each with its progress and its success rate."""

import datetime
import os
from collections.abc import Iterator
from pathlib import Path

from msgspec import Struct

from hthor.errors import HthorError
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records import trial_log
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import result_file

SCHEMA = "hthor.runs/1"
_DEPTH = 6


class RunSummary(Struct, frozen=True, kw_only=True):
    """A run as it lies in its folder.

    ``folder`` is as seen from the folder that was searched, ``name`` the user's or the agents', ``agents`` and
    ``bodies`` the robots in the order of their seats. ``success`` is the share of the trials played so far in which the
    goal was met, None before the first; ``faults`` the trials in which an agent failed; ``when`` the time of the last
    change, in UTC. ``problem`` says why a run cannot be read; the rest then is empty.
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
    """The document of `hthor runs list`: all runs below a folder, the one that changed last first."""

    schema: str = SCHEMA
    runs: tuple[RunSummary, ...]


def list_runs(folder: Path) -> RunList:
    """Every run in and below a folder; a run that cannot be read is listed with the reason."""
    found = [_seen(run, folder) for run in _folders(folder, _DEPTH)]
    found.sort(key=lambda one: one.folder)
    return RunList(runs=tuple(sorted(found, key=lambda one: one.when, reverse=True)))


def _folders(folder: Path, depth: int) -> Iterator[Path]:
    """Folders with a `run.json`, this one included; hidden folders and links are not looked into."""
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
        total=plan.shard.trials if plan.shard else plan.trials,
        success=round(met / done, 6) if done else None,
        faults=faults,
        when=when,
        sha256=plan.sha256,
    )


def _tally(run: Path, plan: RunConfig) -> tuple[int, float, int]:
    """Trials played, trials in which the goal was met, and trials with a fault: of the result, or else of the log."""
    result = None if plan.shard or result_file.is_outdated(run / "result.json") else result_file.load_result(run)
    if result is not None and result.metrics["sr"].mean is not None and result.hashes.run == plan.sha256:
        trials = result.counts.trials
        return trials, result.metrics["sr"].mean * trials, result.counts.faults
    last: dict[str, TrialRecord] = {record.key: record for _, record in trial_log.read(run / "trials.jsonl")}
    kept = last.values()
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
