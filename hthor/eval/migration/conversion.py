"""Converts one trial of the last release: its specification, its events and its journal."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import msgspec
from msgspec import UNSET

from hthor import documents
from hthor.documents import Unreadable
from hthor.episode import EpisodeLog
from hthor.eval.migration.old_format import OldEvent, OldRecord, OldSpec
from hthor.eval.records import trial_record
from hthor.eval.records.trial_record import TrialRecord
from hthor.types import HUMAN, HumanSeat, TrialSpec
from hthor.types.events import Event, JournalEntry, Note, Thought

_KINDS = {"confirmed": "accepted"}
_ANSWERS = {"confirm": "accept"}
_PLAIN = (bool, int, float, str)
_OWN_KINDS = frozenset({"stick", "head", "attempt", "exposure", "choice", "offer", "misled"})
"""The kinds of the old journal that hthor itself wrote; a user's own human model could add others."""


def convert_record(old: OldRecord) -> TrialRecord:
    """The record of log 1.0, with its key computed again.

    Raises:
        Unreadable: names the event and the field that cannot be converted.
    """
    log = EpisodeLog(
        events=_in_order(_converted("events", old.events, convert_event), old.ticks),
        paths=old.paths,
        ticks=old.ticks,
        met=old.met,
        ratings={HUMAN: old.trust},
        faults=old.faults,
        progress=old.progress,
        idle=old.idle,
        journal=_converted("journal", old.journal, convert_entry),
    )
    return msgspec.structs.replace(trial_record.make_record(convert_spec(old.spec), log), files=old.files)


def convert_spec(old: OldSpec) -> TrialSpec:
    """What decided the trial: its one person sits in the first seat, and played the session of their own number."""
    same = {name: getattr(old, name) for name in OldSpec.__struct_fields__ if name in TrialSpec.__struct_fields__}
    person = HumanSeat(seat=HUMAN, model=old.human, sha256=old.human_sha256, participant=old.participant)
    return TrialSpec(
        **same, humans=(person,), session=old.participant, clock="charged" if old.realtime is True else UNSET
    )


def convert_event(old: OldEvent) -> Event:
    """An event of the trial; raises Unreadable, which names the field."""
    data = {"fault": old.data.get("kind")} if old.kind == "fault" else old.data
    with documents.reading_errors():
        event: Event = msgspec.convert(_flat(old, data), Event)
    return event


def convert_entry(old: OldEvent) -> JournalEntry:
    """An entry of the journal; one of a human model's own kind becomes a `Note`."""
    if old.kind not in _OWN_KINDS:
        values = {
            name: value if isinstance(value, _PLAIN) else msgspec.json.encode(value).decode()
            for name, value in old.data.items()
        }
        return Note(tick=old.tick, seat=old.seat, topic=old.kind, values=values)
    data = dict(old.data)
    if "answer" in data:
        data["answer"] = _ANSWERS.get(data["answer"], data["answer"])
    with documents.reading_errors():
        entry: JournalEntry = msgspec.convert(_flat(old, data), JournalEntry)
    return entry


def _flat(old: OldEvent, data: Mapping[str, Any]) -> dict[str, Any]:
    return {"kind": _KINDS.get(old.kind, old.kind), "tick": old.tick, "seat": old.seat, **data}


def _converted(name: str, olds: Iterable[OldEvent], convert: Callable[[OldEvent], Any]) -> tuple[Any, ...]:
    found = []
    for number, old in enumerate(olds):
        try:
            found.append(convert(old))
        except Unreadable as error:
            raise Unreadable(f"{name}[{number}].{error.field}".removesuffix(".$"), error.problem) from None
    return tuple(found)


def _in_order(events: tuple[Event, ...], ticks: int) -> tuple[Event, ...]:
    """The events with each `Thought` at the tick at which its action took effect, not at which it was decided on.

    The thoughts whose actions never took effect, because the trial was over, are left out.
    """
    if not any(isinstance(event, Thought) for event in events):
        return events
    late = [
        msgspec.structs.replace(event, tick=event.tick + event.ticks) if isinstance(event, Thought) else event
        for event in events
    ]
    kept = [event for event in late if not isinstance(event, Thought) or event.tick < ticks]
    return tuple(sorted(kept, key=lambda event: event.tick))
