"""Checking the data of a log's events, before they are scored or drawn; docs/files.md lists the kinds of events.

Task kinds and human models may add data of any form; the fields that are read later have types.
"""

from collections.abc import Sequence

import msgspec
from msgspec import UNSET, Struct, UnsetType

from hthor import documents
from hthor.documents import Unreadable
from hthor.types import Event, Vec3

_NEEDED = {
    "sent": ("message", "text"),
    **dict.fromkeys(("shown", "confirmed", "declined", "covered"), ("message",)),
    "progress": ("value",),
}
"""The fields that events of a kind must have."""


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
        Unreadable: names the event, by its number from 0, and the field.
    """
    for number, event in enumerate(events):
        try:
            with documents.reading_errors():
                msgspec.convert(event.data, _Data)
        except Unreadable as error:
            raise Unreadable(f"events[{number}].data.{error.field}", error.problem) from None
        if missing := next((name for name in _NEEDED.get(event.kind, ()) if name not in event.data), ""):
            raise Unreadable(f"events[{number}].data.{missing}", f"is missing; an event '{event.kind}' has it")
