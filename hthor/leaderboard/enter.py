"""From a run's folder to an entry, scored anew from the run's log."""

from __future__ import annotations

import itertools
import re
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import msgspec

from hthor import code_identity
from hthor.errors import HthorError, RunError
from hthor.eval.config import cli_command, task_selection
from hthor.eval.config.run_config import RunConfig
from hthor.eval.metrics import trial_metrics
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import aggregate, baseline
from hthor.guest import Manifest
from hthor.leaderboard import board_check
from hthor.leaderboard.entries import entry_metrics, files, invariants, overrides, trial_outcomes, verification
from hthor.leaderboard.entries.entry import LOCKSTEP, REALTIME, Agent, Counts, Entry, Hashes, Metrics
from hthor.leaderboard.entries.files import BoardError
from hthor.leaderboard.ranking import admission
from hthor.leaderboard.submission import harness
from hthor.leaderboard.submission.submission import Submission

_SHOWN = 3
OURS = "hthor.agents."
"""Where agents come from that are references."""


def add(folder: Path, board: Path, submission: Submission | None = None) -> list[tuple[Entry, Path]]:
    """Put a run, or every run in a folder of runs, on the board: their entries and the entries' files.

    The control of each comes too when the board has none yet. Twice is the same as once. The list is not made anew.

    Raises:
        RunError: when there is no run, it is not whole, or has no control.
        BoardError: when it was played with settings that depart from the benchmark's, or its entry is not in order;
            then nothing is written.
    """
    made: dict[Path, Entry] = {}
    for run in _runs(folder):
        plan = RunFolder(run).config
        beside = baseline.baseline_folder(run, plan)
        for each in (run, *([beside] if beside else [])):
            made[each] = made.get(each) or of(each, submission if each == run else None)
    added = {entry.id: (entry, board / files.ENTRIES / f"{entry.id}.json") for entry in made.values()}
    new = {path: entry for entry, path in added.values() if not _there(entry, path)}
    _refuse(board, new)
    _struck(board, new.values())
    if not (board / admission.NAME).is_file():
        files.write(board / admission.NAME, admission.own())
    for path, entry in new.items():
        files.write(path, entry)
    return list(added.values())


def of(folder: Path, submission: Submission | None = None) -> Entry:
    """The entry of one run."""
    run = RunFolder(folder)
    plan = run.config
    lines, kept = run.lines()
    _whole(folder, plan, len(kept))
    found = overrides.of(plan, _crew(plan), len({one.spec.task.id for one in kept}))
    if found:
        raise BoardError(overrides.refusal(folder, plan, found))
    records = [msgspec.structs.replace(one, metrics=trial_metrics.measure(one.spec, one.log)) for one in kept]
    gain = baseline.measure_uplift(folder, plan, records)
    if gain is None and plan.seats:
        raise RunError(f"{folder} has no run without a robot beside it. 'hthor eval' plays it without --no-control.")
    held = run.isolation
    result = aggregate.make_result(plan, lines, records, uplift=gain, isolation=held, replays=run.restarts)
    columns = trial_outcomes.of(records, map(trial_outcomes.leaf, lines))
    whose = entry_metrics.people(len(records), plan.participants)
    agent = submission.agent if submission else Agent(name=plan.team_name)
    _same_files(folder, result.agents, submission)
    return Entry(
        id=f"{_slug(agent.name)}-{_slug(Path(plan.suite.name).name)}-{plan.sha256[:10]}",
        reference=all(robot.agent.source.startswith(OURS) for robot in plan.robots),
        agent=agent,
        submission=submission.name if submission else "",
        files=submission.files if submission else (),
        agents=result.agents,
        run=plan.untitled,
        hashes=Hashes(run=plan.sha256, trials=result.hashes.trials, merkle=columns.merkle),
        harness=harness.here(),
        mode=REALTIME if getattr(result, "mode", "") == REALTIME else LOCKSTEP,
        platforms=run.platforms,
        isolation=held,
        counts=Counts(
            trials=len(records),
            successes=result.counts.successes,
            messages=int(columns.sent.sum()),
            faults=result.counts.faults,
            faults_by_kind=result.counts.faults_by_kind,
            replays=result.counts.replays,
        ),
        metrics=Metrics(**entry_metrics.scores(columns, whose, alone=not plan.seats)),
        splits=entry_metrics.splits(columns, whose),
        uplift=gain,
        trials=trial_outcomes.pack(columns),
    )


