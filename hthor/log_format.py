"""How a line of a log is read: its version, and events of kinds that a later version has added.

Logs of this and the last major version can be read: fields and kinds of events that this version does not know are
skipped. The lines of the last one also have ``metrics``, which nothing reads.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import UnionType
from typing import Any, Generic, TypeVar, get_args

import msgspec
from msgspec import Struct

from hthor import activity, documents
from hthor.documents import Unreadable
from hthor.types.events import Event, JournalEntry

SCHEMA = "hthor.trial/2.1"
"""The version of the log that is written."""
_MAJORS = ("hthor.trial/1.", "hthor.trial/2.")
"""The beginnings of the versions that are read."""
_MISSING = re.compile(r"Object missing required field `([^`]+)`")
_NUMBERED = re.compile(r"(events|journal)\[(\d+)\]")


def _tags(union: UnionType) -> frozenset[str]:
    return frozenset(one.__struct_config__.tag for one in get_args(union))


_KINDS = {"events": _tags(Event), "journal": _tags(JournalEntry)}
"""The kinds that the lists of a line may have."""


class Logged(Struct, frozen=True, kw_only=True):
    """A line of a log, as far as every reader of logs needs it.

    Attributes:
        schema: the version of the log.
    """

    schema: str


class _Header(Struct):
    schema: str = ""
    key: str = ""


class OtherVersion(Unreadable):
    """A line of a log of another major version; ``schema`` is its version, empty before there were versions."""

    def __init__(self, schema: str) -> None:
        self.schema = schema
        super().__init__("schema", f"is '{schema}', this version reads '{SCHEMA}'")

    def sentence(self, log: Path) -> str:
        """What is wrong with the log, and what to do about it."""
        if self.schema:
            return f"{log}: {self.field} {self.problem}. Use the version of hthor that wrote it."
        whole = log.parent if (log.parent / "run.json").is_file() else log
        return f"{log} was written by an older version of hthor; 'hthor migrate {whole}' converts it."


_Line = TypeVar("_Line", bound=Logged)


class LineDecoder(Generic[_Line]):
    """Decodes lines as records of one type, which may have the fields ``events`` and ``journal``."""

    def __init__(self, kind: type[_Line]) -> None:
        self._kind, self._decoder = kind, msgspec.json.Decoder(kind)

    def decode(self, line: bytes, skipped: Counter[str]) -> _Line:
        """The record of a line. Events of kinds that this version does not know are left out, and counted.

        Raises:
            OtherVersion: when the line is of another major version of the log.
            Unreadable: when it is no line of a log, with the name of the field.
        """
        try:
            with documents.reading_errors():
                record = self._decoder.decode(line)
        except Unreadable as error:
            return self._decode_known(line, skipped, error)
        if not record.schema.startswith(_MAJORS):
            raise OtherVersion(record.schema)
        return record

    def _decode_known(self, line: bytes, skipped: Counter[str], error: Unreadable) -> _Line:
        """The record without the events of unknown kinds; raises ``error`` if it has none."""
        try:
            header, document = documents.decode(line, _Header), documents.decode(line, dict[str, Any])
        except Unreadable:
            raise error from None
        if not header.schema.startswith(_MAJORS) and (header.schema or header.key):
            raise OtherVersion(header.schema)
        unknown, places = Counter[str](), dict[str, list[int]]()
        for name, kinds in _KINDS.items():
            if isinstance(events := document.get(name), list):
                strange = [_kind(event) not in ("", *kinds) for event in events]
                unknown.update(_kind(event) for event, skip in zip(events, strange, strict=True) if skip)
                places[name] = [number for number, skip in enumerate(strange) if not skip]
                document[name] = [events[number] for number in places[name]]
        try:
            with documents.reading_errors():
                record = msgspec.convert(document, self._kind)
        except Unreadable as problem:
            raise _named(problem, places) from None
        skipped.update(unknown)
        return record


def note_skipped(log: Path, skipped: Counter[str]) -> None:
    """Tell the user which events of a log were left out because this version does not know their kinds."""
    if skipped:
        kinds = ", ".join(f"{count} {kind}" for kind, count in sorted(skipped.items()))
        which = f"{skipped.total()} events of kinds that this version of hthor does not know ({kinds})"
        activity.note(f"{log} has {which}; they were left out.")


def _kind(event: object) -> str:
    """An event's kind; empty for what is no event."""
    kind = event.get("kind") if isinstance(event, dict) else ""
    return kind if isinstance(kind, str) else ""


def _named(error: Unreadable, places: Mapping[str, Sequence[int]]) -> Unreadable:
    """The error with the event's number in the line, and the name of a field that is missing."""
    field = _NUMBERED.sub(lambda found: f"{found[1]}[{places[found[1]][int(found[2])]}]", error.field)
    if missing := _MISSING.fullmatch(error.problem):
        return Unreadable(f"{field}.{missing[1]}".removeprefix(f"{documents.WHOLE}."), "is missing")
    return Unreadable(field, error.problem)
