"""Reads logs as people and their trials in order."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from msgspec import Struct

from hthor.errors import RunError
from hthor.eval.records import trial_record
from hthor.eval.records.trial_record import TrialRecord


class Trial(Struct, frozen=True, kw_only=True):
    """A trial, and the numbers of its person and of its session among those of a `Sessions`, from 0."""

    record: TrialRecord
    person: int
    session: int


class Sessions(Struct, frozen=True, kw_only=True):
    """All trials, ordered by person, session and index.

    Trials with the same human model, seed and participant number are of the same person, with any robots; each robot
    team that a person met is a session of its own.
    """

    trials: tuple[Trial, ...]
    people: int
    sessions: int


def read_sessions(paths: Sequence[Path]) -> Sessions:
    """The trials in some logs, each once.

    Args:
        paths: runs' folders, or files like their ``trials.jsonl``.

    Raises:
        RunError: when one cannot be read, naming file, line and field.
    """
    records_by_key: dict[str, TrialRecord] = {}
    for path in paths:
        for one in _records(path):
            records_by_key.setdefault(one.key, one)
    return sessions_of(records_by_key.values())


def sessions_of(records: Iterable[TrialRecord]) -> Sessions:
    """The sessions that these records belong to."""
    ordered = sorted(records, key=lambda one: (*_person(one), _team(one), one.spec.index, one.key))
    people: dict[object, int] = {}
    sessions: dict[object, int] = {}
    trials = tuple(
        Trial(
            record=one,
            person=people.setdefault(_person(one), len(people)),
            session=sessions.setdefault((_person(one), _team(one)), len(sessions)),
        )
        for one in ordered
    )
    return Sessions(trials=trials, people=len(people), sessions=len(sessions))


def _person(one: TrialRecord) -> tuple[str, str, int, int]:
    return one.spec.human, one.spec.human_sha256, one.spec.seed, one.spec.participant


def _team(one: TrialRecord) -> tuple[str, ...]:
    return tuple(f"{robot.seat} {robot.robot} {robot.agent.name} {robot.agent.sha256}" for robot in one.spec.robots)


def _records(path: Path) -> list[TrialRecord]:
    file = path / "trials.jsonl" if path.is_dir() else path
    if not file.is_file():
        what = "a folder without trials.jsonl" if path.is_dir() else "not there"
        raise RunError(f"{path} is {what}. --target takes runs' folders, such as 'hthor eval' makes, or their logs.")
    lines = file.read_bytes().split(b"\n")
    if lines[-1]:
        raise RunError(
            f"{file}, line {len(lines)} is cut off: it has no end. Finish the run with the 'hthor eval' command that "
            "began it, or delete that line."
        )
    return [_record(file, number, line + b"\n") for number, line in enumerate(lines[:-1], 1)]


def _record(file: Path, number: int, line: bytes) -> TrialRecord:
    try:
        return trial_record.decode(line)
    except trial_record.Damaged as damage:
        raise RunError(
            f"{file}, line {number} is no trial as 'hthor eval' logs it: {damage.field}: {damage.problem}. Give the "
            "log of a run, or delete that line."
        ) from None
