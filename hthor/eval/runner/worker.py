"""What happens in a worker process: sessions in, lines of trials out."""

from __future__ import annotations

import ctypes
import errno
import os
import signal
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import closing
from typing import TYPE_CHECKING, cast

from hthor.errors import KILLED, AgentKilled, HthorError
from hthor.eval.runner.messages import Failed, Finished, News, SessionAbandoned, TrialDone

if TYPE_CHECKING:
    from collections.abc import Generator
    from multiprocessing.connection import Connection

    from hthor.eval.config.sessions import Session
    from hthor.eval.records.trial_record import TrialRecord

ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
"""One thread a worker: more would only fight over the cores, and sums of floats would depend on their number."""
_MENDABLE = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)


def run_worker(pipe: Connection, make: Callable[[], Callable[[Session], Iterator[TrialRecord]]], parent: int) -> None:
    """Play every session that comes through the pipe, until it says None or closes.

    Args:
        make: called once, here: gives what plays a session. Must be picklable.
        parent: id of the process that started this one; this one ends with it.
    """
    end_with_parent(parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the parent decides what it means
    signal.signal(signal.SIGTERM, lambda *_: None)  # likewise; not ignored, as those whom it starts would ignore it too
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    try:
        _serve(pipe, make)
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return  # the parent is gone, and so is the reason to go on


def _serve(pipe: Connection, make: Callable[[], Callable[[Session], Iterator[TrialRecord]]]) -> None:
    player = SessionPlayer(make)
    for session in iter(pipe.recv, None):
        for news in player.play(session):
            pipe.send(news)


class SessionPlayer:
    """What every worker does with sessions, whoever started it and wherever it sends what it tells."""

    def __init__(self, make: Callable[[], Callable[[Session], Iterator[TrialRecord]]]) -> None:
        self._make = make
        self._perform: Callable[[Session], Iterator[TrialRecord]] | None = None
        self._cpu_s = _cpu_s()

    def play(self, session: Session) -> Iterator[News]:
        """Tell of each trial when it is over; the last piece of news is that the session is over, lost, or failed."""
        from hthor.eval.records import trial_record
        from hthor.eval.runner import fault_report

        try:
            if self._perform is None:
                self._perform = self._make()
            with closing(cast("Generator[TrialRecord, None, None]", self._perform(session))) as trials:
                for done in trials:
                    left, faulty = fault_report.take(done.key), bool(done.faults)  # it may be of a start before this
                    yield TrialDone(
                        key=done.key,
                        participant=session.participant,
                        line=trial_record.encode(done),
                        met=done.met,
                        faulty=faulty,
                        left=left if faulty else None,
                        killed=any(fault.kind == KILLED for fault in done.faults),
                    )
        except Exception as error:
            yield _failure(session.participant, error)
            return
        before, self._cpu_s = self._cpu_s, _cpu_s()
        yield Finished(cpu_s=self._cpu_s - before)


def _failure(participant: int, error: Exception) -> Failed | SessionAbandoned:
    """What the user can mend ends the run; a bug, or a machine that kills agents, costs the session alone."""
    if isinstance(error, AgentKilled):
        return SessionAbandoned(participant=participant, cause=str(error), killed=True)
    if isinstance(error, HthorError):
        return Failed(exit_code=error.exit_code, message=str(error))
    if isinstance(error, OSError) and error.errno in _MENDABLE:
        return Failed(exit_code=HthorError.exit_code, message=f"{error.filename or 'a file'}: {error.strerror}.")
    summary = "".join(traceback.format_exception_only(error)).strip()
    return SessionAbandoned(participant=participant, cause=summary, detail="".join(traceback.format_exception(error)))


def end_with_parent(parent: int) -> None:
    """Ask the kernel to kill this process when its parent ends, so that no run leaves orphans."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(1, int(signal.SIGKILL), 0, 0, 0)  # 1 is PR_SET_PDEATHSIG
    if os.getppid() != parent:
        os._exit(1)  # it ended before the kernel was asked


def _cpu_s() -> float:
    """Processor time of this process, and of all that it started and that has ended or waits for its next session."""
    times, guests = os.times(), sys.modules.get("hthor.guest.process_tools.resource_usage")
    lost = guests.uncollected_cpu_s() if guests else 0.0
    return float(times.user + times.system + times.children_user + times.children_system + lost)
