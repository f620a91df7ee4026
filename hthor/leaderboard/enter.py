"""Makes an entry from a run's folder; the scores are computed from the run's log."""

import itertools
import re
import subprocess
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import msgspec

import hthor
from hthor import code_identity
from hthor.errors import HthorError, RunError
from hthor.eval.config import cli_command, task_selection
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import aggregate, baseline
from hthor.guest import Manifest
from hthor.leaderboard import board_check
from hthor.leaderboard.entries import entry_metrics, files, invariants, overrides, trial_outcomes, verification
from hthor.leaderboard.entries.entry import Agent, Counts, Entry, Harness, Hashes, Metrics
from hthor.leaderboard.entries.files import BoardError
from hthor.leaderboard.ranking import admission
from hthor.leaderboard.submission.submission import Submission

_SHOWN = 3
_PACKAGE = Path(hthor.__file__).resolve().parent
OURS = "hthor.agents."
"""Package of hthor's own agents, whose entries are references."""


def add_runs(folder: Path, board: Path, submission: Submission | None = None) -> list[tuple[Entry, Path]]:
    """Add a run, or every run in a folder of runs, to the board; return the entries and their files.

    The control of each run is added too if the board does not have it. Adding a run twice changes nothing. The list is
    not rebuilt.

    Raises:
        RunError: if there is no run, or a run is incomplete or has no control.
        BoardError: if the run has settings other than the benchmark's, or its entry is not valid;
        then nothing is written.
    """
    made: dict[Path, Entry] = {}
    for run in _runs(folder):
        config = RunFolder(run).config
        beside = baseline.baseline_folder(run, config)
        for each in (run, *([beside] if beside else [])):
            made[each] = made.get(each) or make_entry(each, submission if each == run else None)
    added = {entry.id: (entry, board / files.ENTRIES / f"{entry.id}.json") for entry in made.values()}
    new = {path: entry for entry, path in added.values() if not _there(entry, path)}
    _refuse(board, new)
    _struck(board, new.values())
    if not (board / admission.NAME).is_file():
        files.write_document(board / admission.NAME, admission.default_admission())
    for path, entry in new.items():
        files.write_document(path, entry)
    return list(added.values())


def make_entry(folder: Path, submission: Submission | None = None) -> Entry:
    """Make the entry of one run."""
    run = RunFolder(folder)
    config = run.config
    if corrections := run.corrections.in_effect:
        raise BoardError(
            f"{folder} has {len(corrections)} corrections in effect, and cannot stand on the leaderboard: an entry is "
            f"what a machine plays again, and a correction is a person's judgement. 'hthor correct {folder}' lists "
            "them; withdraw them, or play the run again into another folder."
        )
    lines, records = run.lines()
    _whole(folder, config, len(records))
    if run.voided:
        raise BoardError(
            f"{folder} has {len(run.voided)} voided trials, and cannot stand on the leaderboard: whoever voids a trial "
            "knows how it went. Play it again into another folder."
        )
    found = overrides.overridden_settings(config, _crew(config), len({one.spec.task.id for one in records}))
    if found:
        raise BoardError(overrides.refusal(folder, config, found))
    gain = baseline.measure_uplift(folder, config, records)
    if gain is None and config.seats:
        raise RunError(
            f"{folder} has no baseline, a run of the same people without a robot. 'hthor eval' plays one unless "
            "--no-control is given."
        )
    held = run.isolation
    result = aggregate.make_result(config, lines, records, uplift=gain, isolation=held, replays=run.restarts)
    columns = trial_outcomes.make_outcomes(records, map(trial_outcomes.leaf_hash, lines))
    participants = entry_metrics.trial_participants(len(records), config.participants)
    agent = submission.agent if submission else Agent(name=config.team_name)
    _same_files(folder, result.agents, submission)
    return Entry(
        id=f"{_slug(agent.name)}-{_slug(Path(config.suite.name).name)}-{config.sha256[:10]}",
        reference=all(robot.agent.source.startswith(OURS) for robot in config.robots),
        agent=agent,
        submission=submission.name if submission else "",
        files=submission.files if submission else (),
        agents=result.agents,
        run=config.untitled,
        hashes=Hashes(run=config.sha256, trials=result.hashes.trials, merkle=columns.merkle),
        harness=current_harness(),
        mode=result.mode,
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
        scoring_sha256=code_identity.scoring_sha256(),
        metrics=Metrics(**entry_metrics.entry_scores(columns, participants, alone=not config.seats)),
        splits=entry_metrics.split_scores(columns, participants),
        uplift=gain,
        trials=trial_outcomes.pack(columns),
    )


