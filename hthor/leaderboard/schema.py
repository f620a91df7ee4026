"""The JSON schema of an entry and of the list, made from the records that they are.

What records cannot say, such as that a share lies between 0 and 1, is in a table here.
"""

from __future__ import annotations

from typing import Any

import msgspec

from hthor.eval.config.run_config import RunConfig
from hthor.leaderboard.entries.entry import Entry, Trials
from hthor.leaderboard.ranking.board import Board
from hthor.types import RobotSeat

NEVER = "shard"
"""The one field of a run that no entry has: an entry is a whole run."""
_MAYBE = {
    record.__name__: {field.name for field in msgspec.structs.fields(record) if field.default is msgspec.UNSET}
    for record in (RunConfig, RobotSeat, Trials)
}
"""Fields that are there only where they say something."""
_HASH = {"pattern": "^([0-9a-f]{64})?$"}
_MORE: dict[tuple[str, str], dict[str, Any]] = {
    ("Estimate", "n"): {"minimum": 0},
    ("Estimate", "mde80"): {"minimum": 0},
    ("Difference", "n"): {"minimum": 1},
    ("Difference", "p"): {"minimum": 0, "maximum": 1},
    ("Setup", "participants"): {"minimum": 1},
    ("Setup", "trials"): {"minimum": 1},
    ("Isolation", "level"): {"enum": ["L1", "L2", "L3"]},
    **{("Counts", name): {"minimum": 0} for name in ("trials", "tasks", "successes", "messages", "faults")},
}
"""Further demands on a record's fields."""


def demands(record: str, field: str) -> dict[str, Any]:
    """What a field of a record must satisfy beyond its type, in words of JSON schema; empty for nothing."""
    more = _MORE.get((record, field), {})
    return more | _HASH if field == "sha256" or field.endswith("_sha256") else more


def document() -> dict[str, Any]:
    """The schema, draft 2020-12: either document is described under ``$defs``."""
    (entry, board), found = msgspec.json.schema_components((Entry, Board), ref_template="#/$defs/{name}")
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "hthor leaderboard",
        "description": "leaderboard.json, and each file in entries/. Made by 'hthor leaderboard build'.",
        "oneOf": [board, entry],
        "$defs": {name: _strict(name, one) for name, one in sorted(found.items())},
    }


def of(kind: str) -> dict[str, Any]:
    """The schema of one kind of document alone, "Entry" or "Board", whose errors name the field better."""
    whole = document()
    return {"$schema": whole["$schema"], "$ref": f"#/$defs/{kind}", "$defs": whole["$defs"]}


def _strict(name: str, record: dict[str, Any]) -> dict[str, Any]:
    """A record in which every field must be there and no other may."""
    held = {field: _demanding(name, field, one) for field, one in record["properties"].items() if field != NEVER}
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
    more = demands(name, field)
    if "anyOf" in made:
        return {**made, "anyOf": [one | more if one.get("type") != "null" else one for one in made["anyOf"]]}
    return made | more
