"""Tables as CSV, Markdown and LaTeX: what is written is read back as what it was."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from hthor.cli import app
from hthor.console import formats
from hthor.console.formats import Format
from hthor.errors import HthorError
from scripts import cli_reference

CELLS = st.text(
    st.characters(codec="utf-8", exclude_characters="\r\n\x0b\x0c\x1c\x1d\x1e\x85\u2028\u2029"), max_size=12
)
TABLES = st.integers(1, 4).flatmap(
    lambda wide: st.tuples(
        st.lists(CELLS, min_size=wide, max_size=wide),
        st.lists(st.lists(CELLS, min_size=wide, max_size=wide), max_size=4),
    )
)


@given(TABLES)
def test_csv_is_read_back_as_it_was(table: tuple[list[str], list[list[str]]]) -> None:
    headings, rows = table
    text = formats.render(headings, rows, Format.CSV)
    _, *back = csv.reader(io.StringIO(text))
    assert [[cell.removeprefix("'") for cell in row] for row in back] == [
        [cell.removeprefix("'") for cell in row] for row in rows
    ]
    assert not any(cell[:1] in ("=", "@") for row in back for cell in row), "no spreadsheet takes it for a formula"


@given(TABLES)
def test_latex_has_a_cell_for_each_cell_and_nothing_unescaped(table: tuple[list[str], list[list[str]]]) -> None:
    headings, rows = table
    text = formats.render(headings, rows, Format.LATEX)
    body = [line for line in text.splitlines() if line.endswith(r"\\")]
    assert len(body) == 1 + len(rows)
    for line in body:
        plain = line.removesuffix(r"\\").replace(r"\&", "").replace(r"\%", "").replace(r"\#", "").replace(r"\_", "")
        assert plain.count("&") == len(headings) - 1
        assert not set("%#_") & set(plain)


@given(TABLES)
def test_markdown_has_a_cell_for_each_cell(table: tuple[list[str], list[list[str]]]) -> None:
    headings, rows = table
    lines = formats.render(headings, rows, Format.MARKDOWN).splitlines()
    assert len(lines) == 2 + len(rows)
    for line in lines:
        assert line.replace("\\\\", "").replace("\\|", "").count("|") == len(headings) + 1


def test_what_latex_takes_for_commands_is_printed() -> None:
    assert formats.tex(r"50 % of a_b & $x^2$ \n {c} ~ 1 … 2") == (
        r"50 \% of a\_b \& \$x\textasciicircum{}2\$ \textbackslash{}n \{c\} \textasciitilde{} 1 \ldots{} 2"
    )
    assert formats.tex("63.3 %\n45.6 … 78.1") == r"\shortstack[r]{63.3 \% \\ 45.6 \ldots{} 78.1}"


def test_numbers_are_on_the_right() -> None:
    rows = [["a", 1.5, "63.3 %\n45.6 … 78.1", "x"], ["b", None, "–", "2 of 3"]]
    assert "{lrrl}" in formats.render(["name", "n", "rate", "how"], rows, Format.LATEX)
    assert "|---|---:|---:|---|" in formats.render(["name", "n", "rate", "how"], rows, Format.MARKDOWN)


@pytest.mark.parametrize(
    "words", [["humans", "list"], ["tasks", "list"], ["tasks", "list", "smoke"], ["robots", "list"]]
)
def test_lists_have_every_format(words: list[str]) -> None:
    def said(*more: str) -> str:
        found = CliRunner().invoke(app, [*words, *more])
        assert found.exit_code == 0, found.output
        return found.stdout

    rows = list(csv.reader(io.StringIO(said("--format", "csv"))))
    assert len(json.loads(said("--format", "json"))) == len(rows) - 1
    assert said("--json") == said("--format", "json")
    assert said("--format", "markdown").count("\n") == len(rows) + 1
    assert said("--format", "latex").endswith("\\bottomrule\n\\end{tabular}\n")


def test_two_formats_at_once_are_a_mistake() -> None:
    found = CliRunner().invoke(app, ["humans", "list", "--json", "--format", "csv"])
    assert found.exit_code == 2
    assert "exclude each other" in found.output


def test_commands_with_tables_of_results_have_formats() -> None:
    those = {name for name, one in cli_reference.leaves() if any("--format" in param.opts for param in one.params)}
    assert those >= {"hthor compare", "hthor score", "hthor power", "hthor runs list", "hthor runs view"}


def test_the_page_names_every_format(root: Path) -> None:
    text = (root / "docs" / "cli.md").read_text()
    assert all(f"`--format {shape}`" in text for shape in Format if shape is not Format.TABLE)


def test_the_board_is_listed_from_what_was_built(root: Path, tmp_path: Path) -> None:
    def said(*more: str) -> str:
        found = CliRunner().invoke(app, ["leaderboard", "list", "--board", str(root / "leaderboard"), *more])
        assert found.exit_code == 0, found.output
        return found.stdout

    entries = list((root / "leaderboard" / "entries").glob("*.json"))
    rows = list(csv.DictReader(io.StringIO(said("--format", "csv"))))
    assert len(rows) == len(entries)
    assert all(0.0 <= float(row["sr_mean"]) <= 1.0 for row in rows)
    assert all(row["agent"] in said() for row in rows)
    with pytest.raises(HthorError, match="hthor leaderboard build"):
        CliRunner().invoke(app, ["leaderboard", "list", "--board", str(tmp_path)], catch_exceptions=False)
