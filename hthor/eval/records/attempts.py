"""Attempts at a trial: a voided one stays in the log with its reason and does not count, and the trial is repeated.

A repetition has the same specification except for its number: ``attempt`` is 1 for the first, 2 for the second. Of
several attempts the last that was not voided counts.

A trial can also be voided after it was played, by a correction. It is then repeated only if the correction says so.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import msgspec
from msgspec import UNSET, Struct, UnsetType

from hthor.log_corrections import VoidTrial
from hthor.types.events import Voided

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from hthor.eval.records.trial_record import TrialRecord
    from hthor.log_corrections import Corrections
    from hthor.types import TrialSpec

CODE_ROOT = "scoring"

Place = tuple[int, int]
"""A trial of a run: the number of its session, and its index there."""
_Pair = TypeVar("_Pair")
_Record = TypeVar("_Record", bound="TrialRecord")


class VoidedTrial(Struct, frozen=True, kw_only=True):
    """An attempt that was voided: which one of which trial, from 0, and the reason.

    ``correction`` is the number of the correction that voided it; absent if it was voided while it was played.
    """

    key: str
    task: str
    session: int
    index: int
    attempt: int
    reason: str
    correction: int | UnsetType = UNSET


class Attempt(Struct, frozen=True):
    """One attempt at a trial of a run: its number from 0, and whether it was voided."""

    place: Place
    number: int
    voided: bool


class _Spec(Struct):
    session: int
    index: int
    attempt: int | UnsetType = UNSET


class _Event(Struct):
    kind: str


class _Line(Struct):
    spec: _Spec
    events: list[_Event]


_decoder = msgspec.json.Decoder(_Line)
_VOIDED = Voided.__struct_config__.tag


def read_attempt(line: bytes) -> Attempt:
    """The attempt that a line of a log is about; fast, as little else is read."""
    found = _decoder.decode(line)
    ends = found.events[-1].kind if found.events else ""
    place = found.spec.session, found.spec.index
    return Attempt(place, found.spec.attempt or 0, ends == _VOIDED)


def attempt_of(record: TrialRecord, given_up: Collection[str] = ()) -> Attempt:
    """The attempt that a record is about; one whose key is among ``given_up`` is not called voided."""
    spec = record.spec
    voided = bool(record.log.voided) and record.key not in given_up
    return Attempt((spec.session, spec.index), spec.attempt or 0, voided)


def numbered(trial: TrialSpec, number: int) -> TrialSpec:
    """The trial's attempt with this number; 0 is the first, whose specification names no attempt."""
    return msgspec.structs.replace(trial, attempt=number or UNSET)


class Attempts:
    """The attempts at the trials of a run, as far as they have come."""

    def __init__(self, known: Iterable[Attempt] = ()) -> None:
        self._known: dict[Place, dict[int, bool]] = {}
        for one in known:
            self.add(one)

    def add(self, attempt: Attempt) -> None:
        """Take note of another attempt."""
        self._known.setdefault(attempt.place, {})[attempt.number] = attempt.voided

    @property
    def counted(self) -> int:
        """How many trials have an attempt that counts."""
        return sum(not all(one.values()) for one in self._known.values())

    @property
    def voided(self) -> int:
        """How many attempts were voided."""
        return sum(sum(one.values()) for one in self._known.values())

    def number(self, place: Place) -> int:
        """The number of the attempt that counts; of the next one, if all before were voided."""
        known = self._known.get(place, {})
        return max((number for number, voided in known.items() if not voided), default=max(known, default=-1) + 1)

    def counts(self, attempt: Attempt) -> bool:
        """Whether this is the attempt of its trial that counts."""
        return not attempt.voided and attempt.number == self.number(attempt.place)


def select(pairs: Iterable[tuple[_Pair, _Record]], given_up: Collection[str] = ()) -> list[tuple[_Pair, _Record]]:
    """Those of some records of a run that count, in their order; each comes with whatever belongs to it.

    ``given_up`` has the keys of voided trials that are wanted as well, unless they were repeated.
    """
    held = [(pair, attempt_of(pair[1], given_up)) for pair in pairs]
    known = Attempts(attempt for _, attempt in held)
    return [pair for pair, attempt in held if known.counts(attempt)]


def select_records(records: Iterable[_Record]) -> list[_Record]:
    """Those of some records of a run that count, each once, in their order."""
    found = {record.key: record for record in records}
    return [record for _, record in select(found.items())]


def voided_trials(records: Iterable[TrialRecord], known: Corrections | None = None) -> tuple[VoidedTrial, ...]:
    """The attempts among some records that were voided, in their order; ``known``: the records' corrections."""
    later = {line.trial: line.number for line in (known.in_effect if known else ()) if isinstance(line, VoidTrial)}
    return tuple(
        VoidedTrial(
            key=record.key,
            task=record.spec.task.id,
            session=record.spec.session,
            index=record.spec.index,
            attempt=record.spec.attempt or 0,
            reason=record.log.voided,
            correction=later.get(record.key, UNSET),
        )
        for record in records
        if record.log.voided
    )
