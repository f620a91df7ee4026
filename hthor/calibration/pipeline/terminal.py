"""A calibration on the terminal: its progress on standard error, and the tables of its result."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from hthor.calibration.evidence import Band
from hthor.calibration.pipeline.run import CalibrationSummary
from hthor.eval.runner import progress

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from rich.table import Table

    from hthor.eval.runner.progress import Watcher

_SHOWN_FROM_S = 1.0
"""Time from which a stage that only computes is reported."""


class SilentProgress:
    """Reports nothing; see `hthor.calibration.pipeline.stages.ProgressReporter`."""

    @contextmanager
    def watch(self, stage: str) -> Iterator[Watcher]:  # noqa: ARG002
        """Report nothing about a stage that simulates."""
        yield progress.Silent()

    @contextmanager
    def work(self, stage: str) -> Iterator[None]:  # noqa: ARG002
        """Report nothing about a stage that computes."""
        yield


class PrintedProgress:
    """A bar (without a terminal: lines) for each stage that simulates, and a line for each that computes."""

    def __init__(self, console: Console, *, live: bool) -> None:
        self._console, self._live = console, live

    @contextmanager
    def watch(self, stage: str) -> Iterator[Watcher]:
        """Report trial by trial."""
        watcher = progress.Live(self._console, stage) if self._live else progress.Plain(self._console, stage)
        try:
            yield watcher
        finally:
            watcher.close()

    @contextmanager
    def work(self, stage: str) -> Iterator[None]:
        """Report how long the stage took."""
        began = time.monotonic()
        yield
        spent = time.monotonic() - began
        if spent > _SHOWN_FROM_S:
            self._console.print(f"{stage}: {spent:.0f} s", markup=False, highlight=False)


def result_tables(summary: CalibrationSummary) -> Iterator[RenderableType]:
    """The tables of a result, in order: figures, parameters, gates."""
    yield _table(
        f"{summary.target} on {summary.suite}: studies of the published design, median and 90 % interval [%]",
        ("figure", "published", "prior", "posterior", "simulated"),
        (
            (
                row.figure,
                f"{row.published:.1f}",
                *(_percent(band) for band in (row.prior, row.posterior, row.simulated)),
            )
            for row in summary.figures
        ),
    )
    yield _table(
        "what the published numbers say about each parameter (* marks fitted parameters)",
        ("parameter", "unit", "prior", "posterior", "contraction", "recovery", "known?"),
        (
            (
                row.name + ("*" if row.fitted else ""),
                row.unit,
                _short(row.prior),
                _short(row.posterior),
                f"{row.contraction:.2f}",
                f"{row.recovery:.2f}",
                row.word,
            )
            for row in summary.parameters
        ),
    )
    yield _table(
        "gates" + (" of a small calibration" if summary.sizes.quick else ""),
        ("gate", "asks", "found", "verdict"),
        ((gate.name, gate.asks, gate.found, "passed" if gate.passed else "FAILED") for gate in summary.gates),
        text_columns=4,
    )


def _percent(band: Band) -> str:
    return f"{band.median:.0f} [{band.low:.0f}, {band.high:.0f}]"


def _short(band: Band) -> str:
    return f"{band.median:.3g} [{band.low:.3g}, {band.high:.3g}]"


def _table(title: str, head: Sequence[str], rows: Iterable[Sequence[str]], *, text_columns: int = 1) -> Table:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for column, heading in enumerate(head):
        table.add_column(heading, justify="left" if column < text_columns or heading == "known?" else "right")
    for row in rows:
        table.add_row(*(Text(cell, style="bold red" if cell == "FAILED" else "") for cell in row))
    return table
