"""A validation on the terminal: the table of published and predicted figures, and the criteria."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from hthor.calibration.validation.report import tables
from hthor.calibration.validation.report.findings import Findings
from hthor.report.html.elements import Cell, Mark

if TYPE_CHECKING:
    from rich.table import Table
    from rich.text import Text

_STYLES = {"good": "green", "bad": "bold red", "quiet": "dim"}


def figures_table(found: Findings) -> Table:
    """The eight published figures, each compared with simulated study groups."""
    setting = found.setting
    title = f"{found.subject.name} people: {setting.participants} in each condition on {setting.suite}, groups of six"
    return _table(title, tables.TABLE, tables.table(found.table), words={0})


def gates_table(found: Findings) -> Table:
    """Every criterion, the finding, and the verdict."""
    rows = [[row[0], row[2], row[3]] for row in tables.gates(found.gates)]
    return _table("criteria", ("criterion", "found", "verdict"), rows, words=range(3))


def _table(title: str, head: Sequence[str], rows: tables.Rows, *, words: Collection[int]) -> Table:
    from rich import box
    from rich.table import Table

    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for column, heading in enumerate(head):
        table.add_column(heading, justify="left" if column in words else "right")
    for row in rows:
        table.add_row(*(_text(cell) for cell in row))
    return table


def _text(cell: Cell) -> Text:
    from rich.text import Text

    return Text(cell.word, style=_STYLES[cell.mood]) if isinstance(cell, Mark) else Text(cell)
