"""Tells the user that a command is still at work, whenever it has shown nothing for a while; for every command.

On a terminal that is a line which is redrawn and goes; in a pipe or a log it is a plain line now and then. A command
that shows its progress itself is left alone.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from hthor import activity
from hthor.console import output

LIVE_AFTER_S, PLAIN_AFTER_S = 2.0, 30.0
_BEAT_S = 0.25
_BAR_RESTS_S = 10.0
"""A progress bar that is not redrawn for so long is taken to be over."""
_SIGNS = "⠋⠙⠹⠸⠼⠴⠦⠧⠇⠏"
_WIPE = "\r\x1b[K"


@contextmanager
def shown(arguments: Sequence[str], groups: Collection[str] = ()) -> Iterator[None]:
    """Within the block, tell the user that the command with these arguments is at work.

    Args:
        groups: first words after which the second one belongs to the command's name too.
    """
    if "--quiet" in arguments or "serve" in arguments[:2] or not arguments:
        yield
        return
    words = arguments[: 2 if arguments[0] in groups else 1]
    patience = _Patience(" ".join(words), live=output.live())
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = _Stream(before[0], patience), _Stream(before[1], patience)
    patience.start(before[1])
    try:
        with activity.heard_by(patience.hear):
            yield
    finally:
        patience.stop()
        sys.stdout, sys.stderr = before


class _Patience:
    """Watches what is written, and writes itself when that is nothing."""

    def __init__(self, name: str, *, live: bool) -> None:
        self._name, self._live = name, live
        self._after_s = LIVE_AFTER_S if live else PLAIN_AFTER_S
        self._lock = threading.RLock()
        self._over = threading.Event()
        self._step, self._drawn, self._beats = "", False, 0
        self._began = self._last = time.monotonic()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def start(self, stream: Any) -> None:
        self._stream = stream
        self._thread.start()

    def stop(self) -> None:
        self._over.set()
        with self._lock:
            self._wipe()

    def hear(self, step: str) -> None:
        """What the command does now."""
        self._step = step

    def write(self, stream: Any, text: str) -> Any:
        """Let the command write."""
        with self._lock:
            self._wipe()
            bar = "\r" in text or "\x1b[2K" in text
            self._last = time.monotonic() + (_BAR_RESTS_S if bar else 0.0)
            return stream.write(text)

    def _watch(self) -> None:
        while not self._over.wait(_BEAT_S):
            with self._lock:
                if not self._over.is_set() and time.monotonic() - self._last >= self._after_s:
                    self._tell()

    def _tell(self) -> None:
        spent = round(time.monotonic() - self._began)
        words = f"{self._name}: {self._step + ', ' if self._step else ''}{spent} s"
        self._beats += 1
        if self._live:
            text = f"{_WIPE}{_SIGNS[self._beats % len(_SIGNS)]} {words}"[:100]
        else:
            text, self._last = f"{words}\n", time.monotonic()
        self._drawn = self._live
        try:
            self._stream.write(text)
            self._stream.flush()
        except (OSError, ValueError):  # nobody reads it any more
            self._over.set()

    def _wipe(self) -> None:
        if self._drawn:
            self._drawn = False
            try:
                self._stream.write(_WIPE)
                self._stream.flush()
            except (OSError, ValueError):
                self._over.set()


class _Stream:
    """A stream of which somebody knows when it was last written to."""

    def __init__(self, stream: Any, patience: _Patience) -> None:
        self._stream, self._patience = stream, patience

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def __iter__(self) -> Any:
        return iter(self._stream)

    def write(self, text: str) -> Any:
        return self._patience.write(self._stream, text)

    def writelines(self, lines: Any) -> None:
        for line in lines:
            self.write(line)
