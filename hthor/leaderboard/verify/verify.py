"""Verifies an entry: replays a sample of its trials and compares them, and runs its agent on fresh tasks."""

import hashlib
from collections.abc import Sequence
from pathlib import Path

import msgspec

from hthor import jsonio
from hthor.errors import HthorError
from hthor.eval.config import task_selection
from hthor.eval.records import platform
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.leaderboard import board_check
from hthor.leaderboard.entries import entry_metrics, files, invariants, trial_outcomes, verification
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.files import BoardError, Problem
from hthor.leaderboard.entries.verification import Replayed, Tier, Verification
from hthor.leaderboard.verify import detection_power, fresh_tasks, replay, verdict
from hthor.leaderboard.verify.replay import Request
from hthor.leaderboard.verify.verdict import ReplayedTrials
from hthor.types.specs import LOCKSTEP

SAMPLE = 200
"""How many trials are drawn to be compared one by one; if the agent is not deterministic, all are drawn."""


def verify_entry(path: Path, board: Path, request: Request) -> tuple[Entry, Verification]:
    """Replay samples of the entry's and its control's trials, and play fresh tasks; return the entry and the result.

    Raises:
        BoardError: if the entry's file is not valid, does not belong to the given agent and suite, or does not record
        its platform; or if a trial could not be played.
    """
    if not request.word:
        raise HthorError(
            "--draw is empty; it takes a public random value, such as the hash of a commit made after submission."
        )
    if not path.is_file():
        raise BoardError(f"{path} is not a file; give an entry, such as leaderboard/entries/NAME.json.")
    files.raise_problems(board_check.check_board(board, [path]))
    entry = files.read_entry(path)
    _measured_alike(entry)
    _noted(entry, request)
    _sorts(path, entry, request)
    drawn = draw_sample(request.word, entry.digest, entry.trials.count, _size(entry, request))
    control = verification.find_control(board, entry)
    if control is not None:
        _measured_alike(control)
    found = Verification(
        id=entry.id,
        entry=entry.digest,
        draw=request.word,
        trials=_replayed(entry, drawn, request),
        control=None if control is None else _replayed(control, drawn, request),
        official=request.official,
        platform=jsonio.sha256(platform.this_platform()),
        by=request.by,
        date=request.date,
    )
    if found.refuted or not request.fresh:
        return entry, found
    return entry, msgspec.structs.replace(found, fresh=fresh_tasks.verify_fresh_tasks(entry, board, request))


def draw_sample(word: str, digest: str, count: int, size: int) -> list[int]:
    """``size`` of the numbers below ``count``, or all of them if there are not more; sorted.

    Args:
        word: a public random text from after the submission, such as the hash of a later commit.
        digest: of the entry, so that the same word gives each entry a different sample.
    """
    key = hashlib.sha256(f"hthor draw\n{word}\n{digest}\n".encode()).digest()

    def lot(number: int) -> bytes:
        return hashlib.sha256(key + number.to_bytes(8, "little")).digest()

    return sorted(sorted(range(count), key=lot)[:size])


def _replayed(entry: Entry, drawn: Sequence[int], request: Request) -> Replayed:
    return judge_replay(entry, drawn, replay.replay_trials(entry, drawn, request))


def judge_replay(entry: Entry, drawn: Sequence[int], again: dict[int, tuple[ScoredTrial, bytes]]) -> Replayed:
    """The verdict on these records, and the probability that a forged entry would have failed."""
    here = platform.this_platform()
    by = entry_tier(entry)
    places = sorted(again)
    held = trial_outcomes.make_outcomes(
        [again[place][0] for place in places], [trial_outcomes.leaf_hash(again[place][1]) for place in places]
    )
    new = ReplayedTrials(
        rows=dict(zip(places, held.rows, strict=True)),
        met=dict(zip(places, held.met.tolist(), strict=True)),
        twsr=dict(zip(places, held.twsr.tolist(), strict=True)),
    )
    participants = entry_metrics.trial_participants(entry.trials.count, entry.run.participants)
    claimed = trial_outcomes.unpack(entry.trials)
    found = verdict.judge_trials(by, claimed, new, drawn, participants)
    return Replayed(
        tier=by,
        passed=found.passed,
        drawn=len(drawn),
        compared=found.compared,
        equal=found.equal,
        same_bytes=found.same_bytes,
        caught=detection_power.detection_probability(by, claimed, new, drawn, participants),
        why=f"{_grounds(by, entry, here)}: {found.why}.",
    )


def entry_tier(entry: Entry) -> Tier:
    """How the entry can be compared with trials that are played on this machine."""
    repeats = entry.alone or (entry.agent.deterministic and entry.mode == LOCKSTEP)
    return verdict.choose_tier(repeats=repeats, same_platform=entry.platforms == (platform.this_platform(),))


def _size(entry: Entry, request: Request) -> int:
    if request.sample is not None:
        return request.sample
    return entry.trials.count if entry_tier(entry) == "V3" else SAMPLE


def _measured_alike(entry: Entry) -> None:
    """Require outcomes that were measured by the present metrics: a difference of scoring refutes nobody."""
    there, here = entry.trials.metrics_sha256, trial_outcomes.metrics_sha256()
    if there and there != here:
        raise BoardError(
            f"{entry.id}: trials.metrics_sha256: is {there[:10]}, and here it is {here[:10]}: the outcomes were "
            "measured by other metrics than those here. 'hthor leaderboard add RUN' measures them again from the run's "
            "log; or use the version of hthor that made the entry."
        )


def _noted(entry: Entry, request: Request) -> None:
    """Require the platform, except in the official run: without it only outcomes are compared, which proves less."""
    if not entry.platforms and not request.official:
        raise BoardError(
            f"{entry.id}: platforms: is empty, so no record can be compared byte for byte. Run it with this "
            "version, which records the platform, or have the official workflow run it (--official)."
        )


def _sorts(path: Path, entry: Entry, request: Request) -> None:
    """Check the entry's outcomes against the suite's tasks, which are known here even if the suite is secret."""
    suite = task_selection.select_tasks(request.suite or entry.run.suite.name, "").suite
    if suite.sha256 == entry.run.suite.sha256:
        laws = invariants.check_outcomes(
            entry, trial_outcomes.unpack(entry.trials), trial_outcomes.tasks_of_trials(suite, entry)
        )
        files.raise_problems(Problem(file=str(path), field=field, problem=problem) for field, problem in laws)


def _grounds(by: Tier, entry: Entry, here: dict[str, str]) -> str:
    if by == "V1":
        return "the same platform"
    if by == "V2":
        if len(entry.platforms) != 1:
            return "several platforms" if entry.platforms else "a platform that was not noted"
        return f"another platform ({'; '.join(platform.platform_differences(entry.platforms[0], here))})"
    return "thinking takes time" if entry.mode != LOCKSTEP else "the agent does not claim to repeat itself"
