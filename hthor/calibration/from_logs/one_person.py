"""A trial of several people as one record for each of them, as if that person had been alone with the robots."""

from typing import TypeVar

import msgspec

from hthor.eval.records.trial_record import TrialRecord
from hthor.types import HUMAN, HumanSeat, is_person
from hthor.types.events import Covered, Event, LogEntry, MessageEvent

_Entry = TypeVar("_Entry", bound=LogEntry)


def split_by_person(record: TrialRecord) -> list[TrialRecord]:
    """For each person the trial from their side: their seat is `HUMAN`, and nobody else's doings are in it.

    What became of a message is that person's part of it; all that was sent stays, so that messages can be looked up.
    """
    return [_side(record, human) for human in record.spec.humans]


def _side(record: TrialRecord, human: HumanSeat) -> TrialRecord:
    seat = human.seat
    return msgspec.structs.replace(
        record,
        spec=msgspec.structs.replace(record.spec, humans=(msgspec.structs.replace(human, seat=HUMAN),)),
        events=tuple(_own(event, seat) for event in record.events if _concerns(event, seat)),
        journal=tuple(_own(entry, seat) for entry in record.journal if entry.seat == seat),
        paths={_name(one, seat): path for one, path in record.paths.items() if one == seat or not is_person(one)},
        ratings={HUMAN: record.ratings.get(seat)},
        idle={_name(one, seat): ticks for one, ticks in record.idle.items() if one == seat or not is_person(one)},
    )


def _concerns(event: Event, seat: str) -> bool:
    """Whether the event is this person's, a robot's or the whole trial's."""
    if isinstance(event, Covered):
        return event.reader in ("", seat)
    if isinstance(event, MessageEvent):
        return event.seat == seat
    return event.kind in ("sent", "progress", "success") or event.seat == seat or not is_person(event.seat)


def _own(entry: _Entry, seat: str) -> _Entry:
    return msgspec.structs.replace(entry, seat=HUMAN) if entry.seat == seat != HUMAN else entry


def _name(seat: str, person: str) -> str:
    return HUMAN if seat == person else seat
