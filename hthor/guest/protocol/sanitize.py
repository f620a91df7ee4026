"""A guest's words, made fit to be shown to people and written to files.

What moves a terminal's cursor, turns the direction of writing or is half a character stands as its escape instead.
"""

from __future__ import annotations

_KEPT = (ord("\n"), ord("\t"))
_TURNING = (0x61C, *range(0x200E, 0x2010), *range(0x2028, 0x202F), *range(0x2066, 0x206A))
_UNSEEN = (*range(0x20), *range(0x7F, 0xA0), *_TURNING)
_HALVES = range(0xD800, 0xE000)
_ESCAPED = {
    code: f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" for code in (*_UNSEEN, *_HALVES) if code not in _KEPT
}


def sanitize_text(text: str) -> str:
    """The same text, with escapes for what is not to be seen; line ends stay."""
    return text.replace("\r\n", "\n").translate(_ESCAPED)


def is_printable_name(text: str, most: int) -> bool:
    """Whether this can stand in a table or a file's name."""
    return text.isprintable() and len(text) <= most
