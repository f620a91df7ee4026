"""Keeps an evaluation and its guest on one CPU.

One of the two always waits. On a separate CPU it would fall asleep between two steps, and waking it takes longer than
everything else in a step. A guest with several threads is left alone, since they may run in parallel.
"""

import contextlib
import ctypes
import os
import sys
import threading
from collections.abc import Iterator

_BYTES = 2


class _Here(threading.local):
    """State of one thread of an evaluation: for how many guests it is pinned, and the CPUs it could use before."""

    guests = 0
    before: frozenset[int] = frozenset()


_here = _Here()


def pin_thread() -> int:
    """Keep this thread on its current CPU until `unpin_thread` is called as often; returns the CPU, -1 on failure."""
    if sys.platform != "linux":
        return -1
    if not _here.guests:
        try:
            cpu = int(ctypes.CDLL(None).sched_getcpu())
            _here.before = frozenset(os.sched_getaffinity(0))
            os.sched_setaffinity(0, {cpu})
        except (OSError, AttributeError):
            return -1
    _here.guests += 1
    return min(os.sched_getaffinity(0))


def unpin_thread() -> None:
    """Undo one call of `pin_thread`."""
    if _here.guests:
        _here.guests -= 1
        if not _here.guests:
            _move(0, _here.before)


@contextlib.contextmanager
def unpinned() -> Iterator[None]:
    """Let processes that are started in this context run on every CPU that this thread may use when not pinned."""
    if not _here.guests:
        yield
        return
    now = frozenset(os.sched_getaffinity(0))
    _move(0, _here.before)
    try:
        yield
    finally:
        _move(0, now)


def send_cpu(handle: int, cpu: int) -> None:
    """Tell a guest's supervisor which CPU the evaluation is pinned to."""
    with contextlib.suppress(OSError):  # it has ended, which is noticed elsewhere
        os.write(handle, cpu.to_bytes(_BYTES, "little"))


def receive_cpu(handle: int) -> int:
    """The CPU that `send_cpu` sent; -1 when the socket is closed."""
    said = os.read(handle, _BYTES)
    return int.from_bytes(said, "little") if len(said) == _BYTES else -1


class PinnedProcess:
    """A guest's process, moved to its evaluation's CPU unless it has several threads."""

    def __init__(self, pid: int, cpu: int) -> None:
        self._pid = pid
        self._before = frozenset(os.sched_getaffinity(0))
        self._near = len(self._threads()) == 1 and _move(pid, {cpu})

    def release_if_threaded(self) -> None:
        """Let it run on every CPU again if it now has several threads."""
        if self._near and len(threads := self._threads()) > 1:
            self._near = False
            for thread in threads:
                _move(thread, self._before)

    def _threads(self) -> list[int]:
        with contextlib.suppress(OSError):
            return [int(name) for name in os.listdir(f"/proc/{self._pid}/task")]
        return []


def _move(thread: int, cpus: frozenset[int] | set[int]) -> bool:
    try:
        os.sched_setaffinity(thread, cpus)
    except OSError:  # it has ended, or the CPU has been taken away
        return False
    return True
