"""HTML in which everything is escaped but what was made here: the one place where the board's page makes tags.

A `Markup` is HTML; a plain str is text, whoever wrote it, and becomes HTML by being escaped. So what stands in an entry
can reach the page as text alone, whatever it holds.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable
from html import escape

from msgspec import Struct

_VOID = ("meta", "link")  # of HTML: in a drawing every element is closed, or the next lies within it and is not seen


class Markup(Struct, frozen=True):
    """A piece of HTML. It is made by the functions below and by nothing else."""

    html: str


Piece = Markup | str
NOTHING = Markup("")


def tag(name: str, /, *inside: Piece, **attributes: str | int | float | None) -> Markup:
    """An element with what is inside, escaped where it is text.

    Args:
        attributes: None leaves one out. A "_" in a name stands for "-"; one at its end for nothing, as in ``class_``.
    """
    given = ((key.rstrip("_").replace("_", "-"), value) for key, value in attributes.items() if value is not None)
    pairs = "".join(f' {key}="{escape(_plain(value))}"' for key, value in given)
    head = f"<{name}{pairs}>"
    return Markup(head if name in _VOID else f"{head}{join(inside).html}</{name}>")


def join(pieces: Iterable[Piece], between: str = "") -> Markup:
    """Pieces one after the other, escaped where they are text."""
    return Markup(between.join(one.html if isinstance(one, Markup) else escape(one) for one in pieces))


def link(url: str, *inside: Piece) -> Markup:
    """A link to a page on the web; only the inside for any other address, such as one that is a script."""
    if not url.startswith(("https://", "http://")):
        return join(inside)
    return tag("a", *inside, href=url, rel="nofollow noopener noreferrer")


def style(rules: str) -> Markup:
    """A style sheet of our own."""
    return Markup(f"<style>{rules}</style>")


def script(code: str) -> Markup:
    """A script of our own."""
    return Markup(f"<script>{code}</script>")


def policy(rules: str, code: str) -> Markup:
    """What a browser may do with the page: this style sheet, this script, and nothing else, from nowhere."""
    allowed = f"default-src 'none'; style-src '{_source(rules)}'; script-src '{_source(code)}'; img-src data:"
    return tag("meta", http_equiv="Content-Security-Policy", content=f"{allowed}; base-uri 'none'; form-action 'none'")


def document(head: Iterable[Piece], body: Iterable[Piece]) -> str:
    """A whole page in English."""
    parts = (tag("head", *head), tag("body", *body))
    return f"<!doctype html>\n{tag('html', Markup(chr(10)), join(parts, chr(10)), Markup(chr(10)), lang='en').html}\n"


def _source(text: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _plain(value: str | int | float) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
