"""Joining the shards of a run in one folder: each record once; also lists missing trials."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import RunError
from hthor.eval.config import cli_command, run_config
from hthor.eval.config.run_config import RunConfig
from hthor.eval.config.shards import Shard, whole_folder
from hthor.eval.merge import merge_corrections
from hthor.eval.records import (
    attempts,
    corrections,
    opened_files,
    platform,
    run_isolation,
    session_restarts,
    trial_log,
    trial_record,
)
from hthor.eval.records.attempts import Attempt, Attempts
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_log import Place
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import aggregate, result_file
from hthor.eval.results.result_file import Effort, RunResult

_CARRIED = ("suite.json", "houses/*.json", "faults/*.json")
"""Other files of a run's folder that are copied, as its readers need them."""
_Trial = tuple[int, int, int]
"""A session, a trial's place in it, and the number of the attempt."""
_Line = tuple[Place, str, int]
"""Where a trial's line is, the trial's key, and the line's checksum."""


class MissingTrials(Struct, frozen=True, kw_only=True):
    """The missing trials of one shard, and the command that plays them. ``trials`` is None if all are missing.

    Where shards of different divisions are merged, the whole run counts as shard 1 of 1.
    """

    number: int
    of: int
    trials: int | None
    command: str


class MergeResult(Struct, frozen=True, kw_only=True):
    """The result of a merge: the numbers of trials now and of new trials; the run's result when none is missing."""

    folder: str
    plan: RunConfig
    trials: int
    new: int
    gaps: tuple[MissingTrials, ...]
    result: RunResult | None


class _ShardLog(Struct, frozen=True, kw_only=True):
    """A shard's folder, its lines, and how many trials have an attempt that counts.

    ``opened`` has the records of trials in which agents opened further files.
    """

    folder: RunFolder
    shard: Shard
    lines: dict[_Trial, _Line]
    attempts: tuple[Attempt, ...]
    opened: tuple[TrialRecord, ...] = ()

    @property
    def config(self) -> RunConfig:
        return self.folder.config


def merge_shards(folders: Sequence[Path], out: Path, *, dry: bool = False) -> MergeResult:
    """Join shards, all or some of them, in a folder that is then like an undivided run's.

    Shards may overlap and come from different divisions, such as thirds and halves. Records are written in the order of
    sessions and their trials. Trials that ``out`` has already stay, so merging again adds only new trials.

    Args:
        dry: only count; nothing is written.

    Raises:
        RunError: when a folder is not a shard, the shards belong to different runs, a record is damaged, or a trial
            occurs twice with different records.
        RunLocked: when another process writes ``out``.
    """
    folders = list({folder.resolve(): folder for folder in folders}.values())  # each folder counts once
    shards = [_read_shard(RunFolder(folder)) for folder in folders]
    for other in shards[1:]:
        _check_same_run(shards[0], other)
    config, lines = shards[0].config.whole, _join(shards)
    opened_files.complete_manifests(config, [record for shard in shards for record in shard.opened])
    whole = RunFolder(out)
    whole.check_free(config)
    if dry:
        known = [_attempt(whole, record) for _, record in trial_log.read(whole.log_file)]
        before = Attempts(known).counted
        count = Attempts([*known, *_attempts(shards)]).counted
        return MergeResult(folder=str(out), plan=config, trials=count, new=count - before, gaps=(), result=None)
    trials, new = _write(whole, config, shards, lines)
    result = _score(RunFolder(out), [shard.folder for shard in shards]) if trials == config.trials else None
    gaps = () if result else _gaps(shards, out, config.trials - trials)
    return MergeResult(folder=str(out), plan=config, trials=trials, new=new, gaps=gaps, result=result)


def _read_shard(folder: RunFolder) -> _ShardLog:
    config = folder.config
    if not config.shard:
        raise RunError(
            f"{folder} holds a run that is not divided: run.json has no shard. 'hthor eval --shard' makes some."
        )
    lines: dict[_Trial, _Line] = {}
    opened: list[TrialRecord] = []
    tried: list[Attempt] = []
    for place, line, record in trial_log.places(folder.log_file):
        folder.check_origin(record)
        _check_shard(folder, record, config.shard)
        if record.files:
            opened.append(msgspec.structs.replace(record, paths={}, journal=(), events=()))
        one = _attempt(folder, record)
        tried.append(one)
        trial, mine = (*one.place, one.number), (place, record.key, trial_record.checksum(line))
        if lines.setdefault(trial, mine)[1:] != mine[1:]:
            raise RunError(
                f"{place.path}: trial {record.key} is there twice, with different content. Delete one of the two lines."
            )
    return _ShardLog(folder=folder, shard=config.shard, lines=lines, attempts=tuple(tried), opened=tuple(opened))


def _attempt(folder: RunFolder, record: TrialRecord) -> Attempt:
    """The attempt that a line of the log is about; voided also if a correction wants it repeated."""
    one = attempts.attempt_of(record)
    return msgspec.structs.replace(one, voided=one.voided or record.key in folder.corrections.repeated)


def _attempts(shards: Iterable[_ShardLog]) -> list[Attempt]:
    return [attempt for shard in shards for attempt in shard.attempts]


