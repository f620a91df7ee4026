"""The board's files: where they lie, how they are read and written, and what is wrong with them; judges no numbers."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TypeVar

from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import HthorError
from hthor.leaderboard.entries import trial_outcomes
from hthor.leaderboard.entries.entry import Entry
from hthor.tasks.suites import commitment
from hthor.tasks.suites.commitment import Commitment

ENTRIES, SUITES, LIST, SCHEMA, PAGE = "entries", "suites", "leaderboard.json", "schema.json", "index.html"
_T = TypeVar("_T")


class BoardError(HthorError):
    """Files of the leaderboard that cannot be taken."""


class Problem(Struct, frozen=True, kw_only=True):
    """What is wrong: in which file, at which field ($ for the whole), and what was expected there."""

    file: str
    field: str
    problem: str

    @property
    def line(self) -> str:
        """All of it on one line."""
        return f"{self.file}: {self.field}: {self.problem}"


def refuse(found: Iterable[Problem]) -> None:
    """Do nothing when there are no problems.

    Raises:
        BoardError: names them all.
    """
    held = list(found)
    if held:
        raise BoardError("\n       ".join(one.line for one in held))


def entry_paths(board: Path) -> list[Path]:
    """The entries' files, by name."""
    return sorted((board / ENTRIES).glob("*.json"))


def seen(board: Path) -> Path:
    """The board's folder.

    Raises:
        BoardError: when there is none: a board that is looked for in the wrong place is not in order.
    """
    if not board.is_dir():
        raise BoardError(f"{board} is no folder. Name the board with --board; 'hthor leaderboard add' begins one.")
    return board


def read(path: Path) -> Entry:
    """An entry from its file.

    Raises:
        BoardError: when it cannot be read, or a column of its trials cannot, naming the field.
    """
    entry = form(path)
    try:
        trial_outcomes.unpack(entry.trials)
    except trial_outcomes.Unreadable as error:
        raise BoardError(f"{path}: trials.{error.field}: {error}") from None
    return entry


def form(path: Path) -> Entry:
    """An entry from its file; the columns of its trials may hold anything.

    Raises:
        BoardError: when it cannot be read, naming the field.
    """
    return documents.read(path, Entry, BoardError)


def parse(data: bytes, shown: str, sort: type[_T]) -> _T:
    """A document of this sort.

    Raises:
        BoardError: when it is none, naming the field.
    """
    return documents.parse(data, sort, BoardError, shown=shown)


def write(path: Path, document: object) -> None:
    """Write a document in canonical form: sorted keys, two spaces, a newline at the end."""
    jsonio.write(path, jsonio.pretty(document))


def commitments(board: Path) -> dict[str, Commitment]:
    """The commitments to official suites that lie with the board, by the hash of the suite."""
    held = [commitment.load_commitment(path) for path in sorted((board / SUITES).glob("*.json"))]
    return {one.suite_sha256: one for one in held}
