"""Tables in the formats that `--format` names.

Markdown and LaTeX have the content of the terminal table. CSV and JSON are for programs: their commands provide numbers
with full precision.
"""

from __future__ import annotations

import csv
import enum
import io
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rich.console import RenderableType

Row = Sequence[object]


class Format(enum.StrEnum):
    """The format of a table on standard output."""

    TABLE = "table"
    CSV = "csv"
    MARKDOWN = "markdown"
    LATEX = "latex"
    JSON = "json"


Shape = Annotated[
    Format,
    typer.Option(
        "--format",
        help="How tables are written: for the terminal, or as CSV, Markdown, LaTeX (with booktabs) or JSON.",
        show_default=True,
    ),
]


def asks_json(json: bool, shape: Format) -> bool:
    """Whether JSON was requested; --json and --format json mean the same, and raise BadParameter if they contradict."""
    if json and shape not in (Format.TABLE, Format.JSON):
        raise typer.BadParameter(f"--json and --format {shape} exclude each other", param_hint="--format")
    return json or shape is Format.JSON


def render(headings: Sequence[str], rows: Iterable[Row], shape: Format, title: str = "") -> str:
    """A table as CSV, Markdown or LaTeX, with a newline at the end; ``title`` is a line above it, except in CSV."""
    held = [[_plain(cell) for cell in row] for row in rows]
    if shape is Format.CSV:
        return _csv(headings, held)
    numeric = [bool(held) and all(_is_number(row[column]) for row in held) for column in range(len(headings))]
    texts = [[str(cell) for cell in row] for row in held]
    if shape is Format.MARKDOWN:
        return _markdown(headings, texts, numeric, title)
    if shape is Format.LATEX:
        return _latex(headings, texts, numeric, title)
    raise ValueError(f"a table is rendered as CSV, Markdown or LaTeX, not as {shape}")


def tables(shown: RenderableType) -> Iterator[tuple[str, list[str], list[list[str]]]]:
    """Title, headings and cells of every table in a rich renderable, as text."""
    from rich.console import Group
    from rich.table import Table

    if isinstance(shown, Group):
        for one in shown.renderables:
            yield from tables(one)
    elif isinstance(shown, Table):
        columns = [[str(cell) for cell in column.cells] for column in shown.columns]
        headings = [str(column.header) for column in shown.columns]
        yield str(shown.title or ""), headings, [list(row) for row in zip(*columns, strict=True)]


def flat(record: object, prefix: str = "") -> dict[str, object]:
    """A record as one CSV row: nested fields become ``outer_inner``, an interval ``ci95`` becomes two columns."""
    import msgspec

    document = msgspec.to_builtins(record) if isinstance(record, msgspec.Struct) else record
    found: dict[str, object] = {}
    for name, value in document.items() if isinstance(document, Mapping) else ():
        if name.startswith("ci"):
            low, high = value if value is not None else (None, None)
            found |= {f"{prefix}{name}_low": low, f"{prefix}{name}_high": high}
        elif isinstance(value, Mapping):
            found |= flat(value, f"{prefix}{name}_")
        elif not isinstance(value, (list, tuple)):
            found[prefix + name] = value
    return found


def records(rows: Sequence[Mapping[str, object]]) -> tuple[list[str], list[list[object]]]:
    """Headings and cells of rows that may have different columns."""
    headings = list(dict.fromkeys(name for row in rows for name in row))
    return headings, [[row.get(name) for name in headings] for row in rows]


def _plain(cell: object) -> object:
    if cell is None:
        return ""
    if isinstance(cell, (tuple, list, frozenset, set)):
        parts = sorted(map(str, cell)) if isinstance(cell, (frozenset, set)) else map(str, cell)
        return ", ".join(parts)
    return cell


_NUMBER = re.compile(r"[<>]?\s*[-+−]?\d[\d,]*(\.\d+)?(\s*(%|s|m|points))?(\s*….*)?")


def _is_number(cell: object) -> bool:
    text = str(cell)
    return text in ("", "–") or bool(_NUMBER.fullmatch(text.splitlines()[0]))


def _csv(headings: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([heading.replace("\n", " ").strip() for heading in headings])
    writer.writerows([[_guarded(cell) for cell in row] for row in rows])
    return out.getvalue()


def _guarded(cell: Any) -> Any:
    """A cell that no spreadsheet reads as a formula, since names of agents and files are untrusted."""
    return f"'{cell}" if isinstance(cell, str) and cell[:1] in ("=", "@", "\t", "\r") else cell


def _markdown(headings: Sequence[str], rows: Sequence[Sequence[str]], numeric: Sequence[bool], title: str) -> str:
    def line(cells: Iterable[str]) -> str:
        return f"| {' | '.join(cells)} |\n"

    def safe(text: str) -> str:
        text = re.sub(r"([\\`*_{}\[\]<>|])", r"\\\1", text)
        return "<br>".join(part.strip() for part in text.splitlines())

    head = f"**{safe(title)}**\n\n" if title else ""
    rule = "|" + "".join("---:|" if right else "---|" for right in numeric) + "\n"
    return head + line(map(safe, headings)) + rule + "".join(line(map(safe, row)) for row in rows)


_TEX = {
    "\\": r"\textbackslash{}",
    "&": r"\&",
    "%": r"\%",
    "$": r"\$",
    "#": r"\#",
    "_": r"\_",
    "{": r"\{",
    "}": r"\}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"\textquotedbl{}",
    "…": r"\ldots{}",
    "–": "--",
    "−": "$-$",
    "±": r"$\pm$",
    "²": r"\textsuperscript{2}",
}


_BREAK = r" \\ "


def tex(text: str) -> str:
    """Text escaped for LaTeX; line breaks become stacked lines."""
    lines = ["".join(_TEX.get(letter, letter) for letter in part.strip()) for part in text.splitlines()]
    return rf"\shortstack[r]{{{_BREAK.join(lines)}}}" if len(lines) > 1 else "".join(lines)


def _latex(headings: Sequence[str], rows: Sequence[Sequence[str]], numeric: Sequence[bool], title: str) -> str:
    def line(cells: Iterable[str]) -> str:
        return f"  {' & '.join(cells)} \\\\\n"

    head = f"% {' '.join(title.split())}\n" if title else ""
    columns = "".join("r" if right else "l" for right in numeric)
    return (
        f"{head}% needs \\usepackage{{booktabs}} and \\usepackage[T1]{{fontenc}}\n"
        f"\\begin{{tabular}}{{{columns}}}\n  \\toprule\n{line(map(tex, headings))}  \\midrule\n"
        + "".join(line(map(tex, row)) for row in rows)
        + "  \\bottomrule\n\\end{tabular}\n"
    )
