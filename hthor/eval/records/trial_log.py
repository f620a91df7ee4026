"""A run's log, `trials.jsonl`: append-only, with one writer, in whole lines."""

from __future__ import annotations

import contextlib
import fcntl
import os
import socket
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import msgspec

from hthor import jsonio, log_corrections, log_format
from hthor.errors import RunError, RunLocked
from hthor.eval.records import attempts, trial_record
from hthor.eval.records.attempts import Attempts
from hthor.eval.records.trial_record import TrialRecord
from hthor.types import TrialSpec

NAME = log_corrections.LOG_NAME
BEAT_S = 0.05
"""How often [s] a log's writer should call `TrialLog.sync`."""
SYNC_S = 0.25
"""The longest time [s] that a written record waits for the disk, if `TrialLog.sync` is called every `BEAT_S`."""
_BLOCK = 1 << 16
_UNSYNCED = 1 << 22
"""More bytes than are ever written between two syncs."""


class Place(NamedTuple):
    """Where a line is: file, first byte and number of bytes, so that long logs need not be in memory."""

    path: Path
    start: int
    size: int


def read(path: Path) -> Iterator[tuple[bytes, TrialRecord]]:
    """Every whole line of a log and its record; a torn last line, which has no newline, is skipped.

    Corrections are not applied; `hthor.eval.records.corrected_log` does that.

    Events of kinds that this version does not know are left out of the records, and a note says so.

    Raises:
        RunError: for a damaged line, naming file, line and field, and for a log of another version.
    """
    if not path.exists():
        return
    skipped = Counter[str]()
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
            if not line.endswith(b"\n"):
                break
            try:
                yield line, trial_record.decode(line, skipped)
            except trial_record.OtherVersion as other:
                raise RunError(other.sentence(path)) from None
            except trial_record.Damaged as damage:
                raise RunError(
                    f"{path}, line {number}: {damage.field}: {damage.problem}. The log was changed after it was "
                    f"written. Delete that line to have its trial played again by the same 'hthor eval' command."
                ) from None
    log_format.note_skipped(path, skipped)


def places(path: Path) -> Iterator[tuple[Place, bytes, TrialRecord]]:
    """As `read`, with the place of each line."""
    start = 0
    for line, found in read(path):
        yield Place(path, start, len(line)), line, found
        start += len(line)


def fetch(wanted: Iterable[Place]) -> Iterator[bytes]:
    """The lines at these places, in this order, one in memory at a time."""
    with contextlib.ExitStack() as stack:
        files = {}
        for place in wanted:
            if place.path not in files:
                files[place.path] = stack.enter_context(place.path.open("rb"))
            files[place.path].seek(place.start)
            yield files[place.path].read(place.size)


