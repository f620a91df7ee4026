"""Preparing a trial while others are going on in sessions of the same machine."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import TypeVar

T = TypeVar("T")

NICENESS = 10
"""Of the thread that prepares: where the processor is short, it gets a tenth of what a trial in real time gets. Our
choice."""


def prepare(make: Callable[[], T]) -> T:
    """What ``make`` returns, made in a thread that lets trials in real time go first; waits for it.

    A thread may become less urgent, but never more urgent again, so each call has a thread of its own.
    """
    with ThreadPoolExecutor(1, "preparation", initializer=_let_others_go_first) as thread:
        return thread.submit(make).result()


def _let_others_go_first() -> None:
    with suppress(OSError):  # where it is forbidden, or where threads have no priority of their own
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICENESS)
