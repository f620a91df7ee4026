"""How a calibration goes, told on standard error; decides nothing."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from hthor.eval.runner import progress

if TYPE_CHECKING:
    from rich.console import Console

    from hthor.eval.runner.progress import Watcher

_WORTH_TELLING_S = 1.0


class SilentProgress:
    """Says nothing."""

    @contextmanager
    def watch(self, stage: str) -> Iterator[Watcher]:  # noqa: ARG002
        """See `hthor.calibration.pipeline.stages.Teller`."""
        yield progress.Silent()

    @contextmanager
    def work(self, stage: str) -> Iterator[None]:  # noqa: ARG002
        """See `hthor.calibration.pipeline.stages.Teller`."""
        yield


class PrintedProgress:
    """A bar, or lines where nobody can see one, for each stage that simulates, and a line for each that computes."""

    def __init__(self, console: Console, *, live: bool) -> None:
        self._console, self._live = console, live

    @contextmanager
    def watch(self, stage: str) -> Iterator[Watcher]:
        """See `hthor.calibration.pipeline.stages.Teller`."""
        made = progress.Live(self._console, stage) if self._live else progress.Plain(self._console, stage)
        try:
            yield made
        finally:
            made.close()

    @contextmanager
    def work(self, stage: str) -> Iterator[None]:
        """See `hthor.calibration.pipeline.stages.Teller`."""
        began = time.monotonic()
        yield
        spent = time.monotonic() - began
        if spent > _WORTH_TELLING_S:
            self._console.print(f"{stage}: {spent:.0f} s", markup=False, highlight=False)