def _runs(folder: Path) -> list[Path]:
    if (folder / "run.json").is_file():
        return [folder]
    found = [path.parent for path in sorted(folder.glob("*/run.json"))]
    if not found:
        raise RunError(
            f"{folder} is no run's folder, nor a folder of runs: no run.json is there. 'hthor eval' makes one."
        )
    return found


def _refuse(board: Path, made: Mapping[Path, Entry]) -> None:
    """Judge entries before they are on the board: one that is not in order would keep the board from being built."""
    with tempfile.TemporaryDirectory() as drafts:
        drawn = {Path(drafts) / path.name: path for path in made}
        for draft, path in drawn.items():
            files.write(draft, made[path])
        found = board_check.problems(board, tuple(drawn))
    files.refuse(msgspec.structs.replace(one, file=str(drawn[Path(one.file)])) for one in found)


def _whole(folder: Path, plan: RunConfig, there: int) -> None:
    if plan.shard:
        raise RunError(f"{folder} is a shard of a run, and only whole runs go on the board. 'hthor merge' makes one.")
    if plan.trials != there:
        raise RunError(
            f"{folder} lacks {plan.trials - there} of its {plan.trials} trials, and only whole runs go on the board. "
            f"Finish it: {cli_command.resume_command(folder, plan)}"
        )
    if plan.code_sha256 != (here := code_identity.code_sha256(plan.humans.model, plan.kinds)):
        raise RunError(
            f"{folder / 'run.json'}: code_sha256 is {plan.code_sha256[:10]}, and here it is {here[:10]}: another "
            "version of hthor played it, by which it has to be added. Or play it anew."
        )


def _crew(plan: RunConfig) -> tuple[str, ...]:
    """The bodies that the suite is made for; official ones have searches and deliveries, which are the scout's."""
    try:
        chosen = task_selection.select_tasks(plan.suite.name, "")
    except HthorError:
        return ("scout",)
    return chosen.robots


def _same_files(folder: Path, agents: Sequence[Manifest], submission: Submission | None) -> None:
    if submission is None:
        return
    if len(agents) != 1:
        raise BoardError(f"{folder / 'run.json'}: agents: has {len(agents)} agents, and a submission is one.")
    found = invariants.strangers(agents[0].files, submission.files)
    if found:
        raise BoardError(
            f"{folder / 'run.json'}: agents[0].files: is not what lies in {submission.path.parent}: "
            f"{'; '.join(found)}. Play the agent that was handed in."
        )


def _there(entry: Entry, path: Path) -> bool:
    """Whether the board has this very entry already, added by whichever commit.

    Raises:
        BoardError: when it has another of the same run, which is not written over: it may be the true one.
    """
    if not path.is_file():
        return False
    there = files.read(path)
    if there.digest == msgspec.structs.replace(entry, harness=there.harness).digest:  # whichever commit adds it
        return True
    other = itertools.islice(invariants.unlike("", there, entry), _SHOWN)
    told = "; ".join(f"{field.lstrip('.')} {problem}" for field, problem in other)
    raise BoardError(
        f"{path}: the board has another entry of this run, and it is not written over{f' ({told})' if told else ''}. "
        "'hthor leaderboard verify' tells which is true; to replace the old one, its keeper deletes the file first."
    )


def _struck(board: Path, new: Iterable[Entry]) -> None:
    kept = verification.load(board)
    for entry in new:
        if (struck := kept.struck(entry)) is not None:
            raise BoardError(
                f"{entry.id}: this run was refuted on this board, as {struck.id}: {struck.why} The board's keeper can "
                "verify an entry of what the agent truly did."
            )


def _slug(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_+.-]+", "-", name).strip("-.")[:60] or "agent"