class TrialLog:
    """The one writer of a run's log, a context manager. ``key in log`` says whether the log has that line.

    Only keys, checksums and attempts are kept in memory. A live session asks `due` which attempt comes next, and writes
    with `add`.

    Args:
        folder: the run's folder, made when absent.

    Raises:
        RunLocked: when another process is writing this run.
        RunError: when a line is damaged; later, when a line cannot be written.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / NAME
        jsonio.make_folder(folder)
        self._lock = lock(folder)
        try:
            self.torn = cut_torn_lines(self.path)
            self._checks: dict[str, int] = {}
            self._repeated = log_corrections.load(folder).repeated
            self._attempts = Attempts()
            for line, found in read(self.path):
                self._note(found.key, line)
            self._file = os.open(self.path, os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC, 0o644)
            jsonio.sync_folder(folder)
        except BaseException:
            os.close(self._lock)
            raise
        self._size = os.fstat(self._file).st_size
        self._dirty_since: float | None = None

    def __enter__(self) -> TrialLog:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __contains__(self, key: str) -> bool:
        return key in self._checks

    def __len__(self) -> int:
        return len(self._checks)

    @property
    def counted(self) -> int:
        """How many trials have an attempt that was not voided, or one that was voided later and is not repeated."""
        return self._attempts.counted

    def due(self, trial: TrialSpec) -> TrialSpec:
        """The attempt at a trial of this run that counts, or the next one while every attempt was voided."""
        return attempts.numbered(trial, self._attempts.number((trial.session, trial.index)))

    def add(self, record: TrialRecord) -> bool:
        """Write the record of a trial, voided or not; returns whether it was new. Then `due` may name another."""
        return self.append(record.key, trial_record.encode(record))

    def agrees(self, key: str, line: bytes) -> bool:
        """Whether the log's line for this trial equals ``line``."""
        return self._checks.get(key) == trial_record.checksum(line)

    def append(self, key: str, line: bytes) -> bool:
        """Write a trial's line unless the log has it; returns whether it was new.

        Another attempt at the same trial has another key, so it is new.
        """
        if key in self._checks:
            return False
        written = 0
        try:
            while written < len(line):
                written += os.write(self._file, line[written:])
        except OSError as error:  # a full disk; if this fails, the next command cuts
            with contextlib.suppress(OSError):
                os.ftruncate(self._file, self._size)
            raise self._unwritten(error) from None
        self._size += written
        self._note(key, line)
        if self._dirty_since is None:
            self._dirty_since = time.monotonic()
        self.sync(due=True)
        return True

    def sync(self, *, due: bool = False) -> None:
        """Write everything to the disk; with ``due`` only if it could otherwise wait for longer than `SYNC_S`."""
        if self._dirty_since is None or (due and time.monotonic() - self._dirty_since < SYNC_S - BEAT_S):
            return
        try:
            os.fdatasync(self._file)
        except OSError as error:  # some file systems report only now that the disk is full
            raise self._unwritten(error) from None
        self._dirty_since = None

    def close(self) -> None:
        """Write everything to the disk and release the lock."""
        try:
            self.sync()
        finally:
            os.close(self._file)
            os.close(self._lock)

    def _note(self, key: str, line: bytes) -> None:
        self._checks[key] = trial_record.checksum(line)
        attempt = attempts.read_attempt(line)
        self._attempts.add(msgspec.structs.replace(attempt, voided=attempt.voided or key in self._repeated))

    def _unwritten(self, error: OSError) -> RunError:
        return RunError(
            f"{self.path}: {error.strerror}. The {len(self)} trials that it holds are kept; make room, and the same "
            "command goes on."
        )


def lock(folder: Path) -> int:
    """Lock the folder until the descriptor is closed, or the process ends."""
    handle = os.open(folder / ".lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        owner = os.read(handle, 200).decode("utf-8", "replace").strip() or "another process"
        os.close(handle)
        raise RunLocked(
            f"{folder} is being written by {owner}. Wait for it, stop it, or choose another folder with --out."
        ) from None
    with contextlib.suppress(OSError):  # on a full disk the lock works too, without its owner's name
        os.ftruncate(handle, 0)
        os.pwrite(handle, f"process {os.getpid()} on {socket.gethostname()}".encode(), 0)
    return handle


def cut_torn_lines(path: Path) -> int:
    """Cut the bytes that a killed writer or machine left after the last whole line; returns the number of bytes cut.

    A loss of power may leave a hole of zeros where blocks did not reach the disk, with later lines after it; no record
    has a zero byte. Trials that are cut are run again.
    """
    if not path.exists():
        return 0
    with path.open("r+b") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(max(0, size - _UNSYNCED))
        hole = file.read().find(b"\0")
        end = max(0, size - _UNSYNCED) + hole if hole >= 0 else size
        whole = 0
        while end and not whole:
            start = max(0, end - _BLOCK)
            file.seek(start)
            newline = file.read(end - start).rfind(b"\n")
            whole, end = (start + newline + 1 if newline >= 0 else 0), start
        if whole < size:
            file.truncate(whole)
    return size - whole
