"""Describes the log from its records: `python scripts/log_reference.py docs/logs.md docs/log.schema.json`.

The page gets a table of all events and one of all journal entries, each between two markers; the other file is the JSON
schema of a trial's line.
"""

import inspect
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import UnionType
from typing import Any, get_args

import msgspec

from hthor import jsonio, log_format
from hthor.eval.records.trial_record import TrialRecord
from hthor.types.events import Event, JournalEntry, LogEntry

TABLES: dict[str, UnionType] = {"events": Event, "journal": JournalEntry}
_MARK = "<!-- {}: python scripts/log_reference.py docs/logs.md docs/log.schema.json -->\n"
END = "<!-- end -->\n"
_FIELD = re.compile(r"(\w+): (.*)")


def page(text: str) -> str:
    """The page with its tables made again.

    Raises:
        ValueError: when a marker is missing.
    """
    for name, union in TABLES.items():
        before, begin, rest = text.partition(_MARK.format(name))
        _, end, after = rest.partition(END)
        if not begin or not end:
            raise ValueError(f"the page lacks the line '{(END if begin else _MARK.format(name)).strip()}'")
        head = _line(("kind", "what happened", "its fields")) + "|---|---|---|\n"
        text = before + begin + head + "".join(map(_row, get_args(union))) + end + after
    return text


def schema() -> dict[str, Any]:
    """The JSON schema, draft 2020-12, of a line of a log of this version."""
    _, found = msgspec.json.schema_components((TrialRecord,), ref_template="#/$defs/{name}")
    line = found.pop(TrialRecord.__name__)
    line["properties"] |= {
        "schema": {"const": log_format.SCHEMA},
        "check": {"type": "string", "pattern": "^[0-9a-f]{8}$"},
    }
    line["required"] = [*line["required"], "check"]
    for kind in (kind for union in TABLES.values() for kind in get_args(union)):
        for name, words in fields(kind):
            found[kind.__name__]["properties"][name]["description"] = words
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": log_format.SCHEMA,
        **{name: part for name, part in line.items() if name != "title"},
        "description": "A trial: one line of trials.jsonl. Written by scripts/log_reference.py.",
        "$defs": {name: {**one, **_first_sentence(one)} for name, one in sorted(found.items())},
    }


def fields(kind: type[LogEntry]) -> Iterator[tuple[str, str]]:
    """The fields of a kind of event in addition to tick and seat, each with its description."""
    _, _, listed = (inspect.getdoc(kind) or "").partition("\n\nAttributes:\n")
    text = re.sub(r"\n {8,}", " ", listed)
    for line in text.splitlines():
        if found := _FIELD.match(line.strip()):
            yield found[1], found[2].replace("``", "`")


def meaning(kind: type[LogEntry]) -> str:
    """What an event of this kind says."""
    return " ".join((inspect.getdoc(kind) or "").partition("\n\n")[0].split()).replace("``", "`")


def _first_sentence(one: dict[str, Any]) -> dict[str, str]:
    words = one.get("description", "")
    return {"description": " ".join(words.partition("\n\n")[0].split())} if words else {}


def _row(kind: type[LogEntry]) -> str:
    listed = "; ".join(f"`{name}`: {words.removesuffix('.')}" for name, words in fields(kind))
    return _line((f"`{kind.__struct_config__.tag}`", meaning(kind), listed))


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |\n"


if __name__ == "__main__":
    place, document = map(Path, sys.argv[1:])
    jsonio.write(place, page(place.read_text(encoding="utf-8")).encode())
    jsonio.write(document, jsonio.pretty(schema()))
