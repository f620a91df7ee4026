"""Tables on narrow screens: numbers, intervals and names stay whole, and nothing is lost in silence."""

from __future__ import annotations

import io
import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from rich import box
from rich.console import Group
from rich.table import Table

from hthor.console.table_fitting import FittingConsole

ROWS = (
    ("success rate [%]*", "58.3", "88.3", "+30.0", "+7.5 … +52.5", "28.5", "0.022", "60"),
    ("time-weighted success [%]", "46.4", "73.3", "+26.9", "+9.1 … +44.7", "> 100", "< 0.001", "2000"),
    ("mobile manipulation", "57.5", "100.0", "-25.0", "-100.0 … +75.3", "53.1", "0.188", "40"),
)
HEADINGS = ("", "my_new_agent", "oracle", "difference", "95 % interval", "could have seen", "p", "trials")


def _table(headings=HEADINGS, rows=ROWS, title="oracle against none: 60 tasks, 6 people") -> Table:
    made = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in headings:
        made.add_column(heading, justify="right" if heading else "left", overflow="fold")
    for row in rows:
        made.add_row(*row)
    return made


def _shown(shown, width: int) -> str:
    out = io.StringIO()
    FittingConsole(file=out, width=width).print(shown)
    return out.getvalue()


@pytest.mark.parametrize("width", [120, 80, 60, 40])
def test_no_number_and_no_word_is_broken(width: int):
    text = _shown(_table(), width)
    assert max(map(len, text.splitlines())) <= width
    dropped = re.findall(r"a wider screen also shows: (.*)", text)
    gone = [HEADINGS.index(name) for name in (dropped[0].split(", ") if dropped else [])]
    for row in ROWS:
        for place, cell in enumerate(row):
            if place in gone:
                continue
            for piece in cell.split() if place == 0 else [cell]:
                assert re.search(rf"(?<!\S){re.escape(piece)}(?!\S)", text), (width, piece)


def test_wide_enough_is_as_rich_prints_it_and_eighty_columns_keep_a_table():
    wide = _shown(_table(), 200)
    assert "could have seen" in wide
    assert "─" in _shown(_table(), 80)
    assert "─" not in _shown(_table(), 50), "a row is a list there"
    assert "could have seen" in _shown(_table(), 50), "and has everything"


def test_columns_that_share_a_heading_have_it_when_rows_are_lists():
    table = _table(("", "frontier\nsuccess %", "\nTWSR %"), [("careful", "63.3", "50.8")], "smoke")
    assert re.search(r"careful\n +frontier success %\s+63.3\n +frontier TWSR %\s+50.8", _shown(table, 20))


def test_what_stands_below_a_table_stays():
    text = _shown(Group(_table(), "and a last word"), 60)
    assert text.rstrip().endswith("and a last word")


@settings(max_examples=cases(60))
@given(
    st.integers(20, 100),
    st.lists(st.tuples(st.from_regex(r"[a-z]{1,12}", fullmatch=True), st.floats(-999, 999)), min_size=1, max_size=5),
)
def test_any_number_is_found_whole(width: int, rows: list[tuple[str, float]]):
    cells = [(name, f"{value:+.1f} points", f"{value - 1:.1f} … {value:.1f}") for name, value in rows]
    text = _shown(_table(("", "mean", "95 % interval"), cells), width)
    for name, *_ in cells:
        assert re.search(rf"(?<!\S){name}(?!\S)", text)
    for _, value in rows:
        assert f"{value:+.1f}" in text
