"""On which CPU an evaluation and its guest take turns.

One of the two always waits. If it waits on another CPU, that CPU falls asleep between two steps, and to wake it takes
longer than all else in a step. A guest with several threads is left alone, since they may well work at once.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
import threading
from collections.abc import Iterator

_BYTES = 2


class _Here(threading.local):
    """What is laid down for one thread of an evaluation: how many guests it stays for, and where it ran before."""

    guests = 0
    before: frozenset[int] = frozenset()


_here = _Here()


def pin_thread() -> int:
    """Keep this thread on the CPU that it runs on until `leave` was called as often; -1 where that cannot be had."""
    if sys.platform != "linux":
        return -1
    if not _here.guests:
        try:
            cpu = _current()
            _here.before = frozenset(os.sched_getaffinity(0))
            os.sched_setaffinity(0, {cpu})
        except (OSError, AttributeError):
            return -1
    _here.guests += 1
    return min(os.sched_getaffinity(0))


def unpin_thread() -> None:
    """One guest less to stay for."""
    if _here.guests:
        _here.guests -= 1
        if not _here.guests:
            _move(0, _here.before)


@contextlib.contextmanager
def unpinned() -> Iterator[None]:
    """Let what is started meanwhile run on every CPU, as this thread does when it stays nowhere."""
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
    """Say to whom watches a guest where its evaluation stays."""
    with contextlib.suppress(OSError):  # it is gone, which others will notice
        os.write(handle, cpu.to_bytes(_BYTES, "little"))


def receive_cpu(handle: int) -> int:
    """What `tell` said; -1 when nothing can come any more."""
    said = os.read(handle, _BYTES)
    return int.from_bytes(said, "little") if len(said) == _BYTES else -1


class PinnedProcess:
    """A guest's process that was moved to its evaluation's CPU, unless it has several threads."""

    def __init__(self, pid: int, cpu: int) -> None:
        self._pid = pid
        self._before = frozenset(os.sched_getaffinity(0))
        self._near = len(self._threads()) == 1 and _move(pid, {cpu})

    def release_if_threaded(self) -> None:
        """Let it run everywhere again if it has several threads by now."""
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


def _current() -> int:
    return int(ctypes.CDLL(None).sched_getcpu())
