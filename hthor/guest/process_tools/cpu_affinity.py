"""Keeps an evaluation and its guest on one CPU while they take turns.

One of the two always waits. On a separate CPU it would fall asleep between two steps, and waking it takes longer than
everything else in a step. Only the main thread shares its CPU: an evaluation that asks its guests in other threads goes
on meanwhile. A guest with several threads is left alone too, since they may run in parallel.
"""

import contextlib
import ctypes
import os
import sys
import threading
from collections.abc import Iterator


class _Main:
    """State of the main thread: for how many guests it is pinned, and the CPUs it could use before."""

    guests = 0
    before: frozenset[int] = frozenset()


_lock = threading.Lock()


def is_main_thread() -> bool:
    """Whether the caller is the main thread."""
    return threading.current_thread() is threading.main_thread()


def pin_thread() -> int:
    """Keep the main thread on its current CPU until `unpin_thread` is called as often.

    Returns:
        the CPU; -1 if that is impossible, and in any other thread.
    """
    if sys.platform != "linux" or not is_main_thread():
        return -1
    with _lock:
        if not _Main.guests:
            try:
                cpu = int(ctypes.CDLL(None).sched_getcpu())
                _Main.before = frozenset(os.sched_getaffinity(0))
                os.sched_setaffinity(0, {cpu})
            except (OSError, AttributeError):
                return -1
        _Main.guests += 1
        return min(os.sched_getaffinity(0))


def unpin_thread() -> None:
    """Undo one call of `pin_thread`, from any thread."""
    with _lock:
        if _Main.guests:
            _Main.guests -= 1
            if not _Main.guests:
                _move(os.getpid(), _Main.before)


def free_thread() -> None:
    """Let this thread run on every CPU, even if the main thread was pinned when it started this thread."""
    if _Main.before:
        _move(0, _Main.before)


@contextlib.contextmanager
def unpinned() -> Iterator[None]:
    """Let processes that are started in this context run on every CPU that the main thread may use when not pinned."""
    if not _Main.guests:
        yield
        return
    now = frozenset(os.sched_getaffinity(0))
    _move(0, _Main.before)
    try:
        yield
    finally:
        _move(0, now)


class PinnedProcess:
    """A guest's process, moved to its evaluation's CPU unless it has several threads."""

    def __init__(self, pid: int, cpu: int) -> None:
        self._pid = pid
        self._before = frozenset(os.sched_getaffinity(0))
        self._near = len(self._threads()) == 1 and _move(pid, {cpu})

    def release_if_threaded(self) -> None:
        """Let it run on every CPU again if it now has several threads."""
        if self._near and len(self._threads()) > 1:
            self.release()

    def release(self) -> None:
        """Let it run on every CPU again."""
        self._near = False
        for thread in self._threads():
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