def _runs(folder: Path) -> list[Path]:
    if (folder / "run.json").is_file():
        return [folder]
    found = [path.parent for path in sorted(folder.glob("*/run.json"))]
    if not found:
        raise RunError(
            f"{folder} is neither a run's folder nor a folder of runs: it has no run.json. 'hthor eval' makes one."
        )
    return found


def _refuse(board: Path, made: Mapping[Path, Entry]) -> None:
    """Check entries before they are on the board: an invalid entry would prevent building the board."""
    with tempfile.TemporaryDirectory() as drafts:
        drawn = {Path(drafts) / path.name: path for path in made}
        for draft, path in drawn.items():
            files.write_document(draft, made[path])
        found = board_check.check_board(board, tuple(drawn))
    files.raise_problems(msgspec.structs.replace(one, file=str(drawn[Path(one.file)])) for one in found)


def _whole(folder: Path, config: RunConfig, there: int) -> None:
    if config.shard:
        raise RunError(f"{folder} is a shard of a run, and only whole runs go on the board. 'hthor merge' makes one.")
    if config.trials != there:
        raise RunError(
            f"{folder} lacks {config.trials - there} of its {config.trials} trials; only whole runs go on the board. "
            f"Finish it: {cli_command.resume_command(folder, config)}"
        )
    if config.code_sha256 != (here := code_identity.code_sha256(config.humans.models, config.kinds or ())):
        raise RunError(
            f"{folder / 'run.json'}: code_sha256 is {config.code_sha256[:10]}, and here it is {here[:10]}: it was run "
            "with a different version of hthor. Add it with that version, or run it again."
        )


def _crew(config: RunConfig) -> tuple[str, ...]:
    """The robots that the suite is made for; the tasks of official suites are for the scout."""
    try:
        chosen = task_selection.select_tasks(config.suite.name, "")
    except HthorError:
        return ("scout",)
    return chosen.robots


def _same_files(folder: Path, agents: Sequence[Manifest], submission: Submission | None) -> None:
    if submission is None:
        return
    if len(agents) != 1:
        raise BoardError(f"{folder / 'run.json'}: agents: has {len(agents)} agents, but a submission is one agent.")
    found = invariants.foreign_files(agents[0].files, submission.files)
    if found:
        raise BoardError(
            f"{folder / 'run.json'}: agents[0].files: differs from what is in {submission.path.parent}: "
            f"{'; '.join(found)}. Run the agent that was submitted."
        )


def _there(entry: Entry, path: Path) -> bool:
    """Whether the board already has this entry, no matter at which commit it was added.

    An entry of the same log whose outcomes were measured by other metrics than the present ones is brought up to date.

    Raises:
        BoardError: if it has a different entry of the same run, which may be the true one and is not overwritten.
    """
    if not path.is_file():
        return False
    there = files.read_entry(path)
    if there.digest == msgspec.structs.replace(entry, harness=there.harness).digest:  # whichever commit adds it
        return True
    same_log = there.hashes.trials == entry.hashes.trials and there.trials.leaves == entry.trials.leaves
    if same_log and there.trials.metrics_sha256 != entry.trials.metrics_sha256:
        return False
    other = itertools.islice(invariants.differences("", there, entry), _SHOWN)
    shown = "; ".join(f"{field.lstrip('.')} {problem}" for field, problem in other)
    raise BoardError(
        f"{path}: the board has another entry of this run, and it is not "
        f"overwritten{f' ({shown})' if shown else ''}. "
        "'hthor leaderboard verify' finds out which is true; to replace the old one, the board's keeper deletes its "
        "file first."
    )


def _struck(board: Path, new: Iterable[Entry]) -> None:
    kept = verification.load_records(board)
    for entry in new:
        if (struck := kept.refutation_of(entry)) is not None:
            raise BoardError(
                f"{entry.id}: this run was refuted on this board, as {struck.id}: {struck.why} The board's keeper can "
                "verify an entry of the agent's true results."
            )


def _slug(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_+.-]+", "-", name).strip("-.")[:60] or "agent"


def current_harness(package: Path = _PACKAGE) -> Harness:
    """Version, commit and state of the hthor in this process; the commit is the last one that changed the package."""
    commit = _git(package, "log", "-1", "--format=%H", "--", ".") or ""
    changed = _git(package, "status", "--porcelain", "--", ".") if commit else ""
    return Harness(version=hthor.__version__, commit=commit, dirty=bool(changed))


def _git(package: Path, *words: str) -> str | None:
    """The output of git; None if git is not installed or the package is in no repository."""
    try:
        done = subprocess.run(["git", "-C", str(package), *words], capture_output=True, text=True, check=False)
    except OSError:
        return None
    return done.stdout.strip() if done.returncode == 0 else None
