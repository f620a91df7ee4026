"""What is made of the entries: the list, the schema and the page; the same entries give the same bytes."""

from __future__ import annotations

from pathlib import Path

from hthor import jsonio
from hthor.errors import HthorError
from hthor.leaderboard import board_check, schema
from hthor.leaderboard.entries import files, verification
from hthor.leaderboard.entries.files import Problem
from hthor.leaderboard.page import page
from hthor.leaderboard.ranking import admission, listing


def build(board: Path) -> list[Path]:
    """Write what is made of a board's entries; the files.

    Raises:
        BoardError: when entries are not in order, naming all that is wrong.
    """
    written = []
    for name, data in made(board).items():
        path = board / name
        if not path.is_file() or path.read_bytes() != data:
            jsonio.write(path, data)
        written.append(path)
    return written


def made(board: Path) -> dict[str, bytes]:
    """The files that a board's entries make, by name."""
    files.refuse(board_check.problems(board))
    entries = [files.read(path) for path in files.entry_paths(board)]
    found = listing.board(entries, verification.load(board), admission.load(board))
    return {
        files.LIST: jsonio.pretty(found),
        files.SCHEMA: jsonio.pretty(schema.document()),
        files.PAGE: page.render(found).encode(),
    }


def differences(board: Path) -> list[Problem]:
    """What of a board's files is not as its entries make them."""
    try:
        wanted = made(board)
    except HthorError:
        return board_check.problems(board)
    hint = "is not what the entries make; 'hthor leaderboard build' writes it"
    return [
        Problem(file=str(board / name), field="$", problem=hint)
        for name, data in wanted.items()
        if not (board / name).is_file() or (board / name).read_bytes() != data
    ]
