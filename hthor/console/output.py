"""Printing: data go to standard output, messages to standard error."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TextIO

from hthor.console import formats
from hthor.console.formats import Format

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

_PIPE_COLUMNS = 120
documents: list[int] = []
"""Sizes of the JSON documents that were written: a command writes only one, so that a program can read it."""


def console(*, talk: bool = False) -> Console:
    """A console on standard output, or on standard error for ``talk``.

    NO_COLOR and FORCE_COLOR are heeded. Tables are fitted to the width. Where the width is unknown, as in a pipe, it is
    wide enough for our tables.
    """
    from hthor.console.table_fitting import FittingConsole

    stream: TextIO = sys.stderr if talk else sys.stdout
    wide = None if stream.isatty() or "COLUMNS" in os.environ else _PIPE_COLUMNS
    return FittingConsole(file=stream, width=wide, emoji=False)  # agent.py:B: is not an emoji


def say(text: str, to: Console | None = None) -> None:
    """Print a sentence as it stands, on standard error unless a console is given; the terminal breaks long lines."""
    (to or console(talk=True)).print(text, markup=False, highlight=False, soft_wrap=True)


def live() -> bool:
    """Whether standard error is a terminal that can be redrawn, and this is not a CI job."""
    return sys.stderr.isatty() and os.environ.get("TERM") != "dumb" and not os.environ.get("CI")


def put_json(document: Any) -> None:
    """Write a document to standard output as JSON for people and programs alike."""
    from hthor import jsonio

    text = jsonio.pretty(document).decode()
    documents.append(len(text))
    sys.stdout.write(text)
    sys.stdout.flush()


def put_files(paths: Sequence[object], json: bool, **more: Any) -> None:
    """Print which files were written: one line per file, or a JSON document that also has ``more``."""
    if json:
        put_json({"files": [str(path) for path in paths], **more})
    else:
        sys.stdout.write("".join(f"{path}\n" for path in paths))


def following(*commands: str) -> list[str]:
    """Lines that name the next commands: one command per line, so that each can be copied as it stands."""
    return [f"{'      ' if number else 'next: '} {command}" for number, command in enumerate(commands)]


def put_line(text: str, shape: Format = Format.TABLE) -> None:
    """Write a paragraph to standard output, with line breaks on a terminal.

    Where tables have another ``shape`` than the terminal's, standard output has only tables, and sentences go to
    standard error.
    """
    talk = shape is not Format.TABLE
    stream = sys.stderr if talk else sys.stdout
    console(talk=talk).print(text, markup=False, highlight=False, soft_wrap=not stream.isatty())


def put_rich(shown: RenderableType, shape: Format = Format.TABLE) -> None:
    """Write tables that rich can print to standard output, in this shape."""
    if shape is Format.TABLE:
        console().print(shown)
        return
    for title, headings, rows in formats.tables(shown):
        gap = "" if shape is Format.CSV else "\n"  # two Markdown tables without an empty line between them would be one
        sys.stdout.write(formats.render(headings, rows, shape, title) + gap)


def put_records(rows: Sequence[Mapping[str, object]]) -> None:
    """Write rows to standard output as CSV, one column per name."""
    sys.stdout.write(formats.render(*formats.records(rows), Format.CSV))


def put_table(headings: Sequence[str], rows: Iterable[Sequence[object]], shape: Format = Format.TABLE) -> None:
    """Write a table to standard output."""
    if shape is not Format.TABLE:
        sys.stdout.write(formats.render(headings, rows, shape))
        return
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    held = [[_word(cell) for cell in row] for row in rows]
    for column, heading in enumerate(headings):
        numeric = all(isinstance(row[column], (int, float)) for row in held) if held else False
        table.add_column(heading, justify="right" if numeric else "left", overflow="fold")
    for row in held:
        table.add_row(*(Text(str(cell)) for cell in row))
    console().print(table)


def put_rows(rows: Sequence[Mapping[str, Any]], short: Sequence[str] = (), shape: Format = Format.TABLE) -> None:
    """Write rows as a table with their names as headings; the columns ``short`` have only the beginning of hashes."""
    headings = list(rows[0]) if rows else ["nothing"]
    put_table(headings, [[row[name][:10] if name in short else row[name] for name in headings] for row in rows], shape)


def _word(cell: object) -> object:
    if isinstance(cell, (tuple, list, frozenset)):
        return ", ".join(str(part) for part in cell)
    return cell
