"""HTML elements in which all text is escaped: the base of every page.

A `Markup` is HTML; a plain str is text and is escaped when it is put into an element. So the content of a
document, such as an entry of the leaderboard, reaches the page only as text.
"""

import base64
import hashlib
from collections.abc import Iterable
from html import escape

from msgspec import Struct

_VOID = ("meta", "link")  # HTML elements without an end tag; every SVG element needs one, or it holds the next one


class Markup(Struct, frozen=True):
    """A piece of HTML. Only the functions below make one."""

    html: str


Piece = Markup | str
NOTHING = Markup("")


def tag(name: str, /, *inside: Piece, **attributes: str | int | float | None) -> Markup:
    """An HTML element; text inside it is escaped.

    Args:
        attributes: None leaves an attribute out. A "_" in a name becomes "-"; a final "_" is dropped, as in ``class_``.
    """
    given = ((key.rstrip("_").replace("_", "-"), value) for key, value in attributes.items() if value is not None)
    pairs = "".join(f' {key}="{escape(_plain(value))}"' for key, value in given)
    head = f"<{name}{pairs}>"
    return Markup(head if name in _VOID else f"{head}{join(inside).html}</{name}>")


def join(pieces: Iterable[Piece], between: str = "") -> Markup:
    """Pieces in a row; text among them is escaped."""
    return Markup(between.join(one.html if isinstance(one, Markup) else escape(one) for one in pieces))


def link(url: str, *inside: Piece) -> Markup:
    """A link to a page on the web; for any other address, such as a script, only ``inside`` without a link."""
    if not url.startswith(("https://", "http://")):
        return join(inside)
    return tag("a", *inside, href=url, rel="nofollow noopener noreferrer")


def policy(rules: str, code: str) -> Markup:
    """The browser's permission to use this style sheet and this script, and to load nothing else."""
    allowed = f"default-src 'none'; style-src '{_source(rules)}'; script-src '{_source(code)}'; img-src data:"
    return tag("meta", http_equiv="Content-Security-Policy", content=f"{allowed}; base-uri 'none'; form-action 'none'")


def table(head: Iterable[Markup], rows: Iterable[Markup], caption: Markup | None = None, kind: str = "") -> Markup:
    """A table of complete header cells and rows; it scrolls if the page is too narrow."""
    top, body = tag("thead", tag("tr", *head)), tag("tbody", join(rows, "\n"))
    return tag("div", tag("table", caption or NOTHING, top, body, class_=kind or None), class_="wide")


def page(
    title: str, main: Iterable[Piece], rules: str, *, description: str = "", code: str = "", sealed: bool = False
) -> str:
    """A whole page in English that loads nothing from elsewhere.

    Args:
        main: what the page shows. rules: its style sheet. code: its script.
        description: what search engines show.
        sealed: whether the browser refuses all other styles and scripts; then no element may have a style of its own.
    """
    head = (
        tag("meta", charset="utf-8"),
        policy(rules, code) if sealed else NOTHING,
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("title", title),
        tag("meta", name="description", content=description) if description else NOTHING,
        tag("link", rel="icon", href="data:,"),
        Markup(f"<style>{rules}</style>"),
    )
    body = tag("body", tag("main", join(main, "\n")), Markup(f"<script>{code}</script>") if code else NOTHING)
    return f'<!doctype html>\n<html lang="en">\n{tag("head", *head).html}\n{body.html}\n</html>\n'


def _source(text: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _plain(value: str | int | float) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
