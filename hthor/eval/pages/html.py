"""Pieces of a page: tables, figures, paragraphs; everything that is put in is escaped. Knows nothing of results."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from html import escape

from msgspec import Struct


class Mark(Struct, frozen=True):
    """A word with a meaning of its own: ``mood`` is good, bad or quiet."""

    word: str
    mood: str


Cell = str | Mark


def paragraph(text: str, mood: str = "") -> str:
    """A paragraph."""
    return f"<p{_class(mood)}>{_held(text)}</p>"


def paragraphs(texts: Iterable[str]) -> str:
    """A paragraph each."""
    return "\n".join(paragraph(text) for text in texts)


def bullets(texts: Sequence[str]) -> str:
    """A list."""
    return "<ul>\n" + "\n".join(f"<li>{_held(text)}</li>" for text in texts) + "\n</ul>"


def table(head: Sequence[str], rows: Iterable[Sequence[Cell]], caption: str = "", words: Collection[int] = (0,)) -> str:
    """A table; the columns numbered in ``words`` hold words, the others numbers."""
    top = "".join(
        f'<th scope="col"{_class("" if i in words else "n")}>{escape(word)}</th>' for i, word in enumerate(head)
    )
    body = "\n".join(
        "<tr>" + "".join(_cell(cell, i, i in words) for i, cell in enumerate(row)) + "</tr>" for row in rows
    )
    title = f"<caption>{escape(caption)}</caption>" if caption else ""
    return f'<div class="wide"><table>{title}<thead><tr>{top}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>'


def figure(drawing: str, caption: str) -> str:
    """A drawing, which is put in as it is, and what it shows."""
    return f"<figure>{drawing}<figcaption>{_held(caption)}</figcaption></figure>"


def section(number: int, name: str, title: str, *parts: str) -> str:
    """A numbered section; empty parts are left out."""
    body = "\n".join(part for part in parts if part)
    return f'<section id="{escape(name)}">\n<h2><span>{number}</span> {escape(title)}</h2>\n{body}\n</section>'


def mark(yes: bool, good: str = "yes", bad: str = "no") -> Mark:
    """A verdict."""
    return Mark(good, "good") if yes else Mark(bad, "bad")


def _cell(cell: Cell, column: int, wordy: bool) -> str:
    tag = 'th scope="row"' if column == 0 else f"td{_class('' if wordy else 'n')}"
    inside = f'<b class="{cell.mood}">{escape(cell.word)}</b>' if isinstance(cell, Mark) else escape(cell)
    return f"<{tag}>{inside}</{tag.split()[0]}>"


def _held(text: str) -> str:
    """Text whose numbers stay with their units."""
    return escape(text).replace(" %", "\u00a0%")


def _class(name: str) -> str:
    return f' class="{name}"' if name else ""
