"""Writes numbers and names as they stand in a sentence or a table."""

from collections.abc import Iterable


def percent(value: float | None, digits: int = 1) -> str:
    """A fraction as a percentage without the % sign; a dash for None."""
    return "–" if value is None else f"{100.0 * value:.{digits}f}"


def plain(value: float | None, digits: int = 2) -> str:
    """A number without a plus sign; a dash for None."""
    return "–" if value is None else f"{value:.{digits}f}".replace("-", "−")


def signed(value: float, digits: int = 1) -> str:
    """A number with plus or minus (the true minus sign), and no sign at zero."""
    text = f"{value:+.{digits}f}".replace("-", "−")
    return text[1:] if float(f"{value:.{digits}f}") == 0.0 else text


def listed(names: Iterable[str], nothing: str = "none", last: str = "and") -> str:
    """Names as a list in words: "a, b and c"."""
    held = list(names)
    return nothing if not held else held[0] if len(held) == 1 else f"{', '.join(held[:-1])} {last} {held[-1]}"
