"""Joining the shards of a run: each record once, and what is missing."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import RunError
from hthor.eval.config import cli_command, run_config
from hthor.eval.config.run_config import RunConfig
from hthor.eval.config.shard import Shard, whole_folder
from hthor.eval.records import opened_files, platform, reader, run_isolation, session_restarts, trial_log, trial_record
from hthor.eval.records.trial_log import Place, TrialLog
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import aggregate, baseline, result_file
from hthor.eval.results.result_file import Effort, RunResult
from hthor.eval.runner.run import EFFORT
from hthor.guest import Isolation

_CARRIED = ("suite.json", "houses/*.json", "faults/*.json")
"""What else a run's folder may hold that others need to read it."""


class MissingTrials(Struct, frozen=True, kw_only=True):
    """What a run lacks of one shard, and the command that plays it. ``trials`` is None when all of it is missing.

    Shards of several divisions have one gap, of the whole run, as if it were shard 1 of 1.
    """

    number: int
    of: int
    trials: int | None
    command: str


class MergeResult(Struct, frozen=True, kw_only=True):
    """What became of a merge: trials that were there before and new ones; the result when nothing is missing."""

    folder: str
    plan: RunConfig
    trials: int
    new: int
    gaps: tuple[MissingTrials, ...]
    result: RunResult | None


class _ShardLog(Struct, frozen=True, kw_only=True):
    """A shard's folder, its configuration, and where its records lie, by person and trial.

    ``opened`` are the records, without what is long in them, that tell of files which agents opened only then.
    """

    folder: Path
    plan: RunConfig
    shard: Shard
    records: dict[tuple[int, int], tuple[Place, str, int]]
    opened: tuple[TrialRecord, ...] = ()


def merge_shards(folders: Sequence[Path], out: Path, *, dry: bool = False) -> MergeResult:
    """Join shards, all of them or those that there are so far, in a folder that is then like an undivided run's.

    They may overlap, and be of several divisions: thirds with a half. Records lie there in the order of people and
    their trials. What is there already stays; merging again adds.

    Raises:
        RunError: when a folder is no shard, they are not of one run, or a record is damaged or there twice and unlike.
        RunLocked: when ``out`` is being written.
    """
    folders = list({folder.resolve(): folder for folder in folders}.values())  # each costs what it did but once
    parts = [_examine(folder) for folder in folders]
    first = parts[0]
    for part in parts[1:]:
        _same_run(first, part)
    plan, found = first.plan.whole, _join(parts)
    opened_files.complete_manifests(plan, [one for part in parts for one in part.opened])
    run_config.check_folder(out, plan)
    if dry:  # only count; what is missing is named by the merge itself
        there = {one.key for _, one in trial_log.read(out / "trials.jsonl")}
        more = {key for _, key, _ in found.values()} - there
        return MergeResult(
            folder=str(out), plan=plan, trials=len(there) + len(more), new=len(more), gaps=(), result=None
        )
    new = 0
    with TrialLog(out) as book:
        run_config.write_config(out, plan)
        for name, data in _other_files(folders).items():
            jsonio.write(out / name, data)
        wanted = [found[place] for place in sorted(found)]
        for (_, key, _), line in zip(wanted, trial_log.fetch(place for place, _, _ in wanted), strict=True):
            new += book.append(key, line)
            if not book.agrees(key, line):
                raise RunError(
                    f"{out}: trial {key} is there already, and is not as in the shards. Choose another --out."
                )
        trials = len(book)
    result = _score(out, plan, [part.folder for part in parts]) if trials == plan.trials else None
    gaps = () if result else _gaps(parts, out, plan.trials - trials)
    return MergeResult(folder=str(out), plan=plan, trials=trials, new=new, gaps=gaps, result=result)


def _examine(folder: Path) -> _ShardLog:
    plan = run_config.load_config(folder)
    if not plan.shard:
        raise RunError(
            f"{folder} holds a run that is not divided: run.json has no shard. 'hthor eval --shard' makes some."
        )
    records: dict[tuple[int, int], tuple[Place, str, int]] = {}
    told: list[TrialRecord] = []
    for place, line, one in trial_log.places(folder / "trials.jsonl"):
        reader.check_origin(folder, one, plan)
        _check_share(folder, one, plan, plan.shard)
        if one.files:
            told.append(msgspec.structs.replace(one, paths={}, journal=(), events=()))
        seat, mine = (one.spec.participant, one.spec.index), (place, one.key, trial_record.checksum(line))
        if records.setdefault(seat, mine)[1:] != mine[1:]:
            raise RunError(
                f"{place.path}: trial {one.key} is there twice and not the same. Delete one of the two lines."
            )
    return _ShardLog(folder=folder, plan=plan, shard=plan.shard, records=records, opened=tuple(told))


