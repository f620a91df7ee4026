"""A calibration's result on the terminal: figures, parameters and gates; computes nothing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from hthor.calibration.pipeline.summary import Span, Summary

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table


def parts(found: Summary) -> Iterator[RenderableType]:
    """The tables, in order."""
    yield _table(
        f"{found.target} on {found.suite}: studies of the published design, median and 90 % interval [%]",
        ("figure", "published", "prior", "posterior", "simulated"),
        (
            (row.figure, f"{row.published:.1f}", *_spans(row.prior, row.posterior, row.simulated))
            for row in found.figures
        ),
    )
    yield _table(
        "what the published numbers say of each parameter (fitted ones are marked *)",
        ("parameter", "unit", "prior", "posterior", "contraction", "recovery", "known?"),
        (
            (
                row.name + ("*" if row.fitted else ""),
                row.unit,
                *(_short(span) for span in (row.prior, row.posterior)),
                f"{row.contraction:.2f}",
                f"{row.recovery:.2f}",
                row.word,
            )
            for row in found.parameters
        ),
    )
    yield _table(
        "gates" + (" of a small calibration" if found.sizes.quick else ""),
        ("gate", "asks", "found", "verdict"),
        ((gate.name, gate.asks, gate.found, "passed" if gate.passed else "FAILED") for gate in found.gates),
        words=4,
    )


def _spans(*spans: Span) -> Iterator[str]:
    for span in spans:
        yield f"{span.median:.0f} [{span.low:.0f}, {span.high:.0f}]"


def _short(span: Span) -> str:
    return f"{span.median:.3g} [{span.low:.3g}, {span.high:.3g}]"


def _table(title: str, head: Sequence[str], rows: Iterable[Sequence[str]], *, words: int = 1) -> Table:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for column, heading in enumerate(head):
        table.add_column(heading, justify="left" if column < words or heading == "known?" else "right")
    for row in rows:
        table.add_row(*(Text(cell, style="bold red" if cell == "FAILED" else "") for cell in row))
    return table
