"""The form of an entry's file: its schema, and the one canonical spelling; judges no numbers.

Writes only what it is told to fix: white space and the order of keys, never a value.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from hthor import jsonio
from hthor.errors import MissingExtra
from hthor.leaderboard import files, schema
from hthor.leaderboard.files import BoardError, Problem

SPELLING = "$ (canonical form)"
"""The field that is named when all is well but the spelling."""


def problems(path: Path) -> Iterator[Problem]:
    """What is wrong with the form of an entry's file."""
    wrong = list(_by_schema(path))
    yield from wrong
    if wrong:
        return
    try:
        entry = files.read(path)
    except BoardError as error:
        file, field, problem = str(error).split(": ", 2)
        yield Problem(file=file, field=field, problem=problem)
        return
    if entry.id != path.stem:
        yield Problem(file=str(path), field="id", problem=f"is '{entry.id}', but must be the file's, '{path.stem}'")
    if jsonio.pretty(entry) != path.read_bytes():
        how = "sorted keys, two spaces, a newline at the end; 'hthor leaderboard validate --fix' writes that"
        yield Problem(file=str(path), field=SPELLING, problem=f"is not {how}")


def _by_schema(path: Path) -> Iterator[Problem]:
    try:
        from jsonschema import Draft202012Validator
    except ImportError:
        raise MissingExtra("checking entries", "leaderboard") from None
    try:
        document = json.loads(path.read_bytes(), parse_constant=_no_number)
    except OSError as error:
        yield Problem(file=str(path), field="$", problem=f"cannot be read: {error.strerror}")
        return
    except ValueError as error:
        yield Problem(file=str(path), field="$", problem=f"is not JSON: {error}")
        return
    errors: Any = Draft202012Validator(schema.of("Entry")).iter_errors(document)
    for wrong in sorted(errors, key=lambda one: [str(part) for part in one.absolute_path]):
        field = ".".join(str(part) for part in wrong.absolute_path) or "$"
        yield Problem(file=str(path), field=field, problem=wrong.message[:300])


def _no_number(word: str) -> float:
    raise ValueError(f"{word} is no number")


def fix(paths: Sequence[Path]) -> list[Path]:
    """Write those of these files anew that are well but for their spelling; which ones."""
    fixed = []
    for path in paths:
        try:
            entry = files.read(path)
        except BoardError:
            continue
        if not list(_by_schema(path)) and jsonio.pretty(entry) != path.read_bytes():
            files.write(path, entry)
            fixed.append(path)
    return fixed
