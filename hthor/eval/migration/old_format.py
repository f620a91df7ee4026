"""Lines of a log as the last release (0.1, before log 1.0) wrote them."""

from typing import Any

import msgspec
from msgspec import UNSET, Struct, UnsetType

from hthor import documents, jsonio
from hthor.documents import Unreadable
from hthor.episode import Fault
from hthor.eval.records import trial_record
from hthor.guest.agent.manifest import File
from hthor.types import RobotSeat, TaskSpec

FAULTS_SCHEMA = "hthor.faults/1"


class OldEvent(Struct, frozen=True, kw_only=True):
    """Something that a ``seat`` did at a ``tick``; its ``data`` depend on its ``kind``."""

    tick: int
    seat: str
    kind: str
    data: dict[str, Any] = {}


class OldSpec(Struct, frozen=True, kw_only=True):
    """What decided a trial; its one person is the ``participant`` drawn from the population ``human``."""

    task: TaskSpec
    robots: tuple[RobotSeat, ...]
    human: str
    human_sha256: str
    participant: int
    index: int
    seed: int
    suite_sha256: str
    rules_sha256: str
    code_sha256: str
    assets_sha256: str = ""
    kind_sha256: str = ""
    realtime: bool | UnsetType = UNSET
    step_limit_s: float | UnsetType = UNSET


class OldRecord(Struct, frozen=True, kw_only=True):
    """A trial; ``trust`` is the rating of the only person."""

    key: str
    spec: OldSpec
    ticks: int
    met: bool
    trust: int | None
    faults: tuple[Fault, ...]
    events: tuple[OldEvent, ...]
    paths: dict[str, list[tuple[int, int, int]]]
    progress: float | None = None
    idle: dict[str, int] = {}
    journal: tuple[OldEvent, ...] = ()
    files: dict[str, tuple[File, ...]] | UnsetType = UNSET


_decoder = msgspec.json.Decoder(OldRecord)


def decode(line: bytes) -> OldRecord:
    """The record of a whole line.

    Raises:
        Unreadable: when the line is not as it was written; names the field.
    """
    with documents.reading_errors():
        record = _decoder.decode(line)
    trial_record.verify_checksum(line)
    key = jsonio.sha256(documents.decode(line, dict[str, Any])["spec"])[: trial_record.KEY_DIGITS]
    if record.key != key:
        raise Unreadable("key", f"'{record.key}' is not the key of the trial in 'spec', '{key}'")
    return record
