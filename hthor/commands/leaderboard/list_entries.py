"""`hthor leaderboard list`: the board as tables."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hthor.commands.options import Json
from hthor.console import formats, output
from hthor.console.formats import Format, Shape

if TYPE_CHECKING:
    from hthor.leaderboard.ranking.board import Row

_METRICS = ("sr", "twsr", "adoption", "time_s", "trust")


def list_entries(
    board: Annotated[Path, typer.Option(help="Folder of the leaderboard.")] = Path("leaderboard"),
    shape: Shape = Format.TABLE,
    json: Json = False,
) -> None:
    """Show the board as tables, one for each group of comparable entries."""
    from hthor import code_identity, documents
    from hthor.errors import HthorError
    from hthor.leaderboard.entries import files
    from hthor.leaderboard.ranking.board import Board

    path = board / files.LIST
    if not path.is_file():
        raise HthorError(f"{path} does not exist. 'hthor leaderboard build --board {board}' makes it from the entries.")
    found = documents.read(path, Board, HthorError)
    if formats.asks_json(json, shape):
        output.put_json(found)
    elif shape is Format.CSV:
        rows = ((part, row) for part in found.sections for row in part.rows)
        output.put_records([{"suite": part.suite.name, "people": part.humans, **_flat(row)} for part, row in rows])
    else:
        headings = ("rank", "agent", "success", "time-weighted", "adoption", "time", "trust", "faults")
        for part in found.sections:
            output.put_line(f"{part.suite.name}, {part.trials} trials, {part.humans} people", shape)
            output.put_table(headings, map(_cells, part.rows), shape)
            if part.scoring != (here := code_identity.scoring_sha256()):
                by = f"version {part.scoring[:10]}" if part.scoring else "a version that was not noted"
                output.say(
                    f"scored by {by}, not by the present one, {here[:10]}; 'hthor leaderboard rescore --board {board}' "
                    "brings entries up to date"
                )


def _cells(row: Row) -> tuple[object, ...]:
    from hthor.eval.metrics import registry
    from hthor.report.terminal import result_tables

    shown = [result_tables.format_mean(getattr(row, name), registry.get(name).unit) for name in _METRICS]
    return (row.ranks.sr.rank if row.ranks else "–", row.name, *shown, row.faults)


def _flat(row: Row) -> dict[str, object]:
    """An entry as a spreadsheet row: rates as fractions, intervals in two columns."""
    ranks = {"rank": row.ranks.sr.rank if row.ranks else None}
    numbers = {f"{name}_{key}": value for name in _METRICS for key, value in formats.flat(getattr(row, name)).items()}
    return {"agent": row.name, "id": row.id, **ranks, **numbers, "faults": row.faults}
