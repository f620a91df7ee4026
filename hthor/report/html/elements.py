"""Pieces of a page: tables, figures, paragraphs; everything that is put in is escaped."""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from html import escape

from msgspec import Struct

from hthor.report.html import markup
from hthor.report.html.markup import Markup, tag

_WORD_MAX, _PARTS = 24, re.compile(r"[^_+/.:-]+[_+/.:-]*|[_+/.:-]+")
"""Letters of a word that is not broken, and what a longer one is made of."""
_MANY = 3
"""Of more columns with intervals than these the intervals stand below the numbers."""


class Mark(Struct, frozen=True):
    """A word with a meaning of its own: ``mood`` is good, bad or quiet."""

    word: str
    mood: str


class Value(Struct, frozen=True):
    """A number, its ``interval``, and on a line of its own what else one has to know of it."""

    number: str
    interval: str = ""
    note: str = ""


class Code(Struct, frozen=True):
    """What a machine reads or wrote: a command, a hash."""

    text: str


class Band(Struct, frozen=True):
    """A row of a table that names those below it."""

    word: str


Cell = str | Mark
Piece = Cell | Value | Code


def paragraph(text: str, mood: str = "") -> str:
    """A paragraph."""
    return f"<p{_class(mood)}>{_held(text)}</p>"


def paragraphs(texts: Iterable[str]) -> str:
    """A paragraph each."""
    return "\n".join(paragraph(text) for text in texts)


def bullets(texts: Sequence[str]) -> str:
    """A list."""
    return "<ul>\n" + "\n".join(f"<li>{_held(text)}</li>" for text in texts) + "\n</ul>"


def table(
    head: Sequence[str], rows: Iterable[Sequence[Piece] | Band], caption: str = "", words: Collection[int] = (0,)
) -> str:
    """A table; the columns numbered in ``words`` hold words, the others numbers, with their intervals or without."""
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
    """A drawing, which is put in as it is, and what it shows."""
    parts = [caption] if isinstance(caption, str) else caption
    told = " ".join(inside(part) for part in parts)
    return (
        f'<figure{_class(mood)}><div class="art">{drawing}</div>'
        + (f"<figcaption>{told}</figcaption>" if told else "")
        + "</figure>"
    )


def drawn(drawings: Mapping[str, str], name: str, caption: str) -> str:
    """The drawing of that name, nothing where there is none."""
    return figure(drawings[name], caption) if name in drawings else ""


def listed(items: Iterable[Sequence[Piece]]) -> str:
    """A list of lines, each of several pieces."""
    return "<ul>\n" + "\n".join(f"<li>{''.join(inside(one) for one in parts)}</li>" for parts in items) + "\n</ul>"


def block(text: str) -> str:
    """Lines as they are: a traceback, a command."""
    return f"<pre>{escape(text)}</pre>"


def folded(title: str, *parts: str) -> str:
    """Parts that are shown when one asks for them, and in print."""
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
    """A whole page of pieces that were made here."""
    return markup.page(title, map(Markup, body), rules, description=description)


def mark(yes: bool, good: str = "yes", bad: str = "no") -> Mark:
    """A verdict."""
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
    """A cell as a part of a line."""
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
    """Text whose numbers stay with their units, and whose overlong words, such as names, may be broken."""
    whole = re.sub(r"(?<=\d) (?=(?:%|s|m)(?!\w))", "\u00a0", text)
    return "".join(_broken(word) if len(word) > _WORD_MAX else escape(word) for word in re.split(r"(\s+)", whole))


def _broken(word: str) -> str:
    """A word with places where a line may end: after marks that join words, else after so many letters."""
    parts = (part[at : at + _WORD_MAX] for part in _PARTS.findall(word) for at in range(0, len(part), _WORD_MAX))
    return "<wbr>".join(escape(part) for part in parts)


def _class(name: str) -> str:
    return f' class="{name}"' if name else ""
