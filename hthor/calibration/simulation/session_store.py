"""The store of simulated sessions: an append-only file with one writer.

A killed command loses at most what its workers were running. The order of the lines depends on the workers' speed;
readers go by the sessions' keys.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType

import msgspec

from hthor import documents, jsonio
from hthor.calibration.simulation.session_simulation import SessionOutcome
from hthor.calibration.simulation.trial_identity import TrialIdentity
from hthor.errors import RunError
from hthor.eval.records import trial_log, trial_record

FILE, IDENTITY = "sessions.jsonl", "identity.json"
_decoder = msgspec.json.Decoder(SessionOutcome)
_SHOWN = 6


class SessionStore:
    """The one writer of a folder of sessions; ``sessions`` has them by key. Use as a context manager.

    Args:
        folder: made when absent.
        identity: what the trials depend on; the folder keeps to the one that it began with.

    Raises:
        RunLocked: when another process is writing there.
        RunError: when the folder holds sessions of another world or human model, or a damaged line.
    """

    def __init__(self, folder: Path, identity: TrialIdentity) -> None:
        self.path = folder / FILE
        folder.mkdir(parents=True, exist_ok=True)
        self._lock = trial_log.lock(folder)
        try:
            _check_identity(folder, identity)
            self.cut_bytes = trial_log.cut_torn_lines(self.path)
            self.sessions = {outcome.key: outcome for outcome in read_outcomes(self.path)}
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
        """Store a session, given as its line, unless it is there; a line without a key is only decoded."""
        outcome = _decoder.decode(line)
        if outcome.key and outcome.key not in self.sessions:
            self._file.write(line)
            self.sessions[outcome.key] = outcome
        return outcome


def read_outcomes(path: Path) -> Iterator[SessionOutcome]:
    """Every session of a file.

    Raises:
        RunError: when a line is not as it was written.
    """
    if not path.exists():
        return
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
            try:
                with documents.reading_errors():
                    outcome = _decoder.decode(line)
                trial_record.verify_checksum(line)
            except trial_record.Damaged as error:
                raise RunError(
                    f"{path}, line {number}: {error}. The file was changed after it was written. Delete that line to "
                    "have its session simulated again by the same command."
                ) from None
            yield outcome


def _check_identity(folder: Path, identity: TrialIdentity) -> None:
    """Refuse a folder with sessions of another world or human model; note the identity of a new one."""
    path, sessions = folder / IDENTITY, folder / FILE
    if not path.exists() or not sessions.exists() or not sessions.stat().st_size:
        jsonio.write(path, jsonio.pretty(identity))
        return
    hint = "the file was changed after it was written; delete the folder"
    stored = documents.read(path, TrialIdentity, RunError, hint=hint)
    if changed := stored.differences(identity):
        more = f" and {len(changed) - _SHOWN} more" if len(changed) > _SHOWN else ""
        raise RunError(
            f"{folder} holds sessions of another world or person: {', '.join(changed[:_SHOWN])}{more} changed since "
            "they were simulated. Choose another folder with --out, or delete this one."
        )
