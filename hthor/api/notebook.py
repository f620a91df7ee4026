"""A progress bar in a notebook's output, which needs no widgets: the output is replaced as the run goes on."""

from __future__ import annotations

import sys
import time
from html import escape
from typing import Any

from hthor.eval.runner.progress import Tally, Watcher, starting

_EVERY_S = 0.25
"""How often the bar is drawn: a notebook keeps every update until it is shown."""
_WIDTH = 40


def is_here() -> bool:
    """Whether the code runs in a notebook's kernel."""
    library = sys.modules.get("IPython")
    return library is not None and hasattr(library.get_ipython(), "kernel")


def _display(shown: object, **options: Any) -> Any:
    """Show something in the cell's output, by the library that the kernel has loaded."""
    library: Any = sys.modules["IPython"]
    return library.display.display(shown, **options)


class NotebookBar(Watcher):
    """A bar in the output of the cell that is running; in the end it says how the run went."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._tally = Tally(0, 0)
        self._handle: Any = None
        self._drawn = 0.0
        self._words = ""

    def begin(self, total: int, kept: int) -> None:
        self._tally = Tally(total, kept)
        self._words = f"{kept}/{total} trials, {starting()}" if kept < total else self._tally.words
        self._handle = _display(self, display_id=True)

    def played(self, met: bool, faulty: bool) -> None:
        self._tally.count(met, faulty)
        self._words = self._tally.words
        if time.monotonic() - self._drawn > _EVERY_S:
            self._draw()

    def note(self, text: str) -> None:
        _display({"text/plain": f"{self._name}: note: {text}"}, raw=True)

    def close(self) -> None:
        if self._handle is not None:
            self._draw()

    def _draw(self) -> None:
        self._drawn = time.monotonic()
        self._handle.update(self)

    def __repr__(self) -> str:
        """The bar where a notebook shows only text."""
        full = _WIDTH * self._tally.done // max(1, self._tally.total)
        return f"{self._name} [{'=' * full}{' ' * (_WIDTH - full)}] {self._words}"

    def _repr_html_(self) -> str:
        """The bar as a notebook shows it."""
        bar = f'<progress value="{self._tally.done}" max="{max(1, self._tally.total)}"></progress>'
        return f"<div><b>{escape(self._name)}</b> {bar} {escape(self._words)}</div>"
