"""Whether an entry can be believed: drawn after it was handed in, played again, compared, and tried on fresh tasks."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import jsonio
from hthor.errors import HthorError
from hthor.eval.config import task_selection
from hthor.eval.records import platform
from hthor.eval.records.trial_record import TrialRecord
from hthor.guest import AgentInputs
from hthor.leaderboard import board_check
from hthor.leaderboard.entries import entry_metrics, files, invariants, trial_outcomes, trial_tasks, verification
from hthor.leaderboard.entries.entry import REALTIME, Entry
from hthor.leaderboard.entries.files import BoardError, Problem
from hthor.leaderboard.entries.verification import Replayed, Tier, Verification
from hthor.leaderboard.verify import detection_power, fresh_tasks, replay, trial_sample, verdict
from hthor.leaderboard.verify.verdict import Again

SAMPLE = 200
"""Trials that are drawn where outcomes are compared one by one; of an agent that does not repeat itself, all."""


class Request(Struct, frozen=True, kw_only=True):
    """What a verifier says: see `hthor leaderboard verify`.

    ``sample`` None draws `SAMPLE` trials, or all where the agent does not repeat itself; ``fresh`` 0 plays no fresh
    tasks.
    """

    word: str
    agent: str = ""
    given: AgentInputs | None = None
    suite: str = ""
    sample: int | None = None
    fresh: int = fresh_tasks.TASKS
    official: bool = False
    jobs: int | None = None
    require_isolation: str = ""
    by: str = ""
    date: str = ""


def verify(path: Path, board: Path, request: Request) -> tuple[Entry, Verification]:
    """Play a sample of an entry's trials and of its control's again, and fresh tasks: the entry, and what came of it.

    Raises:
        BoardError: when the entry's file is not in order, or is not of what is given here; when it says too little of
            where it was played; when a trial could not be played.
    """
    if not request.word:
        raise HthorError("--draw is empty; it takes public chance, such as the hash of a commit made after submission.")
    if not path.is_file():
        raise BoardError(f"{path} is no file; an entry is one, such as leaderboard/entries/NAME.json.")
    files.refuse(board_check.problems(board, [path]))
    entry = files.read(path)
    _noted(entry, request)
    _sorts(path, entry, request)
    drawn = trial_sample.sample(request.word, entry.digest, entry.trials.count, _size(entry, request))
    control = verification.control_of(board, entry)
    found = Verification(
        id=entry.id,
        entry=entry.digest,
        draw=request.word,
        trials=replayed(entry, drawn, _again(entry, drawn, request)),
        control=None if control is None else replayed(control, drawn, _again(control, drawn, request)),
        official=request.official,
        platform=jsonio.sha256(platform.this_platform()),
        by=request.by,
        date=request.date,
    )
    if found.refuted or not request.fresh:
        return entry, found
    fresh = fresh_tasks.verify(
        entry,
        board,
        request.word,
        request.fresh,
        agent=request.agent,
        jobs=request.jobs,
        required=request.require_isolation,
        given=request.given,
    )
    return entry, msgspec.structs.replace(found, fresh=fresh)


def replayed(entry: Entry, drawn: Sequence[int], again: dict[int, tuple[TrialRecord, bytes]]) -> Replayed:
    """The verdict over these records, and how surely it would have been another over a forged entry."""
    here = platform.this_platform()
    by = tier(entry)
    places = sorted(again)
    held = trial_outcomes.of(
        [again[place][0] for place in places], [trial_outcomes.leaf(again[place][1]) for place in places]
    )
    new = Again(
        rows=dict(zip(places, held.rows, strict=True)),
        met=dict(zip(places, held.met.tolist(), strict=True)),
        twsr=dict(zip(places, held.twsr.tolist(), strict=True)),
    )
    whose = entry_metrics.people(entry.trials.count, entry.run.participants)
    claimed = trial_outcomes.unpack(entry.trials)
    found = verdict.judge(by, claimed, new, drawn, whose)
    return Replayed(
        tier=by,
        passed=found.passed,
        drawn=len(drawn),
        compared=found.compared,
        equal=found.equal,
        same_bytes=found.same_bytes,
        caught=detection_power.chance(by, claimed, new, drawn, whose),
        why=f"{_grounds(by, entry, here)}: {found.why}.",
    )


def tier(entry: Entry) -> Tier:
    """How an entry can be compared with what is played here."""
    repeats = entry.alone or (entry.agent.deterministic and entry.mode != REALTIME)
    return verdict.tier(repeats=repeats, same_platform=entry.platforms == (platform.this_platform(),))


def _size(entry: Entry, request: Request) -> int:
    if request.sample is not None:
        return request.sample
    return entry.trials.count if tier(entry) == "V3" else SAMPLE


def _noted(entry: Entry, request: Request) -> None:
    """Only the official run may leave out where an entry was played: a comparison of outcomes is the lower bar."""
    if not entry.platforms and not request.official:
        raise BoardError(
            f"{entry.id}: platforms: is empty, so no record can be compared byte for byte. Play the run with this "
            "version, which notes the platform, or have the official workflow play it (--official)."
        )


def _sorts(path: Path, entry: Entry, request: Request) -> None:
    """What the entry says of its tasks against the suite, which is at hand here even when it is secret."""
    suite = task_selection.select_tasks(request.suite or entry.run.suite.name, "").suite
    if suite.sha256 == entry.run.suite.sha256:
        laws = invariants.outcomes(entry, trial_outcomes.unpack(entry.trials), trial_tasks.tasks(suite, entry))
        files.refuse(Problem(file=str(path), field=field, problem=problem) for field, problem in laws)


def _again(entry: Entry, drawn: Sequence[int], request: Request) -> dict[int, tuple[TrialRecord, bytes]]:
    return replay.play(
        entry,
        drawn,
        agent=request.agent,
        suite=request.suite,
        jobs=request.jobs,
        require_isolation=request.require_isolation,
        given=request.given,
    )


def _grounds(by: Tier, entry: Entry, here: dict[str, str]) -> str:
    if by == "V1":
        return "the same platform"
    if by == "V2":
        if len(entry.platforms) != 1:
            return "several platforms" if entry.platforms else "a platform that was not noted"
        return f"another platform ({'; '.join(platform.platform_differences(entry.platforms[0], here))})"
    return "thinking takes time" if entry.mode == REALTIME else "the agent does not claim to repeat itself"
