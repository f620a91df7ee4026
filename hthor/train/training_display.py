"""What is printed of a training: a bar with the time that is left, or lines where no terminal can be redrawn."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from hthor.console import output, progress_bar
from hthor.train.watcher import Watcher

_LINE_EVERY_S = 30.0


class Words(Watcher):
    """Says what is being done: in a bar that is redrawn, or in lines."""

    def __init__(self, name: str, bar: Any | None) -> None:
        """``bar``: rich's display, None for lines."""
        self._name, self._bar = name, bar
        self._console = output.console(talk=True)
        self._task: Any = None
        self._stage, self._said = "", 0.0
        self._begin: tuple[int, float] = (0, 0.0)
        self._validation = ""

    def building(self, done: int, total: int) -> None:
        self._show("houses", done, total, f"{done}/{total} pose grids")

    def walking(self, done: int, total: int) -> None:
        self._show("walks", done, total, f"{done}/{total} walks through all episodes")

    def training(self, frames: int, total: int) -> None:
        self._show("actions", frames, total, f"{frames / 1e6:.2f}/{total / 1e6:.2f} M actions{self._validation}")

    def validated(self, row: dict[str, Any]) -> None:
        parts = [
            f"{zone}: success {100.0 * row[zone]['success']:.0f} %, SPL {row[zone]['spl']:.2f}"
            for zone in ("rooms", "houses")
            if zone in row
        ]
        if self._bar is None:
            self._say(f"{row['frames'] / 1e6:.2f} M actions, validation {'; '.join(parts)}")
        self._validation = f", {'; '.join(parts)}"

    def drawing(self, done: int, total: int) -> None:
        self._show("pictures", done, total, f"pictures of {done}/{total} houses")

    def seeing(self, pictures: int, total: int) -> None:
        self._show("learning", pictures, total, f"{pictures / 1e3:.0f}/{total / 1e3:.0f} k pictures{self._validation}")

    def recognised(self, row: dict[str, Any]) -> None:
        found = row["validation"]
        words = f"{100.0 * found['right']:.0f} % of the cells right, things {100.0 * found['small_found']:.0f} %"
        if self._bar is None:
            self._say(f"{row['frames'] / 1e3:.0f} k pictures, validation: {words}")
        self._validation = f", {words}"

    def _show(self, stage: str, done: int, total: int, words: str) -> None:
        now = time.monotonic()
        if stage != self._stage or done < self._begin[0]:
            self._stage, self._begin = stage, (done, now)
            if self._bar is not None and self._task is not None:
                self._bar.remove_task(self._task)
            self._task = None if self._bar is None else self._bar.add_task(self._name, total=total, words=words)
        made, spent = done - self._begin[0], now - self._begin[1]
        if made > 0 and done < total:
            words += f", {progress_bar.duration((total - done) * spent / made)} left"
        if self._bar is not None:
            self._bar.update(self._task, completed=done, total=total, words=words)
        elif now - self._said > _LINE_EVERY_S:
            self._say(words)

    def _say(self, text: str) -> None:
        self._said = time.monotonic()
        self._console.print(f"{self._name}: {text}", markup=False, highlight=False, soft_wrap=True)


@contextmanager
def watch(name: str, *, shown: bool) -> Iterator[Watcher]:
    """A watcher for a training of this name; one that prints nothing unless ``shown``."""
    if not shown:
        yield Watcher()
    elif not output.live():
        yield Words(name, None)
    else:
        with progress_bar.make_progress(output.console(talk=True)) as bar:
            yield Words(name, bar)
