"""The JSON schema of an entry and of the list, made from their records, and a check with the same rules.

Rules that records cannot express, such as that a share is between 0 and 1, are in a table here.
"""

import re
from collections.abc import Iterator
from typing import Any

import msgspec
from msgspec import Struct

from hthor import documents
from hthor.eval.config.human_populations import HumanModelRef
from hthor.eval.config.run_config import RunConfig
from hthor.eval.results.paired_difference import Difference
from hthor.eval.statistics.intervals import Estimate
from hthor.guest import Isolation
from hthor.leaderboard.entries.entry import Counts, Entry, Trials
from hthor.leaderboard.ranking.board import Board
from hthor.types import RobotSeat

_NEVER = {RunConfig.__name__: ("shard", "options"), HumanModelRef.__name__: ("people",)}
"""Fields of each record that entries never have: an entry is a whole run, with one person in a trial."""
_MAYBE = {
    record.__name__: {field.name for field in msgspec.structs.fields(record) if field.default is msgspec.UNSET}
    for record in (RunConfig, RobotSeat, Trials, Entry)
}
"""Fields that may be left out."""
_SHOWN = 60
"""Characters of a wrong value that a message shows at most."""
_HASH = {"pattern": "^([0-9a-f]{64})?$"}
_RULES: tuple[tuple[type[Struct], str, dict[str, Any]], ...] = (
    (Estimate, "n", {"minimum": 0}),
    (Estimate, "mde80", {"minimum": 0}),
    (Difference, "n", {"minimum": 1}),
    (Difference, "p", {"minimum": 0, "maximum": 1}),
    (RunConfig, "participants", {"minimum": 1}),
    (RunConfig, "trials", {"minimum": 1}),
    (Isolation, "level", {"enum": ["L1", "L2", "L3"]}),
    *((Counts, name, {"minimum": 0}) for name in ("trials", "successes", "messages", "faults")),
)
_MORE = {(record.__name__, field): rule for record, field, rule in _RULES}
"""Rules for fields of records, in addition to their types."""


def field_rules(record: str, field: str) -> dict[str, Any]:
    """The rules for a field of a record in addition to its type, as keywords of JSON schema; may be empty."""
    more = _MORE.get((record, field), {})
    return more | _HASH if field == "sha256" or field.endswith("_sha256") else more


def json_schema() -> dict[str, Any]:
    """The schema, draft 2020-12, with both kinds of document under ``$defs``."""
    (entry, board), found = msgspec.json.schema_components((Entry, Board), ref_template="#/$defs/{name}")
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "hthor leaderboard",
        "description": "leaderboard.json, and each file in entries/. Made by 'hthor leaderboard build'.",
        "oneOf": [board, entry],
        "$defs": {name: _strict(name, one) for name, one in sorted(found.items())},
    }


def document_schema(kind: str) -> dict[str, Any]:
    """The schema of one kind of document, "Entry" or "Board"; its errors name the field more precisely."""
    whole = json_schema()
    return {"$schema": whole["$schema"], "$ref": f"#/$defs/{kind}", "$defs": whole["$defs"]}


def _strict(name: str, record: dict[str, Any]) -> dict[str, Any]:
    """The schema of a record in which every field is required and no other field is allowed."""
    fields = {field: one for field, one in record["properties"].items() if field not in _NEVER.get(name, ())}
    held = {field: _demanding(name, field, one) for field, one in fields.items()}
    about = {"description": record["description"].split("\n")[0]} if "description" in record else {}
    return {
        "title": record["title"],
        **about,
        "type": "object",
        "additionalProperties": False,
        "required": sorted(set(held) - _MAYBE.get(name, set())),
        "properties": held,
    }


def _demanding(name: str, field: str, schema: dict[str, Any]) -> dict[str, Any]:
    made = {key: value for key, value in schema.items() if key != "default"}
    more = field_rules(name, field)
    if "anyOf" in made:
        return {**made, "anyOf": [one | more if one.get("type") != "null" else one for one in made["anyOf"]]}
    return made | more


def schema_problems(data: bytes, entry: Entry) -> Iterator[tuple[str, str]]:
    """Problems, as pairs of a field and a description, of the file content from which an entry was read."""
    there: Any = documents.decode(data, Any)  # type: ignore[arg-type]
    yield from _fields(there, entry, "")


def _fields(there: Any, held: Any, where: str) -> Iterator[tuple[str, str]]:
    """Compare a document with the record that was made from it, part by part."""
    if isinstance(held, Struct):
        names = [field.name for field in msgspec.structs.fields(held)]
        parts = {name: getattr(held, name) for name in names}
        never = _NEVER.get(type(held).__name__, ())
        wanted = {name: part for name, part in parts.items() if part is not msgspec.UNSET and name not in never}
        yield from ((_at(where, name), "is no field of an entry") for name in sorted(there.keys() - wanted.keys()))
        yield from ((_at(where, name), "is missing") for name in sorted(wanted.keys() - there.keys()))
        for name in sorted(wanted.keys() & there.keys()):
            if problem := _problem(wanted[name], field_rules(type(held).__name__, name)):
                yield _at(where, name), problem
            yield from _fields(there[name], wanted[name], _at(where, name))
    elif isinstance(held, dict):
        for name in sorted(held):
            yield from _fields(there[name], held[name], _at(where, name))
    elif isinstance(held, (list, tuple)):
        for number, part in enumerate(held):
            yield from _fields(there[number], part, _at(where, str(number)))


def _problem(value: Any, demands: dict[str, Any]) -> str:
    """Which rule a field's value violates; None is checked by its type alone."""
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