def _check_share(folder: Path, one: TrialRecord, plan: RunConfig, mine: Shard) -> None:
    participant = one.spec.participant
    if participant not in mine.share(range(plan.participants)):
        raise RunError(
            f"{folder / 'trials.jsonl'}: trial {one.key}: spec.participant is {participant}, who is not in shard "
            f"{mine.words}. The line belongs to another shard; delete it."
        )


def _same_run(first: _ShardLog, part: _ShardLog) -> None:
    there, here = first.plan, part.plan
    if there.whole.untitled != here.whole.untitled:
        told = "; ".join(run_config.differences(there.whole.untitled, here.whole.untitled))
        raise RunError(f"{part.folder} is a shard of another run than {first.folder}: {told}.")


def _join(parts: Sequence[_ShardLog]) -> dict[tuple[int, int], tuple[Place, str, int]]:
    """Every record once, by person and trial; a shard may be there twice, played on two machines."""
    found: dict[tuple[int, int], tuple[Place, str, int]] = {}
    for part in parts:
        for seat, (place, key, check) in part.records.items():
            there = found.setdefault(seat, (place, key, check))
            if there[1:] != (key, check):
                raise RunError(
                    f"trial {key} is not the same in {there[0].path} and in {place.path}. An agent that does not "
                    "repeat itself gives such; leave one of the folders out."
                )
    return found


def _other_files(folders: Sequence[Path]) -> dict[str, bytes]:
    paths = {
        path.relative_to(folder).as_posix(): path
        for folder in folders
        for pattern in _CARRIED
        for path in sorted(folder.glob(pattern))
    }
    return {name: path.read_bytes() for name, path in paths.items()}


def _gaps(parts: Sequence[_ShardLog], out: Path, missing: int) -> tuple[MissingTrials, ...]:
    """What each shard lacks. The fullest folder of a shard is the one to go on with."""
    first = parts[0]
    of, base = first.shard.of, whole_folder(first.folder)
    if any(part.shard.of != of for part in parts):  # the undivided command plays just what is missing
        return (
            MissingTrials(number=1, of=1, trials=missing, command=cli_command.resume_command(out, first.plan.whole)),
        )
    gaps = []
    for number in range(1, of + 1):
        mine = [part for part in parts if part.shard.number == number]
        if not mine:
            absent = Shard(number=number, of=of)
            words = cli_command.resume_command(absent.folder(base), msgspec.structs.replace(first.plan, shard=absent))
            gaps.append(MissingTrials(number=number, of=of, trials=None, command=words))
            continue
        fullest = max(mine, key=lambda part: len(part.records))
        lacks = fullest.shard.trials - len(set().union(*(part.records for part in mine)))
        if lacks:
            words = cli_command.resume_command(fullest.folder, fullest.plan)
            gaps.append(MissingTrials(number=number, of=of, trials=lacks, command=words))
    return tuple(gaps)


def _score(out: Path, plan: RunConfig, folders: Sequence[Path]) -> RunResult:
    """The result of the whole, with the effort of the shards: the longest wall time, and all that they cost."""
    there, records = reader.digest(out, plan)
    efforts = [
        documents.read(folder / EFFORT, Effort, RunError, hint="it only says what the run cost: delete it, and go on")
        for folder in folders
        if (folder / EFFORT).is_file()
    ]
    stored = result_file.load_result(out)
    effort = stored.effort if stored else None
    if efforts:
        effort = Effort(
            wall_s=max(one.wall_s for one in efforts),
            cpu_s=round(sum(one.cpu_s for one in efforts), 3),
            trials=sum(one.trials for one in efforts),
            replays=sum(one.replays for one in efforts),
        )
    platform.join(out, folders)
    session_restarts.join(out, folders)
    beside, held = baseline.uplift_or_stored(out, plan, records), _store_isolation(out, folders)
    result = aggregate.make_result(
        plan,
        trial_log.fetch(there),
        records,
        effort,
        uplift=beside,
        isolation=held,
        replays=session_restarts.count(out),
    )
    result_file.store_result(out, result)
    return result


def _store_isolation(out: Path, folders: Sequence[Path]) -> Isolation | None:
    """How agents were held at the least, over all shards; kept with the whole run."""
    held = run_isolation.load_isolation(out)
    for folder in folders:
        held = run_isolation.weakest_isolation(folder, held, "")
    if held is not None:
        jsonio.write(out / run_isolation.NAME, jsonio.pretty(held))
    return held
