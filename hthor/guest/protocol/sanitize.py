"""Makes a guest's text safe to show and to write to files.

Control characters, characters that change the writing direction, and surrogates are replaced by escapes.
"""

_KEPT = (ord("\n"), ord("\t"))
_TURNING = (0x61C, *range(0x200E, 0x2010), *range(0x2028, 0x202F), *range(0x2066, 0x206A))
_UNSEEN = (*range(0x20), *range(0x7F, 0xA0), *_TURNING)
_HALVES = range(0xD800, 0xE000)
_ESCAPED = {
    code: f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" for code in (*_UNSEEN, *_HALVES) if code not in _KEPT
}


def sanitize_text(text: str) -> str:
    """The text with escapes for unsafe characters; line ends and tabs stay."""
    return text.replace("\r\n", "\n").translate(_ESCAPED)


def is_printable_name(text: str, most: int) -> bool:
    """Whether this fits in a table or a file's name."""
    return text.isprintable() and len(text) <= most
