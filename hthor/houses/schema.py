"""ProcTHOR's house file, schema 1.0.0, as records: reading, finiteness and structure.

Only the keys that hthor uses are declared; other keys are ignored. Lengths are metres and angles degrees in Unity's
left-handed frame: x right, y up, z forward, yaw clockwise seen from above.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct, field

from hthor import jsonio
from hthor.errors import HouseError

VERSION = "1.0.0"
_LIMIT = 1e9


class Corner(Struct, frozen=True):
    """A point; ``y`` is up."""

    x: float
    z: float
    y: float = 0.0


class Hole(Struct, frozen=True):
    """A corner of an opening on its wall: ``x`` along the wall from its first corner, ``y`` up."""

    x: float
    y: float


class Position(Struct, frozen=True):
    """A point with three coordinates."""

    x: float
    y: float
    z: float


class Rotation(Struct, frozen=True):
    """Euler angles; only the yaw ``y`` is used, and `hthor.houses.checks` reports the others."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


class Color(Struct, frozen=True):
    """Red, green, blue, 0 to 1."""

    r: float
    g: float
    b: float


class Material(Struct, frozen=True):
    """A surface's look."""

    name: str = ""
    color: Color | None = None


class RoomRow(Struct, frozen=True, rename="camel"):
    """One entry of ``rooms``."""

    id: str
    room_type: str
    floor_polygon: list[Corner]
    floor_material: Material | None = None


class WallRow(Struct, frozen=True, rename="camel"):
    """One entry of ``walls``; an ``empty`` wall marks where two rooms are open to each other."""

    id: str
    room_id: str
    polygon: list[Corner]
    material: Material | None = None
    empty: bool | None = None


class OpeningRow(Struct, frozen=True, rename="camel"):
    """One entry of ``doors`` or ``windows``; door frames have neither ``openable`` nor ``openness``."""

    id: str
    room0: str
    room1: str
    wall0: str
    hole_polygon: list[Hole]
    wall1: str | None = None
    openable: bool | None = None
    openness: float | None = None
    asset_id: str = ""


class ObjectRow(Struct, frozen=True, rename="camel"):
    """One entry of ``objects``, or of an object's ``children``; ``position`` is the bounding box's centre."""

    id: str
    asset_id: str
    position: Position
    rotation: Rotation = field(default_factory=Rotation)
    openness: float | None = None
    children: list[ObjectRow] | None = None


class Agent(Struct, frozen=True):
    """Where a body starts; ``horizon`` is how far the camera looks down."""

    position: Position
    rotation: Rotation = field(default_factory=Rotation)
    horizon: float = 0.0


class Metadata(Struct, frozen=True, rename="camel"):
    """The file's version and start pose; newer files give one pose for each robot instead of a single one."""

    schema: str = VERSION
    agent: Agent | None = None
    agent_poses: dict[str, Agent | None] | None = None


class HouseFile(Struct, frozen=True):
    """A whole house file."""

    rooms: list[RoomRow]
    walls: list[WallRow]
    doors: list[OpeningRow]
    objects: list[ObjectRow]
    metadata: Metadata
    windows: list[OpeningRow] | None = None


def read_house_file(path: Path, file: str) -> tuple[Any, HouseFile]:
    """The file's JSON document, and the same as records; ``file`` is its name as the user gave it, for errors.

    Raises:
        HouseError: when the file cannot be read, is not JSON, contains a number that is not finite, has another
            version, or lacks a key or has a value of the wrong type.
    """
    document = _document(path, file)
    return document, convert_document(document, file)


def convert_document(document: Any, file: str) -> HouseFile:
    """A house's JSON document as records; errors as for `read_house_file`, with the name ``file``."""
    try:
        for where, value in _values(document, ""):
            if isinstance(value, str):
                if not jsonio.is_text(value):
                    raise HouseError(file, where, f"a lone surrogate, half of a character: {value!a:.60}")
            elif not abs(value) < _LIMIT:
                raise HouseError(file, where, f"must be a finite number, at most {_LIMIT:g} in size, got {value!r:.24}")
        _check_version(document, file)
        return msgspec.convert(document, HouseFile)
    except msgspec.ValidationError as error:
        raise _structural(str(error), file) from None
    except RecursionError:
        raise HouseError(file, "$", "not a house file: it is nested too deeply") from None


def _document(path: Path, file: str) -> Any:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise HouseError(file, "$", f"cannot read the file: {error.strerror or error}") from None
    except UnicodeDecodeError as error:
        raise HouseError(file, "$", f"not a text file: byte {error.start} is not UTF-8") from None
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        ends = " (the text ends there: is the file truncated?)" if not text[error.pos :].strip() else ""
        problem = f"not valid JSON at line {error.lineno}, column {error.colno}: {error.msg}{ends}"
        raise HouseError(file, "$", problem) from None
    except (RecursionError, ValueError) as error:
        raise HouseError(file, "$", f"not a house file: {error}") from None


def _values(value: Any, where: str) -> Iterator[tuple[str, str | float]]:
    """All texts, keys included, and numbers, with their field paths."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield where or "$", key
            yield from _values(item, f"{where}.{key}" if where else str(key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _values(item, f"{where}[{index}]")
    elif isinstance(value, str | int | float):
        yield where or "$", value


def _check_version(document: Any, file: str) -> None:
    metadata = document.get("metadata") if isinstance(document, dict) else None
    version = metadata.get("schema", VERSION) if isinstance(metadata, dict) else VERSION
    if version != VERSION:
        raise HouseError(file, "metadata.schema", f"only schema {VERSION} can be read, got {version!r}")


_WHERE = re.compile(r"^(?P<what>.*?)(?: - at `\$\.?(?P<field>.*)`)?$", re.DOTALL)
_MISSING = re.compile(r"Object missing required field `(?P<key>[^`]*)`")
_TYPE = re.compile(r"Expected `(?P<wanted>[^`]*)`, got `(?P<got>[^`]*)`")
_WORDS = {
    "float": "a number",
    "int": "a number",
    "str": "a text",
    "bool": "true or false",
    "array": "a list",
    "object": "an object",
    "null": "null",
}


def _structural(message: str, file: str) -> HouseError:
    """The error for a structural fault, from msgspec's message."""
    match = _WHERE.match(message)
    what, where = (match["what"], match["field"] or "") if match else (message, "")
    if missing := _MISSING.match(what):
        return HouseError(file, f"{where}.{missing['key']}" if where else missing["key"], "is missing")
    if types := _TYPE.match(what):
        wanted = " or ".join(_WORDS.get(name, name) for name in types["wanted"].split(" | "))
        what = f"expected {wanted}, got {_WORDS.get(types['got'], types['got'])}"
    return HouseError(file, where or "$", what)
