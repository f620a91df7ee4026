"""`hthor leaderboard`; knows nothing of what an entry is made of."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from hthor.cli.runs import Run

app = typer.Typer(no_args_is_help=True, help="The leaderboard's files.")


@app.callback()
def _group() -> None:
    """The leaderboard's files."""


@app.command("add")
def add(
    run: Run,
    board: Annotated[Path, typer.Option(help="The leaderboard's folder.")] = Path("leaderboard"),
) -> None:
    """Put a whole run on the leaderboard. Adding it again changes nothing."""
    from hthor.eval import board as boards

    _, path = boards.add(run, board)
    sys.stdout.write(f"{path}\n")
