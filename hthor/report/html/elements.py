"""Builds parts of a page: tables, figures, paragraphs. Everything is escaped except drawings and parts made here."""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from html import escape

from msgspec import Struct

from hthor.report.html import markup
from hthor.report.html.markup import Markup, tag

_WORD_MAX, _PARTS = 24, re.compile(r"[^_+/.:-]+[_+/.:-]*|[_+/.:-]+")
"""Letters of the longest word that is not broken, and the pieces of a longer word."""
_MANY = 3
"""With more columns with intervals than this, the intervals stand below the numbers."""


class Mark(Struct, frozen=True):
    """A coloured word: ``mood`` is good, bad or quiet."""

    word: str
    mood: str


class Value(Struct, frozen=True):
    """A number, its ``interval``, and a note on a line of its own."""

    number: str
    interval: str = ""
    note: str = ""


class Code(Struct, frozen=True):
    """Text that a machine reads or wrote, such as a command or a hash."""

    text: str


class Band(Struct, frozen=True):
    """A row of a table that is a heading for the rows below it."""

    word: str


Cell = str | Mark
Piece = Cell | Value | Code


def paragraph(text: str, mood: str = "") -> str:
    """A paragraph."""
    return f"<p{_class(mood)}>{_held(text)}</p>"


def paragraphs(texts: Iterable[str]) -> str:
    """Each text as a paragraph."""
    return "\n".join(paragraph(text) for text in texts)


def bullets(texts: Sequence[str]) -> str:
    """A list."""
    return "<ul>\n" + "\n".join(f"<li>{_held(text)}</li>" for text in texts) + "\n</ul>"


def table(
    head: Sequence[str], rows: Iterable[Sequence[Piece] | Band], caption: str = "", words: Collection[int] = (0,)
) -> str:
    """A table; the columns numbered in ``words`` hold words, the others numbers with or without intervals."""
    held = list(rows)
    kinds = ["" if i in words else "n" for i in range(len(head))]
    for row in held:
        for i, cell in enumerate(() if isinstance(row, Band) else row):
            kinds[i] = "v" if isinstance(cell, Value) else kinds[i]
    top = (
        tag("th", Markup(_held(word)), scope="col", class_=kind or None) for kind, word in zip(kinds, head, strict=True)
    )
    body = (Markup(_row(row, kinds)) for row in held)
    title = tag("caption", tag("span", Markup(_held(caption)))) if caption else None
    return markup.table(top, body, title, "high" if kinds.count("v") > _MANY else "").html


def figure(drawing: str, caption: str | Sequence[Piece], mood: str = "") -> str:
    """A drawing, inserted without escaping, with its caption."""
    parts = [caption] if isinstance(caption, str) else caption
    told = " ".join(inside(part) for part in parts)
    return (
        f'<figure{_class(mood)}><div class="art">{drawing}</div>'
        + (f"<figcaption>{told}</figcaption>" if told else "")
        + "</figure>"
    )


def drawn(drawings: Mapping[str, str], name: str, caption: str) -> str:
    """The drawing of that name with its caption; empty if there is no such drawing."""
    return figure(drawings[name], caption) if name in drawings else ""


def listed(items: Iterable[Sequence[Piece]]) -> str:
    """A list of lines, each made of several pieces."""
    return "<ul>\n" + "\n".join(f"<li>{''.join(inside(one) for one in parts)}</li>" for parts in items) + "\n</ul>"


def block(text: str) -> str:
    """Lines shown unchanged, such as a traceback or a command."""
    return f"<pre>{escape(text)}</pre>"


def folded(title: str, *parts: str) -> str:
    """Parts that a reader has to open on the screen; in print they are always shown."""
    return f"<details><summary>{_held(title)}</summary>\n" + "\n".join(parts) + "\n</details>"


def section(number: int, name: str, title: str, *parts: str) -> str:
    """A numbered section; empty parts are left out."""
    body = "\n".join(part for part in parts if part)
    return f'<section id="{escape(name)}">\n<h2><span>{number}</span> {_held(title)}</h2>\n{body}\n</section>'


def navigation(titles: Mapping[str, str]) -> str:
    """Links to the numbered sections, by their names."""
    links = (
        f'<a href="#{name}">{number} {escape(title)}</a>' for number, (name, title) in enumerate(titles.items(), 1)
    )
    return f"<nav>{' '.join(links)}</nav>"


def page(title: str, body: Iterable[str], rules: str, description: str = "") -> str:
    """A whole page from parts made by this module's functions."""
    return markup.page(title, map(Markup, body), rules, description=description)


def mark(yes: bool, good: str = "yes", bad: str = "no") -> Mark:
    """A verdict: the word for yes in green, or the word for no in red."""
    return Mark(good, "good") if yes else Mark(bad, "bad")


def _row(row: Sequence[Piece] | Band, kinds: Sequence[str]) -> str:
    if isinstance(row, Band):
        return f'<tr class="band"><th scope="rowgroup" colspan="{len(kinds)}">{_held(row.word)}</th></tr>'
    return (
        "<tr>" + "".join(_cell(cell, i, kind) for i, (cell, kind) in enumerate(zip(row, kinds, strict=True))) + "</tr>"
    )


def _cell(cell: Piece, column: int, kind: str) -> str:
    tag = 'th scope="row"' if column == 0 else f"td{_class(kind)}"
    aligned = Value(cell) if kind == "v" and isinstance(cell, str) else cell
    return f"<{tag}>{inside(aligned)}</{tag.split()[0]}>"


def inside(cell: Piece) -> str:
    """A cell as part of a line."""
    match cell:
        case Mark():
            return f'<b class="{cell.mood}">{escape(cell.word)}</b>'
        case Value():
            interval = f" <i>{escape(cell.interval)}</i>" if cell.interval else ""
            note = f"<small>{escape(cell.note)}</small>" if cell.note else ""
            return f"<span>{escape(cell.number)}</span>{interval}{note}"
        case Code():
            return f"<code>{escape(cell.text)}</code>"
        case _:
            return _held(cell)


def _held(text: str) -> str:
    """Text in which numbers stay with their units, and overlong words, such as names, may be broken."""
    whole = re.sub(r"(?<=\d) (?=(?:%|s|m)(?!\w))", "\u00a0", text)
    return "".join(_broken(word) if len(word) > _WORD_MAX else escape(word) for word in re.split(r"(\s+)", whole))


def _broken(word: str) -> str:
    """A word with places where a line may end: after marks that join words, else after a fixed number of letters."""
    parts = (part[at : at + _WORD_MAX] for part in _PARTS.findall(word) for at in range(0, len(part), _WORD_MAX))
    return "<wbr>".join(escape(part) for part in parts)


def _class(name: str) -> str:
    return f' class="{name}"' if name else ""
