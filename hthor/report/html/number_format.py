"""Numbers and names as they stand in a sentence or a table."""

from collections.abc import Iterable


def percent(value: float | None, digits: int = 1) -> str:
    """A fraction in per cent, without the sign; a dash where there is none."""
    return "–" if value is None else f"{100.0 * value:.{digits}f}"


def plain(value: float | None, digits: int = 2) -> str:
    """A number without a sign of its own; a dash where there is none."""
    return "–" if value is None else f"{value:.{digits}f}".replace("-", "−")


def signed(value: float, digits: int = 1) -> str:
    """A number with its sign; a true minus, and no sign at zero."""
    text = f"{value:+.{digits}f}".replace("-", "−")
    return text[1:] if float(f"{value:.{digits}f}") == 0.0 else text


def listed(names: Iterable[str], nothing: str = "none", last: str = "and") -> str:
    """Names in a row: "a, b and c"."""
    held = list(names)
    return nothing if not held else held[0] if len(held) == 1 else f"{', '.join(held[:-1])} {last} {held[-1]}"
