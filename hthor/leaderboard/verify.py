"""Whether an entry can be believed: a sample drawn after it was handed in, played again and compared."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import jsonio
from hthor.errors import HthorError
from hthor.eval import fingerprint
from hthor.eval.record import Record
from hthor.guest import Given
from hthor.leaderboard import checks, draw, files, outcomes, replay, verdict, worth
from hthor.leaderboard.entry import REALTIME, Entry, Verification
from hthor.leaderboard.verdict import Again

SAMPLE = 200
"""Trials that are drawn: of 200, one in 20 false ones escapes four times in 100,000."""


class Request(Struct, frozen=True, kw_only=True):
    """What a verifier says: see `hthor leaderboard verify`."""

    word: str
    agent: str = ""
    given: Given | None = None
    suite: str = ""
    sample: int = SAMPLE
    jobs: int | None = None
    require_isolation: str = ""
    by: str = ""
    date: str = ""


def verify(path: Path, board: Path, request: Request) -> tuple[Entry, Verification]:
    """Play a sample of an entry's trials again: the entry, and what came of it.

    Raises:
        BoardError: when the entry's file is not in order, or is not of what is given here.
    """
    if not request.word:
        raise HthorError("--draw is empty; it takes public chance, such as the hash of a commit made after submission.")
    if not path.is_file():
        raise files.BoardError(f"{path} is no file; an entry is one, such as leaderboard/entries/NAME.json.")
    files.refuse(checks.problems(board, [path]))
    entry = files.read(path)
    drawn = draw.sample(request.word, entry.digest, entry.trials.count, request.sample)
    again = replay.play(
        entry,
        drawn,
        agent=request.agent,
        suite=request.suite,
        jobs=request.jobs,
        require_isolation=request.require_isolation,
        given=request.given,
    )
    return entry, judged(entry, drawn, again, request)


def judged(
    entry: Entry, drawn: Sequence[int], again: dict[int, tuple[Record, bytes]], request: Request
) -> Verification:
    """The verdict over these records, for the entry's verification block."""
    here = fingerprint.here()
    by = verdict.tier(
        repeats=entry.agent.deterministic and entry.mode != REALTIME, same_platform=entry.platforms == (here,)
    )
    places = sorted(again)
    held = outcomes.of([again[place][0] for place in places], [outcomes.leaf(again[place][1]) for place in places])
    fresh = Again(
        rows=dict(zip(places, held.rows, strict=True)),
        met=dict(zip(places, held.met.tolist(), strict=True)),
        twsr=dict(zip(places, held.twsr.tolist(), strict=True)),
    )
    whose = worth.people(entry.trials.count, entry.run.participants)
    found = verdict.judge(by, outcomes.unpack(entry.trials), fresh, drawn, whose)
    return Verification(
        tier=by,
        passed=found.passed,
        entry=entry.digest,
        draw=request.word,
        drawn=len(drawn),
        compared=found.compared,
        equal=found.equal,
        same_bytes=found.same_bytes,
        platform=jsonio.sha256(here),
        by=request.by,
        date=request.date,
        why=f"{_grounds(by, entry, here)}: {found.why}.",
    )


def _grounds(by: verdict.Tier, entry: Entry, here: dict[str, str]) -> str:
    if by == "V1":
        return "the same platform"
    if by == "V2":
        if len(entry.platforms) != 1:
            return "several platforms" if entry.platforms else "a platform that was not noted"
        return f"another platform ({'; '.join(fingerprint.differences(entry.platforms[0], here))})"
    return "thinking takes time" if entry.mode == REALTIME else "the agent does not claim to repeat itself"


def record(path: Path, found: Verification) -> None:
    """Write the outcome into the entry that it is of."""
    entry = files.read(path)
    files.write(path, msgspec.structs.replace(entry, verification=found))
