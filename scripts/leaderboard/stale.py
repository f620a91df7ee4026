"""Takes references off a board that another version of the code played than the newest: `stale.py BOARD`."""

from __future__ import annotations

import sys
from pathlib import Path

from hthor.eval import provenance
from hthor.leaderboard import files


def main(board: Path) -> None:
    """Delete their files; entries of submitted agents stay."""
    for path in files.entry_paths(board):
        entry = files.read(path)
        if entry.reference and entry.run.code_sha256 != provenance.code_sha256():
            sys.stdout.write(f"{path}: played by {entry.run.code_sha256[:10]}, taken off\n")
            path.unlink()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
