"""The form of an entry's file: its schema, and its canonical spelling of white space and order of keys."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from hthor import jsonio
from hthor.leaderboard import schema
from hthor.leaderboard.entries import files
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.files import BoardError, Problem

SPELLING = "$ (canonical form)"
"""The field that is named when only the spelling is wrong."""


def form_problems(path: Path) -> Iterator[Problem]:
    """What is wrong with the form of an entry's file."""
    try:
        entry = files.read_form(path)
    except BoardError as error:
        field, _, problem = str(error).removeprefix(f"{path}: ").partition(": ")
        yield Problem(file=str(path), field=field, problem=problem)
        return
    wrong = list(_strictly(path, entry))
    yield from wrong
    if wrong:
        return
    if entry.id != path.stem:
        yield Problem(file=str(path), field="id", problem=f"is '{entry.id}', but must be the file's, '{path.stem}'")
    if jsonio.pretty(entry) != path.read_bytes():
        how = "sorted keys, two spaces, a newline at the end; 'hthor leaderboard validate --fix' writes that"
        yield Problem(file=str(path), field=SPELLING, problem=f"is not {how}")


def fix_forms(paths: Sequence[Path]) -> list[Path]:
    """Rewrite valid files that are not in canonical form; return their paths."""
    fixed = []
    for path in paths:
        try:
            entry = files.read_form(path)
        except BoardError:
            continue
        if not list(_strictly(path, entry)) and jsonio.pretty(entry) != path.read_bytes():
            files.write_document(path, entry)
            fixed.append(path)
    return fixed


def _strictly(path: Path, entry: Entry) -> Iterator[Problem]:
    """What the schema requires beyond the types of the fields."""
    for field, problem in schema.schema_problems(path.read_bytes(), entry):
        yield Problem(file=str(path), field=field, problem=problem)
