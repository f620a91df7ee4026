"""What a guest says can be shown: it moves no cursor, turns no writing, and is whole letters."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as some

from hthor.guest.protocol.wire import is_printable_name, sanitize_text


@given(some.text(some.characters(exclude_categories=())))
def test_nothing_is_shown_but_what_can_be_seen_and_line_ends(text: str) -> None:
    told = sanitize_text(text)
    told.encode()
    assert not set(told) & {"\x1b", "\x07", "\0", "\r", "\x9b", "\u202e", "\u2028", "\u2066"}
    assert sanitize_text(told) == told


def test_escapes_stand_for_what_cannot_be_seen() -> None:
    assert sanitize_text("a\tb\r\nc é 漢 [red]") == "a\tb\nc é 漢 [red]"
    assert sanitize_text("\x1b[2J \ud800 \u202e \r\x9b") == r"\x1b[2J \ud800 \u202e \x0d\x9b"
    assert is_printable_name("my agent é", 10)
    assert not is_printable_name("two\nlines", 10)
    assert not is_printable_name("long", 3)