def _check_shard(folder: RunFolder, record: TrialRecord, shard: Shard) -> None:
    session = record.spec.session
    if session not in shard.share(folder.config.session_numbers):
        raise RunError(
            f"{folder.log_file}: trial {record.key}: spec.session is {session}, which is not in shard "
            f"{shard.words}. The line belongs to another shard; delete it."
        )


def _check_same_run(first: _ShardLog, other: _ShardLog) -> None:
    there, here = first.config.whole.untitled, other.config.whole.untitled
    if there != here:
        words = "; ".join(run_config.differences(there, here))
        raise RunError(f"{other.folder} is a shard of another run than {first.folder}: {words}.")


def _join(shards: Sequence[_ShardLog]) -> dict[_Trial, _Line]:
    """The line of every trial, once; a shard may be given twice, run on two machines."""
    joined: dict[_Trial, _Line] = {}
    for shard in shards:
        for trial, line in shard.lines.items():
            known = joined.setdefault(trial, line)
            if known[1:] != line[1:]:
                raise RunError(
                    f"trial {line[1]} is not the same in {known[0].path} and in {line[0].path}. An agent that is not "
                    "deterministic does that; leave one of the folders out."
                )
    return joined


def _write(
    whole: RunFolder, config: RunConfig, shards: Sequence[_ShardLog], lines: dict[_Trial, _Line]
) -> tuple[int, int]:
    """Write the whole run's files; returns how many trials its log has now, and how many are new."""
    new_lines = merge_corrections.new_lines(
        whole.corrections, whole.path, [(shard.folder.path, shard.folder.corrections) for shard in shards]
    )
    with whole.open_log() as log:
        before = log.counted
        whole.write_config(config)
        for name, data in _other_files([shard.folder for shard in shards]).items():
            whole.write(name, data)
        ordered = [lines[trial] for trial in sorted(lines)]
        fetched = trial_log.fetch(place for place, _, _ in ordered)
        for (_, key, _), line in zip(ordered, fetched, strict=True):
            log.append(key, line)
            if not log.agrees(key, line):
                raise RunError(
                    f"{whole}: trial {key} is there already and differs from the shards'. Choose another --out."
                )
        if new_lines:
            corrections.append(whole.path, new_lines)
    with whole.open_log() as log:  # with the new corrections
        return log.counted, log.counted - before


def _other_files(folders: Sequence[RunFolder]) -> dict[str, bytes]:
    paths = {
        path.relative_to(folder.path).as_posix(): path
        for folder in folders
        for pattern in _CARRIED
        for path in sorted(folder.path.glob(pattern))
    }
    return {name: path.read_bytes() for name, path in paths.items()}


def _gaps(shards: Sequence[_ShardLog], out: Path, missing: int) -> tuple[MissingTrials, ...]:
    """The missing trials of each shard. Of several folders of one shard, the one with most trials is continued."""
    first = shards[0]
    of, base = first.shard.of, whole_folder(first.folder.path)
    if any(shard.shard.of != of for shard in shards):  # the undivided command runs only missing trials
        command = cli_command.resume_command(out, first.config.whole)
        return (MissingTrials(number=1, of=1, trials=missing, command=command),)
    gaps = []
    for number in range(1, of + 1):
        same = [shard for shard in shards if shard.shard.number == number]
        if not same:
            absent = Shard(number=number, of=of)
            config = msgspec.structs.replace(first.config, shard=absent)
            command = cli_command.resume_command(absent.folder(base), config)
            gaps.append(MissingTrials(number=number, of=of, trials=None, command=command))
            continue
        fullest = max(same, key=lambda shard: Attempts(shard.attempts).counted)
        lacks = fullest.shard.trials - Attempts(_attempts(same)).counted
        if lacks:
            command = cli_command.resume_command(fullest.folder.path, fullest.config)
            gaps.append(MissingTrials(number=number, of=of, trials=lacks, command=command))
    return tuple(gaps)


def _score(whole: RunFolder, shards: Sequence[RunFolder]) -> RunResult:
    """Score the whole run and store its result."""
    places, records = whole.digest()
    stored = result_file.load_result(whole.path)
    effort = _effort(shards) or (stored.effort if stored else None)
    paths = [shard.path for shard in shards]
    platform.join(whole.path, paths)
    session_restarts.join(whole.path, paths)
    _store_isolation(whole, shards)
    result = aggregate.score_run(whole, trial_log.fetch(places), records, effort)
    result_file.store_result(whole.path, result)
    return result


def _effort(shards: Sequence[RunFolder]) -> Effort | None:
    """The longest wall time of all shards, and the sums of everything else that they spent."""
    hint = "it only says what the run cost: delete it, and go on"
    found = (documents.read_or_none(shard.effort_file, Effort, RunError, hint=hint) for shard in shards)
    efforts = [effort for effort in found if effort is not None]
    if not efforts:
        return None
    return Effort(
        wall_s=max(effort.wall_s for effort in efforts),
        cpu_s=round(sum(effort.cpu_s for effort in efforts), 3),
        trials=sum(effort.trials for effort in efforts),
        replays=sum(effort.replays for effort in efforts),
    )


def _store_isolation(whole: RunFolder, shards: Sequence[RunFolder]) -> None:
    """Store the weakest isolation of all shards with the whole run."""
    isolation = whole.isolation
    for shard in shards:
        isolation = run_isolation.weakest_isolation(shard.path, isolation, "")
    if isolation is not None:
        whole.write(run_isolation.NAME, jsonio.pretty(isolation))
