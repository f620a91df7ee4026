"""Cleans what agents write, so that it can be shown and logged."""

import math
import unicodedata
from collections.abc import Sequence
from typing import Any

from hthor.types import Vec3

_READ_FACTOR = 8
"""A text is read only up to this many times the limit, so that a very long one costs no more."""


def clean_text(text: str, limit: int) -> tuple[str, int]:
    """The text on one line, without control and formatting characters, at most ``limit`` characters long.

    Returns:
        the text, and how many characters were cut from its end.
    """
    seen = text[: limit * _READ_FACTOR]
    spaced = "".join(" " if char.isspace() else char for char in seen)
    plain = " ".join("".join(char for char in spaced if unicodedata.category(char)[0] != "C").split())
    plain = unicodedata.normalize("NFC", plain)
    kept = plain[:limit].rstrip()
    return kept, len(plain) - len(kept) + len(text) - len(seen)


def parse_point(value: Any) -> Vec3 | None:
    """The three finite numbers of a position as plain floats, or None when it is something else."""
    if isinstance(value, (str, bytes)) or not (isinstance(value, Sequence) or hasattr(value, "__array__")):
        return None
    try:
        x, y, z = (float(number) for number in value)
    except (TypeError, ValueError, OverflowError):
        return None
    return (x, y, z) if math.isfinite(x) and math.isfinite(y) and math.isfinite(z) else None
