"""What the schema of an entry demands beyond the types of its fields, checked without a library for schemas.

Every field must be there, no other may, and some have limits that a record cannot state.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import msgspec
from msgspec import Struct

from hthor import documents
from hthor.leaderboard import schema
from hthor.leaderboard.entries.entry import Entry

_SHOWN = 60


def problems(data: bytes, entry: Entry) -> Iterator[tuple[str, str]]:
    """Pairs of a field and what is wrong there, in an entry that was read from this file's content."""
    there: Any = documents.decode(data, Any)  # type: ignore[arg-type]
    yield from _fields(there, entry, "")


def _fields(there: Any, held: Any, where: str) -> Iterator[tuple[str, str]]:
    """Compare a document with the record that was made of it, part by part."""
    if isinstance(held, Struct):
        names = [field.name for field in msgspec.structs.fields(held)]
        parts = {name: getattr(held, name) for name in names}
        wanted = {name: part for name, part in parts.items() if part is not msgspec.UNSET and name != schema.NEVER}
        yield from ((_at(where, name), "is no field of an entry") for name in sorted(there.keys() - wanted.keys()))
        yield from ((_at(where, name), "is missing") for name in sorted(wanted.keys() - there.keys()))
        for name in sorted(wanted.keys() & there.keys()):
            if problem := _problem(wanted[name], schema.demands(type(held).__name__, name)):
                yield _at(where, name), problem
            yield from _fields(there[name], wanted[name], _at(where, name))
    elif isinstance(held, dict):
        for name in sorted(held):
            yield from _fields(there[name], held[name], _at(where, name))
    elif isinstance(held, (list, tuple)):
        for number, part in enumerate(held):
            yield from _fields(there[number], part, _at(where, str(number)))


def _problem(value: Any, demands: dict[str, Any]) -> str:
    """What a field's value violates; None is judged by its type alone."""
    if value is None:
        return ""
    shown = f"{value!r:.{_SHOWN}}"
    if "minimum" in demands and value < demands["minimum"]:
        return f"{shown} is less than the minimum of {demands['minimum']}"
    if "maximum" in demands and value > demands["maximum"]:
        return f"{shown} is greater than the maximum of {demands['maximum']}"
    if "enum" in demands and value not in demands["enum"]:
        return f"{shown} is not one of {', '.join(demands['enum'])}"
    if "pattern" in demands and not re.search(demands["pattern"], value):
        return f"{shown} does not match '{demands['pattern']}'"
    return ""


def _at(where: str, name: str) -> str:
    return f"{where}.{name}" if where else name
