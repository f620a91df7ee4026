"""The store of simulated sessions, and the hashes of what they depend on: outdated trials are never reused.

The store is an append-only file with one writer. A killed command loses at most the sessions that its workers were
running. The order of the lines depends on the workers' speed; readers find sessions by their keys.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType

import msgspec
from msgspec import Struct

from hthor import code_identity, documents, installation, jsonio, plugins, rules
from hthor.calibration.simulation.session_simulation import SessionOutcome
from hthor.calibration.simulation.trial_table import AGENTS
from hthor.errors import RunError
from hthor.eval.records import trial_log, trial_record
from hthor.humans.population.parameter_registry import PARAMETERS
from hthor.tasks import Suite

ROBOT = "scout"
"""Name of the robot body in the article."""
_T_STAR = "T_STAR"
_NOT_COURSE = ("t_star", "difficulty", "split")
FILE, IDENTITY = "sessions.jsonl", "identity.json"
_decoder = msgspec.json.Decoder(SessionOutcome)
_SHOWN = 6


class TrialIdentity(Struct, frozen=True, kw_only=True):
    """Hashes of everything that decides the course of a suite's trials; ``parts`` has the hashes by name."""

    parts: dict[str, str]

    @property
    def sha256(self) -> str:
        """Hash of all parts."""
        return jsonio.sha256(self.parts)

    def differences(self, other: TrialIdentity) -> list[str]:
        """Names of the parts that differ."""
        names = sorted({*self.parts, *other.parts})
        return [name for name in names if self.parts.get(name) != other.parts.get(name)]


def trials_identity(suite: Suite) -> TrialIdentity:
    """Hashes of everything that trials of this suite depend on, in this version of hthor and its libraries."""
    numbers = {name: value for name, value in rules.as_dict().items() if not name.startswith(_T_STAR)}
    priors = [(one.name, one.prior, one.effect, one.scale) for one in PARAMETERS]
    versions = {name: version for name, version in installation.versions().items() if name != "hthor"}
    return TrialIdentity(
        parts={
            f"suite {suite.name}": jsonio.sha256([_course(task) for task in suite.tasks]),
            "rules": jsonio.sha256(numbers),
            "parameters and their priors": jsonio.sha256(priors),
            **{f"version of {name}": version for name, version in versions.items()},
            "code": _code(suite),
        }
    )


def _course(task: object) -> dict[str, object]:
    """A task without the fields that do not affect its trials."""
    told: dict[str, object] = msgspec.to_builtins(task)
    return {name: value for name, value in told.items() if name not in _NOT_COURSE}


def _code(suite: Suite) -> str:
    """Hash of the code that plays sessions: world, proxy, the article's three agents, the suite's task kinds."""
    own = [
        *(plugins.module_name("agent", name) for name in AGENTS),
        plugins.module_name("robot", ROBOT),
        *(plugins.module_name("task kind", kind) for kind in {task.kind for task in suite.tasks}),
    ]
    return code_identity.modules_sha256([*code_identity.roots("trial"), *code_identity.roots("sessions"), *own])


def statistics_sha256() -> str:
    """Hash of the code that turns tables of trials into populations."""
    return code_identity.modules_sha256(code_identity.roots("statistics"))


class SessionStore:
    """The one writer of a folder of sessions; ``sessions`` has them by key. Use as a context manager.

    Args:
        folder: made when absent.
        identity: hashes of what the trials depend on; a folder accepts only the identity that it began with.

    Raises:
        RunLocked: when another process is writing to the folder.
        RunError: when the folder has sessions of another world or human model, or a damaged line.
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
        """Store a session, given as its line, unless it is stored already; a line without a key is only decoded."""
        outcome = _decoder.decode(line)
        if outcome.key and outcome.key not in self.sessions:
            self._file.write(line)
            self.sessions[outcome.key] = outcome
        return outcome


def read_outcomes(path: Path) -> Iterator[SessionOutcome]:
    """Every session of a file.

    Raises:
        RunError: when a line was changed after it was written.
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
    """Refuse a folder with sessions of another world or human model; write the identity into a new folder."""
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
