"""Writes words in pictures literally: text of agents and files is never read as a formula.

Every figure is made and saved within `plain_lettering`, so that a message such as ``$\\frac{1}{$`` is drawn letter by
letter, and a letter that the font lacks becomes a box without a warning.
"""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import matplotlib as mpl
from matplotlib.figure import Figure

SETTINGS = {"text.parse_math": False, "text.usetex": False}
"""Matplotlib's settings for this, for code that has to set others as well."""


@contextmanager
def plain_lettering() -> Iterator[None]:
    """Draw words literally, as a context or as a decorator."""
    with mpl.rc_context(SETTINGS), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"(?s)(Glyph|Matplotlib currently does not support) .*")
        yield


def save_figure(made: Figure, where: Path | IO[bytes], **more: Any) -> None:
    """Write a figure to a file."""
    with plain_lettering():
        made.savefig(where, **more)
