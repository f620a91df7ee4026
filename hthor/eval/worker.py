"""What happens in a worker process: sessions in, lines of trials out; knows nothing of the run they belong to."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import closing
from typing import TYPE_CHECKING, cast

from msgspec import Struct

from hthor.errors import AgentError, HthorError

if TYPE_CHECKING:
    from collections.abc import Generator
    from multiprocessing.connection import Connection

    from hthor.eval.record import Record
    from hthor.eval.remains import Remains
    from hthor.eval.session import Session

ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
"""One thread a worker: more would only fight over the cores, and sums of floats would depend on their number."""
REPEATS = 2
"""How often a session begins again because an agent's process was killed."""
_KILLED = "SIGKILL"


class Played(Struct, frozen=True, kw_only=True):
    """A trial is over. ``line`` is its whole record, ``left`` what is left of agents that failed in it."""

    key: str
    line: bytes
    met: bool
    faulty: bool
    left: Remains | None = None


class Finished(Struct, frozen=True, kw_only=True):
    """A session is over; ``cpu_s`` [s] is what it cost, with its agents' processes."""

    cpu_s: float


class Failed(Struct, frozen=True, kw_only=True):
    """A session cannot be played: ``exit_code`` and ``message`` for the user, ``detail`` a traceback of a bug."""

    exit_code: int
    message: str
    detail: str


News = Played | Finished | Failed


def work(pipe: Connection, make: Callable[[], Callable[[Session], Iterator[Record]]], parent: int) -> None:
    """Play every session that comes through the pipe, until it says None or closes.

    Args:
        make: called once, here: gives what plays a session. Must be picklable.
        parent: id of the process that started this one; this one ends with it.
    """
    end_with(parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the parent decides what it means
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    try:
        _serve(pipe, make)
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return  # the parent is gone, and so is the reason to go on


def _serve(pipe: Connection, make: Callable[[], Callable[[Session], Iterator[Record]]]) -> None:
    player = Player(make)
    for session in iter(pipe.recv, None):
        for news in player.play(session):
            pipe.send(news)


class Player:
    """What every worker does with sessions, whoever started it and wherever it sends what it tells."""

    def __init__(self, make: Callable[[], Callable[[Session], Iterator[Record]]]) -> None:
        self._make = make
        self._perform: Callable[[Session], Iterator[Record]] | None = None
        self._cpu_s = _cpu_s()

    def play(self, session: Session) -> Iterator[News]:
        """Tell of each trial when it is over; the last piece of news is that the session is over, or failed."""
        from hthor.eval import record, remains

        try:
            if self._perform is None:
                self._perform = self._make()
            for done in _steadily(self._perform, session):
                line = record.encode(done)
                left = remains.take(done.key)
                yield Played(key=done.key, line=line, met=done.met, faulty=bool(done.faults), left=left)
        except Exception as error:
            yield _failure(error)
            return
        before, self._cpu_s = self._cpu_s, _cpu_s()
        yield Finished(cpu_s=self._cpu_s - before)


def _steadily(perform: Callable[[Session], Iterator[Record]], session: Session) -> Iterator[Record]:
    """A session's trials. One in which an agent's process was killed is not told of: the session begins again.

    SIGKILL mostly comes from outside, from a kernel that ran out of memory or a machine that goes down, and then the
    trial is not the agent's failure. An agent that ends itself that way does so again, and the fault stands.
    """
    for left in reversed(range(REPEATS + 1)):
        try:
            with closing(cast("Generator[Record, None, None]", perform(session))) as trials:
                for done in trials:
                    if left and any(fault.kind == "died" and _KILLED in fault.detail for fault in done.faults):
                        break
                    yield done
                else:
                    return
        except AgentError as error:  # it was killed before it could say what it is
            if not left or _KILLED not in str(error):
                raise


def _failure(error: Exception) -> Failed:
    if isinstance(error, HthorError):
        return Failed(exit_code=error.exit_code, message=str(error), detail="")
    summary = "".join(traceback.format_exception_only(error)).strip()
    return Failed(exit_code=1, message=summary, detail="".join(traceback.format_exception(error)))


def end_with(parent: int) -> None:
    """Ask the kernel to kill this process when its parent ends, so that no run leaves orphans."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(1, int(signal.SIGKILL), 0, 0, 0)  # 1 is PR_SET_PDEATHSIG
    if os.getppid() != parent:
        os._exit(1)  # it ended before the kernel was asked


def _cpu_s() -> float:
    """Processor time of this process, and of all that it started and that has ended."""
    times, guests = os.times(), sys.modules.get("hthor.guest.cost")
    lost = guests.uncollected_cpu_s() if guests else 0.0
    return float(times.user + times.system + times.children_user + times.children_system + lost)
