"""One trial as one line of JSON; the same trial gives the same bytes everywhere."""

import zlib
from collections import Counter
from functools import cache
from typing import Any, TypeVar

import msgspec
from msgspec import UNSET, UnsetType, field

from hthor import documents, jsonio, log_format
from hthor.episode import EpisodeLog, Fault
from hthor.guest.agent.manifest import File
from hthor.log_format import Logged
from hthor.types import TrialSpec
from hthor.types.events import Event, JournalEntry, LogEntry

CODE_ROOT = "trial"

_DIGITS = 4
"""Decimals of metres, radians and seconds in events: a tenth of a millimetre."""
_encoder = msgspec.json.Encoder(order="deterministic")
_CHECK = b',"check":"%08x"}\n'
_CHECK_LENGTH = len(_CHECK % 0)
KEY_DIGITS = 16
"""Length of a trial's key."""
_Entry = TypeVar("_Entry", bound=LogEntry)


class TrialRecord(Logged, frozen=True, kw_only=True):
    """A trial's specification and everything that happened in it; one line of `trials.jsonl`.

    How the trial is judged is no part of it: `hthor.eval.records.scored_trial` adds the metrics when a log is read.
    Fields that are not listed here are those of `hthor.episode.EpisodeLog`.

    Attributes:
        schema: the version of the log.
        key: hash of ``spec``, see `key`.
        files: by seat, the agent's own files that it opened and that ``agents`` in `run.json` does not list.
    """

    key: str
    spec: TrialSpec
    ticks: int
    met: bool
    ratings: dict[str, int | None]
    faults: tuple[Fault, ...]
    events: tuple[Event, ...]
    paths: dict[str, list[tuple[int, int, int]]]
    progress: float | None = None
    idle: dict[str, int] = field(default_factory=dict)
    journal: tuple[JournalEntry, ...] = ()
    files: dict[str, tuple[File, ...]] | UnsetType = UNSET

    @property
    def log(self) -> EpisodeLog:
        """The episode's log, for drawing and for scoring again."""
        return EpisodeLog(**{name: getattr(self, name) for name in EpisodeLog.__struct_fields__})


_decoder = log_format.LineDecoder(TrialRecord)


Damaged = documents.Unreadable
OtherVersion = log_format.OtherVersion
"""A line that was changed after it was written. ``field`` names the place, ``problem`` what is wrong there."""


def key(spec: TrialSpec) -> str:
    """The trial's name: the first 16 hexadecimal digits of the hash of everything that decides the trial."""
    return jsonio.sha256(spec)[:KEY_DIGITS]


def make_record(spec: TrialSpec, log: EpisodeLog) -> TrialRecord:
    """The record of a trial that was run, with rounded numbers."""
    kept = msgspec.structs.replace(
        log, events=tuple(map(_rounded_entry, log.events)), journal=tuple(map(_rounded_entry, log.journal))
    )
    fields = {name: getattr(kept, name) for name in EpisodeLog.__struct_fields__}
    return TrialRecord(schema=log_format.SCHEMA, key=key(spec), spec=spec, **fields)


def encode(record: TrialRecord) -> bytes:
    """The record's line, with its checksum as the last field and a newline; without what a subclass adds."""
    if isinstance(record, TrialRecord) and type(record) is not TrialRecord:  # workers also send other records
        record = TrialRecord(**{name: getattr(record, name) for name in TrialRecord.__struct_fields__})
    return sealed(_encoder.encode(record))


def sealed(document: bytes) -> bytes:
    """A JSON object as a line: with its checksum as the last field and a newline."""
    body = document[:-1]
    return body + _CHECK % zlib.crc32(body)


def checksum(line: bytes) -> int:
    """The checksum in a line."""
    return int(line[-_CHECK_LENGTH:][10:18], 16)


def verify_checksum(line: bytes) -> None:
    """Compare a line with the checksum that it carries; raises Damaged when they do not agree."""
    body, check = line[:-_CHECK_LENGTH], line[-_CHECK_LENGTH:]
    if check != _CHECK % zlib.crc32(body):
        raise Damaged("check", f"{check[10:18].decode('ascii', 'replace')} is not the line's checksum")


def decode(line: bytes, skipped: Counter[str] | None = None) -> TrialRecord:
    """The record of a whole line.

    Args:
        skipped: counts the events of kinds that this version does not know, which the record does not have.

    Raises:
        Damaged: when the line is not as it was written; names the field.
        OtherVersion: when the line is of a version of the log that this version does not read.
    """
    record = _decoder.decode(line, Counter() if skipped is None else skipped)
    verify_checksum(line)
    if record.key != key(record.spec) and record.key != _key_in(line):
        raise Damaged("key", f"'{record.key}' is not the key of the trial in 'spec', '{key(record.spec)}'")
    return record


def _key_in(line: bytes) -> str:
    """The key of the spec in a line, with fields that a later version has added."""
    return jsonio.sha256(documents.decode(line, dict[str, Any])["spec"])[:KEY_DIGITS]


@cache
def _fields_with_floats(kind: type[LogEntry]) -> tuple[str, ...]:
    return tuple(field.name for field in msgspec.structs.fields(kind) if "float" in str(field.type))


def _rounded_entry(entry: _Entry) -> _Entry:
    changes = {name: _rounded(getattr(entry, name)) for name in _fields_with_floats(type(entry))}
    return msgspec.structs.replace(entry, **changes) if changes else entry


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, _DIGITS) + 0.0  # never -0.0
    if isinstance(value, dict):
        return {name: _rounded(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return tuple(_rounded(part) for part in value)
    return value
