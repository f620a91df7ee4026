"""The board's files: their paths, and how to read and write them."""

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
    """Files of the leaderboard are not accepted."""


class Problem(Struct, frozen=True, kw_only=True):
    """A problem: the file, the field ($ for the whole file), and what is wrong there."""

    file: str
    field: str
    problem: str

    @property
    def line(self) -> str:
        """The whole problem on one line."""
        return f"{self.file}: {self.field}: {self.problem}"


def raise_problems(found: Iterable[Problem]) -> None:
    """Raise the problems as one error; do nothing if there are none.

    Raises:
        BoardError: if there are problems; names them all.
    """
    held = list(found)
    if held:
        raise BoardError("\n       ".join(one.line for one in held))


def entry_paths(board: Path) -> list[Path]:
    """The paths of the entries' files, sorted by name."""
    return sorted((board / ENTRIES).glob("*.json"))


def check_folder(board: Path) -> Path:
    """Check that the board's folder exists, and return it.

    Raises:
        BoardError: if it does not exist, so that a mistyped path is not treated as an empty board.
    """
    if not board.is_dir():
        raise BoardError(f"{board} is not a folder. Name the board with --board; 'hthor leaderboard add' creates one.")
    return board


def read_entry(path: Path) -> Entry:
    """Read an entry from its file.

    Raises:
        BoardError: if the file, or a column of its trials, cannot be read; names the field.
    """
    entry = read_form(path)
    try:
        trial_outcomes.unpack(entry.trials)
    except trial_outcomes.Unreadable as error:
        raise BoardError(f"{path}: trials.{error.field}: {error}") from None
    return entry


def read_form(path: Path) -> Entry:
    """Read an entry from its file without checking the columns of its trials.

    Raises:
        BoardError: if the file cannot be read; names the field.
    """
    return documents.read(path, Entry, BoardError)


def parse_document(data: bytes, shown: str, sort: type[_T]) -> _T:
    """Read a document of this type.

    Raises:
        BoardError: if it is not such a document; names the field.
    """
    return documents.parse(data, sort, BoardError, shown=shown)


def write_document(path: Path, document: object) -> None:
    """Write a document in canonical form: sorted keys, two spaces, a newline at the end."""
    jsonio.write(path, jsonio.pretty(document))


def read_commitments(board: Path) -> dict[str, Commitment]:
    """The board's commitments to official suites, by the hashes of the suites."""
    held = [commitment.load_commitment(path) for path in sorted((board / SUITES).glob("*.json"))]
    return {one.suite_sha256: one for one in held}
