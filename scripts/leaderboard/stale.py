"""Takes the references off a board, with their verifications, so that others can take their place: `stale.py BOARD`."""

from __future__ import annotations

import sys
from pathlib import Path

from hthor.leaderboard.entries import files, verification
from hthor.leaderboard.entries.entry import SCHEMA
from hthor.leaderboard.entries.files import BoardError


def main(board: Path) -> None:
    """Delete their files; entries of submitted agents stay, and those of another version, which cannot be read."""
    for path in files.entry_paths(board):
        try:
            entry = files.read_entry(path)
        except BoardError as error:
            sys.stdout.write(f"{path}: is no {SCHEMA}, left as it is: {error}\n")
            continue
        if entry.reference:
            sys.stdout.write(f"{path}: taken off\n")
            path.unlink()
            (board / verification.VERIFICATIONS / path.name).unlink(missing_ok=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
