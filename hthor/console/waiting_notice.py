"""Tells the user that a command is still working when it has printed nothing for a while.

On a terminal this is a line that is redrawn and removed; in a pipe or a log it is an occasional plain line. Commands
that show their own progress are left alone.
"""

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
"""A progress bar that has not been redrawn for this long counts as finished."""
_SIGNS = "⠋⠙⠹⠸⠼⠴⠦⠧⠇⠏"
_WIPE = "\r\x1b[K"


@contextmanager
def shown(arguments: Sequence[str], groups: Collection[str] = ()) -> Iterator[None]:
    """Within the block, tell the user now and then that the command is still working.

    Args:
        groups: names of command groups, whose commands have two words.
    """
    if "--quiet" in arguments or "serve" in arguments[:2] or not arguments:
        yield
        return
    words = arguments[: 2 if arguments[0] in groups else 1]
    notice = _Notice(" ".join(words), live=output.live())
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = _Stream(before[0], notice), _Stream(before[1], notice)
    notice.start(before[1])
    try:
        with activity.heard_by(notice.hear, notice.stop):
            yield
    finally:
        notice.stop()
        sys.stdout, sys.stderr = before


class _Notice:
    """Watches the command's output, and writes a notice when there is none."""

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
        """Note the command's current step."""
        self._step = step

    def write(self, stream: Any, text: str) -> Any:
        """Write for the command, and note the time."""
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
        except (OSError, ValueError):  # the reader of the output has gone
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
    """A stream that reports its writes."""

    def __init__(self, stream: Any, notice: _Notice) -> None:
        self._stream, self._notice = stream, notice

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def __iter__(self) -> Any:
        return iter(self._stream)

    def write(self, text: str) -> Any:
        return self._notice.write(self._stream, text)

    def writelines(self, lines: Any) -> None:
        for line in lines:
            self.write(line)
