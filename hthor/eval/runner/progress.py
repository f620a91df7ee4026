"""Reporting a run's progress on standard error: a live line on a terminal, plain lines in a pipe."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from hthor import code_identity
from hthor.console import progress_bar

if TYPE_CHECKING:
    from rich.console import Console

_LINE_EVERY_S = 30.0


class Watcher:
    """Follows the progress of a run; this one prints nothing."""

    def begin(self, total: int, kept: int) -> None:
        """The run has ``total`` trials, of which earlier commands ran ``kept``."""

    def played(self, met: bool, faulty: bool) -> None:
        """A trial is over: whether its goal was met, and whether an agent failed in it."""

    def beat(self) -> None:
        """Some time passed; called at least every `hthor.eval.records.trial_log.BEAT_S`."""

    def note(self, text: str) -> None:
        """Show a text that the user should read."""

    def close(self) -> None:
        """The run is over."""


Silent = Watcher


class Tally:
    """Counts of the trials that this command ran, and its pace."""

    def __init__(self, total: int, kept: int) -> None:
        self.total, self.kept = total, kept
        self.new = self.met = self.faulty = 0
        self._began = time.monotonic()
        self._first: float | None = None

    def count(self, met: bool, faulty: bool) -> None:
        self.new += 1
        self.met += met
        self.faulty += faulty
        if self._first is None:
            self._first = time.monotonic()

    @property
    def done(self) -> int:
        return self.kept + self.new

    @property
    def pace(self) -> float | None:
        """Trials per second since the first one, which had to wait for the workers to start."""
        if self._first is None or self.new < 3:
            return None
        spent = time.monotonic() - self._first
        return (self.new - 1) / spent if spent > 0.0 else None

    @property
    def words(self) -> str:
        """The state of the run in one line."""
        parts = [f"{self.done}/{self.total} trials"]
        if self.new:
            parts.append(f"success {100.0 * self.met / self.new:.0f} %")
        if self.faulty:
            parts.append(f"{self.faulty} with a fault")
        if self.pace:
            parts.append(f"{self.pace:.1f} trials/s")
            if self.done < self.total:
                parts.append(f"{progress_bar.duration((self.total - self.done) / self.pace)} left")
        return ", ".join(parts)


class Plain(Watcher):
    """Prints a line for about every tenth of the run, and at least every 30 s."""

    def __init__(self, console: Console, name: str) -> None:
        self._console, self._name = console, name
        self._tally = Tally(0, 0)
        self._last, self._tenth = time.monotonic(), 0

    def begin(self, total: int, kept: int) -> None:
        self._tally = Tally(total, kept)
        self._tenth = 10 * kept // max(1, total)
        played = f", {kept} of them played before" if kept else ""
        self._say(f"{total} trials{played}" + (f", {starting()}" if kept < total else ""))

    def played(self, met: bool, faulty: bool) -> None:
        self._tally.count(met, faulty)
        tenth = 10 * self._tally.done // self._tally.total
        if tenth > self._tenth:
            self._tenth = tenth
            self._say(self._tally.words)

    def beat(self) -> None:
        if time.monotonic() - self._last > _LINE_EVERY_S:
            self._say(self._tally.words)

    def note(self, text: str) -> None:
        self._say(f"note: {text}")

    def _say(self, text: str) -> None:
        self._last = time.monotonic()
        self._console.print(f"{self._name}: {text}", markup=False, highlight=False, soft_wrap=True)


class Live(Watcher):
    """A bar on the terminal that disappears when the run is over."""

    def __init__(self, console: Console, name: str) -> None:
        self._console, self._name = console, name
        self._tally = Tally(0, 0)
        self._bar: Any = None
        self._task: Any = None

    def begin(self, total: int, kept: int) -> None:
        self._tally = Tally(total, kept)
        self._bar = progress_bar.make_progress(self._console)
        words = f"{kept}/{total} trials, {starting()}" if kept < total else self._tally.words
        self._task = self._bar.add_task(self._name, total=total, completed=kept, words=words)
        self._bar.start()

    def played(self, met: bool, faulty: bool) -> None:
        self._tally.count(met, faulty)
        self._bar.update(self._task, completed=self._tally.done, words=self._tally.words)

    def note(self, text: str) -> None:
        self._console.print(f"{self._name}: note: {text}", markup=False, highlight=False)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.stop()


def make_watcher(console: Console, name: str, *, quiet: bool, live: bool) -> Watcher:
    """The watcher for a run of this name; ``live`` says that somebody watches the console."""
    if quiet:
        return Silent()
    return Live(console, name) if live else Plain(console, name)


def starting() -> str:
    """What the first trial waits for."""
    return "starting the workers" if code_identity.is_compiled() else "compiling for the first run, about 30 s"
