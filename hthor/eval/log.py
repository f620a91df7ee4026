"""The run's log, `trials.jsonl`: append-only, one writer, whole lines; knows nothing of what a trial is worth."""

from __future__ import annotations

import fcntl
import os
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType

from hthor.errors import RunError, RunLocked
from hthor.eval import record
from hthor.eval.record import Record

SYNC_S = 0.25
"""Longest time that a written record may wait for the disk."""


def read(path: Path) -> Iterator[tuple[bytes, Record]]:
    """Every whole line of a log and its record; a torn last line, which has no newline, is passed over.

    Raises:
        RunError: for a damaged line, naming file, line and field.
    """
    if not path.exists():
        return
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
            if not line.endswith(b"\n"):
                return
            try:
                yield line, record.decode(line)
            except record.Damaged as damage:
                raise RunError(
                    f"{path}, line {number}: {damage.field}: {damage.problem}. The log was changed after it was "
                    f"written. Delete that line to have its trial played again by the same 'hthor eval' command."
                ) from None


class Log:
    """The one writer of a run's log. Use as a context manager.

    Args:
        folder: the run's folder, made when absent.

    Raises:
        RunLocked: when another process is writing this run.
        RunError: when a line is damaged.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / "trials.jsonl"
        folder.mkdir(parents=True, exist_ok=True)
        self._lock = lock(folder)
        try:
            self.lines = {found.key: line for line, found in read(self.path)}
            self.torn = cut_torn_line(self.path)
        except BaseException:
            os.close(self._lock)
            raise
        self._file = os.open(self.path, os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC, 0o644)
        self._dirty_since: float | None = None

    def __enter__(self) -> Log:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def append(self, key: str, line: bytes) -> bool:
        """Write a trial's line once; says whether it was new."""
        if key in self.lines:
            return False
        written = 0
        try:
            while written < len(line):
                written += os.write(self._file, line[written:])
        except OSError as error:  # a full disk; the next command cuts the torn line
            raise OSError(error.errno, error.strerror, str(self.path)) from None
        self.lines[key] = line
        if self._dirty_since is None:
            self._dirty_since = time.monotonic()
        self.sync(due=True)
        return True

    def sync(self, *, due: bool = False) -> None:
        """Put what was written on the disk; with ``due`` only what has waited for `SYNC_S`."""
        if self._dirty_since is None or (due and time.monotonic() - self._dirty_since < SYNC_S):
            return
        os.fdatasync(self._file)
        self._dirty_since = None

    def close(self) -> None:
        """Put everything on the disk and let others write."""
        self.sync()
        os.close(self._file)
        os.close(self._lock)


def lock(folder: Path) -> int:
    """Hold the folder's lock until the descriptor is closed, which the end of the process does as well."""
    handle = os.open(folder / ".lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        owner = os.read(handle, 200).decode("utf-8", "replace").strip() or "another process"
        os.close(handle)
        raise RunLocked(
            f"{folder} is being written by {owner}. Wait for it, stop it, or choose another folder with --out."
        ) from None
    os.ftruncate(handle, 0)
    os.pwrite(handle, f"process {os.getpid()} on {socket.gethostname()}".encode(), 0)
    return handle


def cut_torn_line(path: Path) -> int:
    """Cut what a killed writer left after the last whole line; the number of bytes that were cut."""
    if not path.exists():
        return 0
    with path.open("r+b") as file:
        data = file.read()
        whole = data.rfind(b"\n") + 1
        if whole < len(data):
            file.truncate(whole)
    return len(data) - whole
