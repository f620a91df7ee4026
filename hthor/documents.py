"""Reading JSON files as typed records, or raising one error that names the file and the field.

Any damage ends in that error: text that is not JSON, bytes that are not UTF-8, nesting too deep, the wrong record.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import msgspec
from msgspec import Struct

from hthor.errors import HthorError

WHOLE = "$"
"""The field that stands for the file as a whole."""
_MESSAGE_MAX = 300
_T = TypeVar("_T")


class Unreadable(ValueError):
    """Bytes that are not the expected JSON document.

    Args:
        field: the place, such as ``tasks[3].goal``; ``$`` for the document as a whole.
        problem: what is wrong there.
    """

    def __init__(self, field: str, problem: str) -> None:
        self.field, self.problem = field, problem
        super().__init__(f"{field}: {problem}")


class _Versioned(Struct):
    schema: str = ""


def read(
    path: Path, kind: type[_T], error: type[HthorError], *, schema: str = "", shown: str = "", hint: str = ""
) -> _T:
    """The record in a JSON file.

    Args:
        kind: the record's type, as msgspec takes it.
        error: class of the error that is raised when the file cannot be used.
        schema: the required ``schema`` of the document; empty for any.
        shown: the file's name in the error, by default its path.
        hint: what to do next; ends the error.

    Raises:
        HthorError: of the class ``error``, naming the file and the field.
    """
    shown = shown or str(path)
    try:
        data = path.read_bytes()
    except OSError as problem:
        message = f"cannot be read: {problem.strerror or problem}"
        raise error.in_file(shown, WHOLE, _with(message, hint)) from None
    return parse(data, kind, error, shown=shown, schema=schema, hint=hint)


def read_or_none(path: Path, kind: type[_T], error: type[HthorError], *, schema: str = "", hint: str = "") -> _T | None:
    """The record in a JSON file, as by `read`; None if the file does not exist."""
    return read(path, kind, error, schema=schema, hint=hint) if path.is_file() else None


def parse(data: bytes, kind: type[_T], error: type[HthorError], *, shown: str, schema: str = "", hint: str = "") -> _T:
    """The record in the bytes of a file that is called ``shown``; otherwise like `read`."""
    try:
        return decode(data, kind, schema=schema)
    except Unreadable as problem:
        raise error.in_file(shown, problem.field, _with(problem.problem, hint)) from None


def decode(data: bytes, kind: type[_T], *, schema: str = "") -> _T:
    """The record in some bytes of JSON.

    Raises:
        Unreadable: when the bytes are not such a record, or have another ``schema``.
    """
    with reading_errors():
        if schema and (found := msgspec.json.decode(data, type=_Versioned).schema) != schema:
            raise Unreadable("schema", f"is '{found}', this version reads '{schema}'")
        return msgspec.json.decode(data, type=kind)


def schema_of(path: Path) -> str:
    """The schema that a JSON file names; empty for a file that names none or cannot be read."""
    try:
        return decode(path.read_bytes(), _Versioned).schema
    except (OSError, Unreadable):
        return ""


@contextmanager
def reading_errors() -> Iterator[None]:
    """Turn every error of decoding JSON into `Unreadable`; for callers with a decoder of their own."""
    try:
        yield
    except msgspec.ValidationError as error:
        problem, _, field = str(error).rpartition(" - at `") if " - at `" in str(error) else (str(error), "", "")
        field = field.rstrip("`").removeprefix(WHOLE).removeprefix(".")
        raise Unreadable(field or WHOLE, problem[:_MESSAGE_MAX]) from None
    except msgspec.DecodeError as error:
        raise Unreadable(WHOLE, f"is not JSON: {error}"[:_MESSAGE_MAX]) from None
    except UnicodeDecodeError as error:
        raise Unreadable(WHOLE, f"is not JSON: a text in it is not UTF-8 ({error.reason})") from None
    except RecursionError:
        raise Unreadable(WHOLE, "is not JSON of ours: it is nested too deeply") from None


def _with(problem: str, hint: str) -> str:
    return f"{problem}; {hint}" if hint else problem
