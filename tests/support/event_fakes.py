"""Events by name, and what they have besides tick and seat."""

from __future__ import annotations

from typing import Any, get_args

import msgspec

from hthor.types.events import Event, JournalEntry, LogEntry

_KINDS = {one.__struct_config__.tag: one for union in (Event, JournalEntry) for one in get_args(union)}
_USUAL = {
    "text": "here", "sender": "robot", "by": 1, "number": 1, "useful": True, "relevant": True, "gain": 0.0, "load": 0.0,
    "again": 0, "words": 1, "read_s": 1.0, "answer": "accept",
}  # fmt: skip


def make_event(tick: int, seat: str, kind: str, **fields: Any) -> Any:
    """An event of this kind; fields that it needs and that are not given have a usual value."""
    made = _KINDS[kind]
    needed = {one.name for one in msgspec.structs.fields(made) if one.required}
    usual = {name: value for name, value in _USUAL.items() if name in needed}
    return made(tick=tick, seat=seat, **(usual | fields))


def fields(event: LogEntry) -> dict[str, Any]:
    """What an event has besides its kind, tick and seat, as in JSON."""
    found: dict[str, Any] = msgspec.to_builtins(event)
    return {name: value for name, value in found.items() if name not in ("kind", "tick", "seat")}
