"""Corrections of a run's trials, the file `corrections.jsonl`: what people know about trials that the log does not say.

The file only grows. A correction is taken back by another line, and the log itself is never changed: whoever reads the
log applies the corrections that are in effect. Each line's checksum covers the line before it, so a line that was
changed, moved or deleted in the middle of the file is found.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

import msgspec
from msgspec import UNSET, Struct, UnsetType

from hthor import documents
from hthor.errors import RunError
from hthor.types import HUMAN
from hthor.types.events import AdoptionJudged, Event, Voided

CODE_ROOT = "scoring"

NAME = "corrections.jsonl"
LOG_NAME = "trials.jsonl"
"""The log that they are about, in the same folder."""
_CHECK = b',"check":"%s"}\n'
_DIGITS = 16
_CHECK_LENGTH = len(_CHECK % (b"0" * _DIGITS))
_encoder = msgspec.json.Encoder(order="deterministic")


class Correction(Struct, frozen=True, kw_only=True, tag_field="what"):
    """A correction of one trial.

    Attributes:
        number: its place in the file, from 1.
        trial: the key of the trial's record.
        reason: why, not empty.
        by, date: who corrected and when, as they wrote it themselves; absent if they did not.
    """

    number: int
    trial: str
    reason: str
    by: str | UnsetType = UNSET
    date: str | UnsetType = UNSET


class VoidTrial(Correction, frozen=True, kw_only=True, tag="void"):
    """The trial is broken and does not count; with ``again`` it is to be repeated, as another attempt."""

    again: bool = False


class CorrectAdoption(Correction, frozen=True, kw_only=True, tag="adoption"):
    """Whether the person in a ``seat`` adopted a suggestion; None excludes them from the trial's adoption."""

    seat: str
    adopted: bool | None


class Withdraw(Correction, frozen=True, kw_only=True, tag="withdraw"):
    """Takes back the correction with the number ``withdraws``, which is of the same trial."""

    withdraws: int


AnyCorrection = VoidTrial | CorrectAdoption | Withdraw
_decoder: msgspec.json.Decoder[AnyCorrection] = msgspec.json.Decoder(AnyCorrection)


class Corrections(Struct, frozen=True, kw_only=True):
    """All lines of a file.

    Attributes:
        check: the checksum of the last line, which depends on all lines; empty without lines.
        hashes: hash of the file up to and with each line.
    """

    lines: tuple[AnyCorrection, ...] = ()
    check: str = ""
    hashes: tuple[str, ...] = ()

    @property
    def in_effect(self) -> tuple[VoidTrial | CorrectAdoption, ...]:
        """Those that were not withdrawn; of several about the adoption of one person in one trial, the last."""
        withdrawn = {line.withdraws for line in self.lines if isinstance(line, Withdraw)}
        held: dict[tuple[str, str], VoidTrial | CorrectAdoption] = {}
        for line in self.lines:
            if not isinstance(line, Withdraw) and line.number not in withdrawn:
                held[line.trial, line.seat if isinstance(line, CorrectAdoption) else ""] = line
        return tuple(sorted(held.values(), key=lambda line: line.number))

    def of(self, trial: str) -> tuple[VoidTrial | CorrectAdoption, ...]:
        """Those in effect of the trial with this key."""
        return tuple(line for line in self.in_effect if line.trial == trial)

    @property
    def given_up(self) -> frozenset[str]:
        """The keys of trials that are void and not to be repeated."""
        return frozenset(line.trial for line in self.in_effect if isinstance(line, VoidTrial) and not line.again)

    @property
    def repeated(self) -> frozenset[str]:
        """The keys of trials that are void and to be repeated."""
        return frozenset(line.trial for line in self.in_effect if isinstance(line, VoidTrial) and line.again)


def corrected_events(
    events: tuple[Event, ...], ticks: int, corrections: tuple[VoidTrial | CorrectAdoption, ...]
) -> tuple[Event, ...]:
    """The events of a trial of ``ticks`` ticks with these corrections: judgements before its end, a void as its end."""
    judged = tuple(
        AdoptionJudged(tick=ticks, seat=line.seat, adopted=line.adopted, reason=line.reason)
        for line in corrections
        if isinstance(line, CorrectAdoption)
    )
    void = next((line for line in corrections if isinstance(line, VoidTrial)), None)
    end = events[-1:] if void is None else (Voided(tick=ticks, seat=HUMAN, reason=void.reason),)
    return (*events[:-1], *judged, *end)


def encode(line: AnyCorrection, check: str) -> bytes:
    """A line of the file, after a line whose checksum is ``check``."""
    body = _encoder.encode(line)[:-1]
    return body + _CHECK % _chained(check, body).encode()


def check_of(line: bytes) -> str:
    """The checksum in a line."""
    return line[-_CHECK_LENGTH:][10:-3].decode()


def load(folder: Path) -> Corrections:
    """The corrections of the run in a folder; none where there is no file.

    Raises:
        RunError: for a damaged line, naming file, line and field.
    """
    path = folder / NAME
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return Corrections()
    return _parse(path, data) if data else Corrections()


def beside(log: Path) -> Corrections:
    """The corrections of the trials in a log; only the log in a run's folder has any."""
    return load(log.parent) if log.name == LOG_NAME else Corrections()


def _parse(path: Path, data: bytes) -> Corrections:
    check, lines, whole, hashes = "", list[AnyCorrection](), hashlib.sha256(), list[str]()
    for number, text in enumerate(data.splitlines(keepends=True), 1):
        try:
            line, check = _decode(text, check)
            _check_sequence(line, number, lines)
        except documents.Unreadable as damage:
            raise RunError(
                f"{path}, line {number}: {damage.field}: {damage.problem}. Corrections are only ever added, by "
                "'hthor correct'; take the file from a copy of the run."
            ) from None
        lines.append(line)
        whole.update(text)
        hashes.append(whole.hexdigest())
    return Corrections(lines=tuple(lines), check=check, hashes=tuple(hashes))


def _decode(text: bytes, before: str) -> tuple[AnyCorrection, str]:
    """The correction in a line and the line's checksum, after a line with the checksum ``before``."""
    if not text.endswith(b"\n"):
        raise documents.Unreadable(documents.WHOLE, "is cut off: the line has no end")
    with documents.reading_errors():
        line = _decoder.decode(text)
    check = _chained(before, text[:-_CHECK_LENGTH])
    if text[-_CHECK_LENGTH:] != _CHECK % check.encode():
        raise documents.Unreadable("check", "is not the checksum of this line after the one before it")
    return line, check


def _check_sequence(line: AnyCorrection, number: int, before: list[AnyCorrection]) -> None:
    """Check that a correction can stand at its place."""
    if line.number != number:
        raise documents.Unreadable("number", f"is {line.number}, and not the line's place, {number}")
    if not line.reason.strip():
        raise documents.Unreadable("reason", "is empty")
    if isinstance(line, Withdraw):
        taken_back = [one for one in before if one.number == line.withdraws and one.trial == line.trial]
        if not taken_back or isinstance(taken_back[0], Withdraw):
            raise documents.Unreadable("withdraws", f"{line.withdraws} is no earlier correction of this trial")


def _chained(before: str, body: bytes) -> str:
    return hashlib.sha256(before.encode() + body).hexdigest()[:_DIGITS]
