"""The log's reference is made from its records: tables in the docs, and a JSON schema that real logs are valid by."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, get_args

import jsonschema
import pytest

from hthor import jsonio
from hthor.eval.migration import conversion, old_format
from hthor.eval.records import trial_record
from hthor.humans.core import thoughts
from hthor.types.events import Event, JournalEntry, LogEntry
from scripts import log_reference

ROOT = Path(__file__).parents[2]
KINDS: list[type[LogEntry]] = [*get_args(Event), *get_args(JournalEntry)]
LINES = [
    trial_record.encode(conversion.convert_record(old_format.decode(line + b"\n")))
    for log in sorted((Path(__file__).parent / "last_release").glob("*/trials.jsonl"))
    for line in log.read_bytes().splitlines()
]


def test_the_tables_in_the_docs_are_made_from_the_classes() -> None:
    text = (ROOT / "docs" / "logs.md").read_text(encoding="utf-8")
    said = "run: python scripts/log_reference.py docs/logs.md docs/log.schema.json"
    assert log_reference.page(text) == text, said
    assert (ROOT / "docs" / "log.schema.json").read_bytes() == jsonio.pretty(log_reference.schema()), said
    with pytest.raises(ValueError, match="lacks the line"):
        log_reference.page("no table")


@pytest.mark.parametrize("kind", [*KINDS, *get_args(thoughts.HumanThought)], ids=lambda kind: kind.__name__)
def test_every_field_of_an_event_is_described(kind: type[LogEntry]) -> None:
    own = [name for name in kind.__struct_fields__ if name not in LogEntry.__struct_fields__]
    if kind in KINDS:
        assert [name for name, words in log_reference.fields(kind) if words] == own
    assert log_reference.meaning(kind).endswith(".")
    assert kind.__struct_config__.frozen
    assert kind(**dict.fromkeys(kind.__struct_fields__)).kind == kind.__struct_config__.tag


def test_kinds_are_all_different_and_classes_are_called_like_them() -> None:
    tags = [kind.__struct_config__.tag for kind in KINDS]
    assert len(set(tags)) == len(tags)
    names = {"".join(part.title() for part in str(tag).split("_")) for tag in tags}
    assert {kind.__name__ for kind in KINDS} ^ names == {"AgentFault", "Fault"}, "the episode has a record Fault"


@pytest.mark.parametrize("line", LINES)
def test_logs_are_valid_by_the_schema(line: bytes) -> None:
    document = json.loads(line)
    validator = jsonschema.Draft202012Validator(log_reference.schema())
    validator.check_schema(validator.schema)
    validator.validate(document)
    wrong: list[dict[str, Any]] = [
        document | {"schema": "hthor.trial/1.1"},
        document | {"events": [*document["events"], {"kind": "sent", "tick": 1, "seat": "robot"}]},
        document | {"events": [*document["events"], {"kind": "waved", "tick": 1, "seat": "robot"}]},
        {name: value for name, value in document.items() if name != "check"},
    ]
    assert not any(validator.is_valid(one) for one in wrong)
