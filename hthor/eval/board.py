"""The leaderboard: one file an entry, and a list of them in canonical form; knows nothing of how runs are played."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import jsonio
from hthor.detectors import OWN
from hthor.errors import RunError
from hthor.eval import score
from hthor.eval.peoples import HumansRef
from hthor.eval.score import Counts, Hashes, Scores
from hthor.eval.setup import PROCEDURAL, AssetsRef, KindRef, Setup, SuiteRef
from hthor.eval.shard import whole_folder
from hthor.types import RobotSeat

ENTRY_SCHEMA = "hthor.entry/4"
SCHEMA = "hthor.leaderboard/4"


class Entry(Struct, frozen=True, kw_only=True):
    """A whole run on the board. ``id`` is its file's name without the ending."""

    schema: str = ENTRY_SCHEMA
    id: str
    name: str
    robots: tuple[RobotSeat, ...]
    humans: HumansRef
    suite: SuiteRef
    kind: KindRef | None = None
    seed: int
    participants: int
    metrics: Scores
    counts: Counts
    versions: dict[str, str]
    hashes: Hashes
    assets: AssetsRef


class Board(Struct, frozen=True, kw_only=True):
    """Every entry, by suite and then by success, best first."""

    schema: str = SCHEMA
    entries: tuple[Entry, ...]


def add(folder: Path, board: Path) -> tuple[Entry, Path]:
    """Put a run on the board, scored anew from its log: its entry and the entry's file. Twice is the same as once.

    Raises:
        RunError: when the run is not whole.
    """
    plan, result, _ = score.rescore(folder)
    missing = plan.trials - result.counts.trials
    if missing:
        raise RunError(
            f"{folder} lacks {missing} of its {plan.trials} trials, and only whole runs go on the board. Finish it: "
            f"{command(folder, plan)}"
        )
    entry = Entry(
        id=plan.folder_name,
        name=result.name,
        robots=result.robots,
        humans=result.humans,
        suite=result.suite,
        kind=result.kind,
        seed=result.seed,
        participants=result.participants,
        metrics=result.metrics,
        counts=result.counts,
        versions=result.versions,
        hashes=result.hashes,
        assets=result.assets,
    )
    path = board / "entries" / f"{entry.id}.json"
    jsonio.write(path, jsonio.pretty(entry))
    rebuild(board)
    return entry, path


def rebuild(board: Path) -> Board:
    """Write `leaderboard.json` from the entries' files: the same files give the same bytes."""
    entries = [_read(path) for path in sorted((board / "entries").glob("*.json"))]
    entries.sort(key=lambda entry: (entry.suite.name, entry.suite.sha256, -(entry.metrics.sr.mean or 0.0), entry.id))
    document = Board(entries=tuple(entries))
    jsonio.write(board / "leaderboard.json", jsonio.pretty(document))
    return document


def _read(path: Path) -> Entry:
    try:
        entry = msgspec.json.decode(path.read_bytes(), type=Entry)
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise RunError(f"{path}: {error}. Delete the file, or add its run again.") from None
    if entry.id != path.stem:
        raise RunError(f"{path}: id is '{entry.id}', but must be the file's name, '{path.stem}'.")
    return entry


def command(folder: Path, plan: Setup) -> str:
    """The command that finishes a run, or a shard of one."""
    parts = [f"hthor eval{_who(plan.robots)} --humans {plan.humans.source}"]
    if plan.kind is not None and plan.kind.sha256:
        parts.append(f"--kind {plan.kind.name}.py")
        parts += [] if (folder / "suite.json").exists() else [f"--suite {plan.suite.name}"]
    else:
        parts.append(f"--suite {plan.suite.name}" + (f" --kind {plan.kind.name}" if plan.kind else ""))
    parts += [] if plan.assets.name == PROCEDURAL else [f"--assets {plan.assets.name}"]
    detector = next((robot.detector for robot in plan.seats), OWN)
    parts += [] if detector == OWN else [f"--detector {detector}"]
    parts += ["--realtime"] if plan.realtime else []
    parts.append(f"--seed {plan.seed} --participants {plan.participants}")
    parts.append(f"--shard {plan.shard.words} --out {whole_folder(folder)}" if plan.shard else f"--out {folder}")
    return " ".join(parts)


def _who(robots: Sequence[RobotSeat]) -> str:
    """The options that name these robots."""
    minds = [
        robot.agent.name if robot.agent.source.startswith("hthor.agents.") else robot.agent.source for robot in robots
    ]
    bodies = [f"{robot.robot}.py" if robot.robot_sha256 else robot.robot for robot in robots]
    if len(robots) == 1:
        return f" --agent {minds[0]}" + (f" --robot {bodies[0]}" if bodies[0] else "")
    # a mind that wants no robot may have been asked for with any body
    pairs = (f"{body or 'scout'}:{mind}" for body, mind in zip(bodies, minds, strict=True))
    return f" --robots {','.join(pairs)}"
