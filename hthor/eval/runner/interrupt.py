"""Ending a command early: the first signal lets running trials finish, the second one ends at once."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from hthor.errors import HthorError


class Interrupted(HthorError):
    """The user stopped the run; finished trials are kept."""

    exit_code = 130


@contextmanager
def stoppable() -> Iterator[threading.Event]:
    """Turn the first Ctrl-C or SIGTERM into a flag; a second one ends at once, and raises Interrupted."""
    flag = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield flag
        return

    def stop(_number: int, _frame: FrameType | None) -> None:
        if flag.is_set():
            raise KeyboardInterrupt
        flag.set()

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield flag
    except KeyboardInterrupt:
        raise Interrupted("interrupted at once; resume with the same command.") from None
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
