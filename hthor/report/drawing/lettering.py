"""How words stand in pictures: as they are. What agents and files say is never read as a formula.

Every figure is made and saved within `plain`, so that a message such as ``$\\frac{1}{$`` is drawn letter by letter, and
a letter that the font lacks is a box and no warning.
"""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import matplotlib as mpl
from matplotlib.figure import Figure

SETTINGS = {"text.parse_math": False, "text.usetex": False}
"""For those who set more than this."""


@contextmanager
def plain_lettering() -> Iterator[None]:
    """Draw words as they are; a decorator, too."""
    with mpl.rc_context(SETTINGS), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"(?s)(Glyph|Matplotlib currently does not support) .*")
        yield


def save_figure(made: Figure, where: Path | IO[bytes], **more: Any) -> None:
    """Write a figure to a file."""
    with plain_lettering():
        made.savefig(where, **more)
