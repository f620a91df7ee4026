"""One trial as one line of JSON; the same trial gives the same bytes everywhere."""

import zlib
from collections.abc import Sequence
from typing import Any

import msgspec
from msgspec import UNSET, Struct, UnsetType

from hthor import documents, jsonio
from hthor.episode import EpisodeLog, Fault
from hthor.eval.metrics.trial_metrics import TrialMetrics, measure
from hthor.guest.agent.manifest import File
from hthor.types import Event, TrialSpec, Vec3

CODE_ROOT = "trial"

_DIGITS = 4
"""Decimals of metres, radians and seconds in events: a tenth of a millimetre."""
_encoder = msgspec.json.Encoder(order="deterministic")
_CHECK = b',"check":"%08x"}\n'
_CHECK_LENGTH = len(_CHECK % 0)
_NEEDED = {
    "sent": ("message", "text"),
    **dict.fromkeys(("shown", "accepted", "declined", "covered"), ("message",)),
    "progress": ("value",),
}
"""The fields that events of a kind must have."""


class TrialRecord(Struct, frozen=True, kw_only=True):
    """A trial's specification, everything that happened in it, and its metrics; one line of `trials.jsonl`.

    Fields that are not listed here are those of `hthor.episode.EpisodeLog`.

    Attributes:
        key: hash of ``spec``, see `key`.
        files: by seat, the agent's own files that it opened and that ``agents`` in `run.json` does not list.
    """

    key: str
    spec: TrialSpec
    metrics: TrialMetrics
    ticks: int
    met: bool
    ratings: dict[str, int | None]
    faults: tuple[Fault, ...]
    events: tuple[Event, ...]
    paths: dict[str, list[tuple[int, int, int]]]
    progress: float | None = None
    idle: dict[str, int] = {}
    journal: tuple[Event, ...] = ()
    files: dict[str, tuple[File, ...]] | UnsetType = UNSET

    @property
    def log(self) -> EpisodeLog:
        """The episode's log, for drawing and for scoring again."""
        return EpisodeLog(**{name: getattr(self, name) for name in EpisodeLog.__struct_fields__})


_decoder = msgspec.json.Decoder(TrialRecord)


Damaged = documents.Unreadable
"""A line that was changed after it was written. ``field`` names the place, ``problem`` what is wrong there."""


def key(spec: TrialSpec) -> str:
    """The trial's name: the first 16 hexadecimal digits of the hash of everything that decides the trial."""
    return jsonio.sha256(spec)[:16]


def make_record(spec: TrialSpec, log: EpisodeLog) -> TrialRecord:
    """The record of a trial that was run. Metrics are computed from what is written, after rounding."""
    events, journal = (
        tuple(msgspec.structs.replace(event, data=_rounded(event.data)) for event in some)
        for some in (log.events, log.journal)
    )
    kept = msgspec.structs.replace(log, events=events, journal=journal)
    fields = {name: getattr(kept, name) for name in EpisodeLog.__struct_fields__}
    return TrialRecord(key=key(spec), spec=spec, metrics=measure(spec, kept), **fields)


def encode(record: TrialRecord) -> bytes:
    """The record's line, with its checksum as the last field and a newline."""
    body = _encoder.encode(record)[:-1]
    return body + _CHECK % zlib.crc32(body)


def checksum(line: bytes) -> int:
    """The checksum in a line."""
    return int(line[-_CHECK_LENGTH:][10:18], 16)


def verify_checksum(line: bytes) -> None:
    """Compare a line with the checksum that it carries; raises Damaged when they do not agree."""
    body, check = line[:-_CHECK_LENGTH], line[-_CHECK_LENGTH:]
    if check != _CHECK % zlib.crc32(body):
        raise Damaged("check", f"{check[10:18].decode('ascii', 'replace')} is not the line's checksum")


def decode(line: bytes) -> TrialRecord:
    """The record of a whole line; raises Damaged, which names the field that is not as it was written."""
    with documents.reading_errors():
        record = _decoder.decode(line)
    verify_checksum(line)
    if record.key != key(record.spec):
        raise Damaged("key", f"'{record.key}' is not the key of the trial in 'spec', '{key(record.spec)}'")
    check_events(record.events)
    return record


class _Data(Struct):
    """The fields that are read, whatever the kind of event."""

    message: int | UnsetType = UNSET
    text: str | UnsetType = UNSET
    object: str | UnsetType = UNSET
    position: Vec3 | UnsetType | None = UNSET
    off: float | UnsetType | None = UNSET
    on: str | UnsetType = UNSET
    thing: str | UnsetType = UNSET
    by: str | int | UnsetType = UNSET
    value: float | UnsetType = UNSET
    bearers: tuple[str, ...] | UnsetType = UNSET


def check_events(events: Sequence[Event]) -> None:
    """Check that the data of all events can be read.

    Raises:
        Damaged: names the event, by its number from 0, and the field.
    """
    for number, event in enumerate(events):
        try:
            with documents.reading_errors():
                msgspec.convert(event.data, _Data)
        except Damaged as error:
            raise Damaged(f"events[{number}].data.{error.field}", error.problem) from None
        if missing := next((name for name in _NEEDED.get(event.kind, ()) if name not in event.data), ""):
            raise Damaged(f"events[{number}].data.{missing}", f"is missing; an event '{event.kind}' has it")


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, _DIGITS) + 0.0  # never -0.0
    if isinstance(value, dict):
        return {name: _rounded(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_rounded(part) for part in value]
    return value
