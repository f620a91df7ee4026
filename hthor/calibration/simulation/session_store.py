"""Sessions that were played, kept as they come: an append-only file with one writer.

A killed command loses at most what its workers had in hand. The file's order depends on the workers' haste; who reads
it goes by the sessions' keys.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType

import msgspec

from hthor import jsonio
from hthor.calibration.simulation.session_simulation import SessionOutcome
from hthor.calibration.simulation.trial_identity import Identity
from hthor.documents import Unreadable, reading_errors
from hthor.documents import read as read_document
from hthor.errors import RunError
from hthor.eval.records import trial_log

FILE, IDENTITY = "sessions.jsonl", "identity.json"
_decoder = msgspec.json.Decoder(SessionOutcome)
_TAIL = b',"check":"%08x"}\n'
_TAIL_LENGTH = len(_TAIL % 0)
_NAMED = 6


class SessionStore:
    """The one writer of a folder of sessions. Use as a context manager.

    Args:
        folder: made when absent.
        identity: what the trials hang on; the folder keeps to the one that it began with.

    Raises:
        RunLocked: when another process is writing there.
        RunError: when the folder holds sessions of another world or person, or a damaged line.
    """

    def __init__(self, folder: Path, identity: Identity) -> None:
        self.path = folder / FILE
        folder.mkdir(parents=True, exist_ok=True)
        self._lock = trial_log.lock(folder)
        try:
            _examine(folder, identity)
            self.torn = trial_log.cut_torn_lines(self.path)
            self.held = {sat.key: sat for sat in read(self.path)}
        except BaseException:
            os.close(self._lock)
            raise
        self._file = self.path.open("ab", buffering=0)

    def __enter__(self) -> SessionStore:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.fsync(self._file.fileno())
        self._file.close()
        os.close(self._lock)

    def append(self, line: bytes) -> SessionOutcome:
        """Keep a session, given as its line, unless it is there; a line without a key is only read."""
        sat = _decoder.decode(line)
        if sat.key and sat.key not in self.held:
            self._file.write(line)
            self.held[sat.key] = sat
        return sat


def read(path: Path) -> Iterator[SessionOutcome]:
    """Every session of a file.

    Raises:
        RunError: when a line is not as it was written.
    """
    if not path.exists():
        return
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
            body, tail = line[:-_TAIL_LENGTH], line[-_TAIL_LENGTH:]
            try:
                if tail != _TAIL % zlib.crc32(body):
                    raise Unreadable("check", "is not the line's checksum")
                with reading_errors():
                    session = _decoder.decode(line)
            except Unreadable as error:
                raise RunError(
                    f"{path}, line {number}: {error}. The file was changed after it was written. Delete that line to "
                    "have its session played again by the same command."
                ) from None
            yield session


def _examine(folder: Path, identity: Identity) -> None:
    """See that what lies in the folder is of the same world and people, and note whose it is when it is new."""
    path, sessions = folder / IDENTITY, folder / FILE
    if not path.exists() or not sessions.exists() or not sessions.stat().st_size:
        jsonio.write(path, jsonio.pretty(identity))
        return
    hint = "the file was changed after it was written; delete the folder"
    there = read_document(path, Identity, RunError, hint=hint)
    if changed := there.differences(identity):
        more = f" and {len(changed) - _NAMED} more" if len(changed) > _NAMED else ""
        raise RunError(
            f"{folder} holds sessions of another world or person: {', '.join(changed[:_NAMED])}{more} changed since "
            "they were simulated. Choose another folder with --out, or delete this one."
        )
