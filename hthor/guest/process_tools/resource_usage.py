"""Processor time and memory of guests.

Most of a guest's time is spent by processes that end together with it, so that `os.times` never includes it. It is
therefore read just before the end.
"""

import contextlib
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_TICK_S = 1.0 / os.sysconf("SC_CLK_TCK")
_PAGE = os.sysconf("SC_PAGE_SIZE")


class _Total:
    """Processor time over the life of this process [s], like `os.times`."""

    uncollected = 0.0
    lock = threading.RLock()
    """Held while it changes: `os.times` counts the ended children of all threads together."""


def uncollected_cpu_s() -> float:
    """Processor time of this process's guests that `os.times` does not count as its children's [s].

    Guests that are in use are counted when they end, or when they become idle.
    """
    return _Total.uncollected


class CpuMeter:
    """Adds one guest's processor time to the total; ``pid`` is its first process."""

    def __init__(self, pid: int) -> None:
        self._pid, self._counted_s = pid, 0.0

    def count(self) -> None:
        """Add the time that the guest has used since the last call."""
        now = cpu_s(self._pid)
        with _Total.lock:
            _Total.uncollected += max(0.0, now - self._counted_s)
        self._counted_s = max(now, self._counted_s)

    @contextmanager
    def ending(self) -> Iterator[None]:
        """Context in which the guest is ended: counts the time that `os.times` will not count."""
        with _Total.lock:
            self.count()
            before = _collected_s()
            yield
            _Total.uncollected -= min(self._counted_s, _collected_s() - before)


def cpu_s(pid: int) -> float:
    """Processor time of a process and its descendants, including those that have ended [s]; 0 if unknown."""
    total = 0
    for one in _family(pid):
        with contextlib.suppress(OSError, IndexError, ValueError):
            words = Path(f"/proc/{one}/stat").read_text().rpartition(")")[2].split()
            total += sum(int(word) for word in words[11:15])
    return total * _TICK_S


def resident_mb(pid: int) -> float:
    """Resident memory of the largest process among ``pid`` and its descendants, shared memory included [MB]."""
    pages = 0
    for one in _family(pid):
        with contextlib.suppress(OSError, IndexError):  # it has ended
            pages = max(pages, int(Path(f"/proc/{one}/statm").read_text().split()[1]))
    return pages * _PAGE / (1 << 20)


def _family(pid: int) -> list[int]:
    found, line = [pid], [pid]
    while line:
        one = line.pop()
        with contextlib.suppress(OSError, ValueError):
            below = [int(word) for word in Path(f"/proc/{one}/task/{one}/children").read_text().split()]
            found += below
            line += below
    return found


def _collected_s() -> float:
    times = os.times()
    return times.children_user + times.children_system
