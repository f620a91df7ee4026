"""Tables on narrow screens: no number or name is split; columns are dropped, and as a last step rows become lists."""

import copy
import re
from collections.abc import Iterator
from typing import Any

from rich.cells import cell_len
from rich.console import Console, Group, RenderableType
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

_NUMBER = re.compile(r"[*<>±]*\s*[-+−]?\d[\d,]*(\.\d+)?(\s*(%|s|m|points|bytes?|…|±|to)\s*[-+−]?(\d[\d.,]*)?)*")
_SPARE = ("could have seen", "trials")
"""Headings of columns that are dropped first, in this order."""
_WIDEST = 10_000
_INDENT = "  "


class FittingConsole(Console):
    """A console that fits tables to its width before it prints them."""

    def print(self, *objects: Any, **how: Any) -> None:
        """Print as rich does, with tables fitted to the width."""
        super().print(*(fitted(one, self) if isinstance(one, (Table, Group)) else one for one in objects), **how)


def fitted(shown: RenderableType, console: Console) -> RenderableType:
    """A renderable that fits the console: unchanged, with narrower columns, with fewer columns, or as lists."""
    if isinstance(shown, Group):
        return Group(*(fitted(one, console) for one in shown.renderables))
    if not isinstance(shown, Table) or _width(shown, console) <= console.width:
        return shown
    dropped: list[str] = []
    for heading in ("", *_SPARE):
        dropped += [heading] if heading in map(_heading, shown.columns) and heading else []
        if (made := _narrowed(shown, console, dropped)) is not None:
            left = f"a wider screen also shows: {', '.join(dropped)}"
            return Group(made, Text(left)) if dropped else made
    return _stacked(shown, console.width)


def _narrowed(shown: Table, console: Console, dropped: list[str]) -> Table | None:
    """The table without some columns and with the others narrowed; None if it still does not fit."""
    table = copy.copy(shown)
    table.columns = [copy.copy(one) for one in shown.columns if _heading(one) not in dropped]
    for place, column in enumerate(table.columns):
        column._index = place
    most = [_most(column) for column in table.columns]
    room = console.width - (_width(table, console) - sum(most))
    widths = list(most)
    least = [_least(column) for column in table.columns]
    if sum(least) > room:
        return None
    while sum(widths) > room:
        widths[max(range(len(widths)), key=lambda k: (widths[k] - least[k], widths[k], -k))] -= 1
    for column, width in zip(table.columns, widths, strict=True):
        column.width = width
    return table


def _stacked(shown: Table, width: int) -> RenderableType:
    """One paragraph per row: its name, then one line for each other cell, or two if one is too long."""
    names = list(_headings(shown))
    wide = max((cell_len(name) for name in names[1:]), default=0)
    parts: list[RenderableType] = [Text(str(shown.title), style="italic"), Text()] if shown.title else []
    for row in zip(*(column.cells for column in shown.columns), strict=True):
        first, *others = (" ".join(str(cell).split()) for cell in row)
        parts.append(Text(f"{names[0]} {first}".strip()))
        for name, cell in zip(names[1:], others, strict=True):
            line = f"{_INDENT}{name}{' ' * (wide - cell_len(name))}{_INDENT}{cell}"
            fits = cell_len(line) <= width
            parts += [Text(one) for one in ([line] if fits else [_INDENT + name, 2 * _INDENT + cell]) if cell]
    return Group(*parts, Text())


def _headings(shown: Table) -> Iterator[str]:
    """Headings on one line each; a first line that several columns share is repeated for each."""
    above = ""
    for column in shown.columns:
        lines = str(column.header).split("\n")
        above = lines[0] or above if len(lines) > 1 else ""
        yield " ".join([above, *lines[1:]] if len(lines) > 1 else lines)


def _heading(column: Any) -> str:
    return str(column.header)


def _width(table: Table, console: Console) -> int:
    options = console.options.update(max_width=_WIDEST, width=_WIDEST)
    return Measurement.get(console, options, table).maximum


def _most(column: Any) -> int:
    """Width of the longest line in a column."""
    cells = (_heading(column), *map(str, column.cells))
    return max((cell_len(line) for cell in cells for line in cell.split("\n")), default=0)


def _least(column: Any) -> int:
    """Width of the longest unbreakable piece: a number with its unit, an interval, a word."""
    found = [cell_len(word) for word in _heading(column).split()]
    for cell in map(str, column.cells):
        for line in cell.split("\n"):
            whole = _NUMBER.fullmatch(line.strip()) is not None
            found += [cell_len(line)] if whole else [cell_len(word) for word in line.split()]
    return max(found, default=0)
