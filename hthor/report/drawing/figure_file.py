"""Writes figures to files: pixels (.png) or drawings (.svg, .pdf), by the ending of the file's name.

The same figure gives the same bytes: files have no date, and names inside an SVG come from a fixed salt. In drawings,
only pictures are pixels. The words of a PDF are text in an embedded font; those of an SVG are outlines, which look the
same on every machine.
"""

import io
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from hthor import jsonio
from hthor.errors import HthorError
from hthor.report.drawing import lettering

SUFFIXES = (".png", ".svg", ".pdf")
"""Endings of the files that a figure can be written to."""
_SETTINGS = {"svg.hashsalt": "hthor", "pdf.fonttype": 42, "pdf.compression": 6}  # 42: fonts that journals accept
_METADATA = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}


def check_name(path: Path) -> None:
    """Check that a file's name has the ending of a figure.

    Raises:
        HthorError: if it has another ending.
    """
    check_suffix(path, SUFFIXES, "picture")


def check_suffix(path: Path, valid: tuple[str, ...], what: str) -> None:
    """Check that a file's name ends in one of ``valid``.

    Raises:
        HthorError: if it does not; the message calls the file a ``what`` and lists the valid endings.
    """
    if path.suffix.lower() not in valid:
        ends = " or ".join(filter(None, (", ".join(valid[:-1]), valid[-1])))
        raise HthorError(f"{path}: the name of a {what} must end in {ends}.")


def write_figure(made: Figure, path: Path, *, dpi: float | None = None) -> None:
    """Write a figure in the format that the file's name asks for.

    Args:
        dpi: resolution of a PNG and of pictures inside a drawing; by default the figure's own.

    Raises:
        HthorError: if the file's name has the ending of no format.
    """
    check_name(path)
    jsonio.write(path, encode(made, path.suffix.lower().removeprefix("."), dpi=dpi))


def encode(made: Figure, form: str, *, dpi: float | None = None) -> bytes:
    """The bytes of a figure's file in the format "png", "svg" or "pdf"."""
    out = io.BytesIO()
    with mpl.rc_context(_SETTINGS):
        lettering.save_figure(made, out, format=form, dpi=dpi or made.dpi, metadata=_METADATA[form])
    return out.getvalue()
