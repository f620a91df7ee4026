"""A worker process: takes sessions, and sends back their results, trial by trial."""

from __future__ import annotations

import ctypes
import errno
import os
import signal
import sys
import traceback
from collections.abc import Iterator
from contextlib import closing
from typing import TYPE_CHECKING, cast

from hthor.errors import KILLED, AgentKilled, HthorError
from hthor.eval.runner.messages import Failed, Finished, News, SessionAbandoned, TrialDone

if TYPE_CHECKING:
    from collections.abc import Generator
    from multiprocessing.connection import Connection

    from hthor.eval.runner.messages import RunnerFactory, SessionRunner, TrialOutcome
    from hthor.trials.sessions import Session

ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
"""One thread for each worker: more would compete for the cores, and sums of floats would depend on their number."""
_MENDABLE = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)


def run_worker(pipe: Connection, make: RunnerFactory, parent: int) -> None:
    """Run every session that comes through the pipe, until None comes or the pipe closes.

    Args:
        make: called once, in the worker; makes a session runner.
        parent: id of the process that started this one; this one ends with it.
    """
    end_with_parent(parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the parent handles it
    signal.signal(signal.SIGTERM, lambda *_: None)  # likewise; SIG_IGN would also hold for the processes that it starts
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    player = SessionPlayer(make)
    try:
        for session in iter(pipe.recv, None):
            for news in player.run(session):
                pipe.send(news)
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return  # the parent is gone


class SessionPlayer:
    """Runs sessions in a worker of any engine."""

    def __init__(self, make: RunnerFactory) -> None:
        self._make = make
        self._run_session: SessionRunner | None = None
        self._cpu_s = _cpu_s()

    def run(self, session: Session) -> Iterator[News]:
        """Report each trial when it is over; the last message is that the session is over, abandoned or failed."""
        from hthor.eval.records import trial_record

        try:
            if self._run_session is None:
                self._run_session = self._make()
            with closing(cast("Generator[TrialOutcome, None, None]", self._run_session(session))) as outcomes:
                for outcome in outcomes:
                    record = outcome.record
                    yield TrialDone(
                        key=record.key,
                        session=session.number,
                        line=trial_record.encode(record),
                        met=record.met,
                        faulty=bool(record.faults),
                        fault_report=outcome.fault_report,
                        killed=any(fault.kind == KILLED for fault in record.faults),
                    )
        except Exception as error:
            yield _failure(session.number, error)
            return
        before, self._cpu_s = self._cpu_s, _cpu_s()
        yield Finished(cpu_s=self._cpu_s - before)


def _failure(session: int, error: Exception) -> Failed | SessionAbandoned:
    """An error that the user can fix ends the run; a bug, or a killed agent, only costs the session."""
    if isinstance(error, AgentKilled):
        return SessionAbandoned(session=session, cause=str(error), killed=True)
    if isinstance(error, HthorError):
        return Failed(exit_code=error.exit_code, message=str(error))
    if isinstance(error, OSError) and error.errno in _MENDABLE:
        return Failed(exit_code=HthorError.exit_code, message=f"{error.filename or 'a file'}: {error.strerror}.")
    summary = "".join(traceback.format_exception_only(error)).strip()
    return SessionAbandoned(session=session, cause=summary, detail="".join(traceback.format_exception(error)))


def end_with_parent(parent: int) -> None:
    """Have the kernel kill this process when its parent ends, so that no run leaves orphans."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(1, int(signal.SIGKILL), 0, 0, 0)  # 1 is PR_SET_PDEATHSIG
    if os.getppid() != parent:
        os._exit(1)  # the parent ended before this call


def _cpu_s() -> float:
    """CPU time [s] of this process and of its child processes that have ended or wait for their next session."""
    times, guests = os.times(), sys.modules.get("hthor.guest.process_tools.resource_usage")
    lost = guests.uncollected_cpu_s() if guests else 0.0
    return float(times.user + times.system + times.children_user + times.children_system + lost)
