"""Worker processes on this machine: gives them sessions, and replaces workers that die."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Generator, Iterator, Sequence
from contextlib import closing, contextmanager
from multiprocessing.connection import Connection, wait
from typing import TYPE_CHECKING

from hthor import code_identity
from hthor.errors import HthorError
from hthor.eval.records.trial_log import BEAT_S
from hthor.eval.runner.engines import LIMIT_S, PausableClock, Queue, SessionFailed
from hthor.eval.runner.messages import Failed, Finished, News, RunnerFactory, SessionAbandoned, TrialDone
from hthor.eval.runner.worker import ONE_THREAD, run_worker

if TYPE_CHECKING:
    from hthor.trials.sessions import Session

_FAREWELL_S = 10.0
"""How long [s] an idle worker may take to end by itself. Our choice."""


class Engine:
    """The supervisor of the workers, which are new processes that die with it; by default one per CPU."""

    def __init__(
        self, *, jobs: int | None = None, address: str = "", gpus: float = 0.0, limit_s: float = LIMIT_S
    ) -> None:
        del gpus  # the jobs share the machine's GPU
        if address:
            raise HthorError(
                f"--address {address}: the engine 'local' takes no address. Leave it out, or add --engine ray."
            )
        self._jobs = jobs or len(os.sched_getaffinity(0))
        self._limit_s, self._clock, self._draining = limit_s, PausableClock(), False

    def run_sessions(self, sessions: Sequence[Session], make: RunnerFactory) -> Generator[News | None, None, None]:
        """See `hthor.eval.runner.engines.Engine`."""
        queue = Queue(sessions)
        workers: list[_Worker] = []
        try:
            while queue or any(one.task for one in workers):
                workers = [one for one in workers if not one.dead]
                while len(workers) < min(self._jobs, len(queue) + sum(1 for one in workers if one.task)):
                    workers.append(_Worker(make))
                for worker in workers:
                    if queue and not worker.task:
                        worker.give(*queue.take(), self._clock.now())
                yield from self._listen(workers, queue)
                if self._draining:
                    queue.clear()
        finally:
            for worker in workers:
                worker.end()

    def drain(self) -> None:
        """See `hthor.eval.runner.engines.Engine`."""
        self._draining = True

    def _listen(self, workers: list[_Worker], queue: Queue) -> Iterator[News | None]:
        ready, now = wait([worker.pipe for worker in workers], timeout=BEAT_S), self._clock.now()
        if not ready:
            yield None
        for worker in workers:
            if worker.pipe not in ready:
                if worker.task and now - worker.since > self._limit_s:
                    worker.give_up(self._limit_s)
                continue
            news, worker.since = worker.receive(), now
            if isinstance(news, Failed):
                raise SessionFailed(news)
            if news is not None:
                yield news
            elif worker.task:
                yield queue.again(*worker.task, worker.cause)
                worker.task = None
            if self._draining and isinstance(news, TrialDone):
                worker.end()


class _Worker:
    """A worker process, the pipe to it, and the session that it runs."""

    def __init__(self, make: RunnerFactory) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe: Connection
        self.pipe, far = context.Pipe(duplex=True)
        self.process = context.Process(target=run_worker, args=(far, make, os.getpid()), daemon=True)
        with _quiet_environment():
            self.process.start()
        far.close()  # so that the pipe closes when the worker ends
        self.task: tuple[Session, int] | None = None
        self.since = 0.0
        self.dead = False
        self._stuck = ""

    def give(self, session: Session, attempt: int, now: float) -> None:
        """Give the worker a session; `receive` notices a worker that is already dead."""
        self.task, self.since = (session, attempt), now
        try:
            self.pipe.send(session)
        except OSError:
            return

    def receive(self) -> News | None:
        """The next message, None when the worker died."""
        try:
            news: News = self.pipe.recv()
        except (EOFError, OSError):
            self.dead = True
            self.pipe.close()
            self.process.join()
            return None
        if isinstance(news, (Finished, SessionAbandoned)):
            self.task = None
        return news

    def give_up(self, after_s: float) -> None:
        """Kill a worker that is stuck; `receive` notices."""
        self._stuck = f"the limit of {after_s:.0f} s for a trial"
        self.process.kill()

    @property
    def cause(self) -> str:
        """The reason why a dead worker ended."""
        code = self.process.exitcode
        if self._stuck:
            return self._stuck
        return f"signal {signal.Signals(-code).name}" if code is not None and code < 0 else f"exit status {code}"

    def end(self) -> None:
        """End the worker; one that is idle may end by itself."""
        if self.dead:
            return
        if self.task is not None:
            self.process.kill()
        self.task, self.dead = None, True
        self.pipe.close()
        self.process.join(_FAREWELL_S)
        self.process.kill()
        self.process.join()


@contextmanager
def _quiet_environment() -> Iterator[None]:
    """Set what new workers get: one thread per library, compiled code of this version only, and no Ctrl-C for now."""
    before = dict(os.environ)
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    os.environ.update(ONE_THREAD, PYTHONHASHSEED="0")
    code_identity.keep_compiled()
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


class SessionLost(HthorError):
    """A session could not be run. ``detail`` is the traceback of a bug, otherwise empty."""

    def __init__(self, lost: SessionAbandoned) -> None:
        self.exit_code, self.detail = 1 if lost.detail else HthorError.exit_code, lost.detail
        super().__init__(lost.cause if lost.detail else f"session {lost.session}: {lost.cause}")


def run_all_sessions(
    sessions: Sequence[Session], make: RunnerFactory, *, jobs: int
) -> Generator[News | None, None, None]:
    """Run sessions in ``jobs`` processes, as `Engine.run_sessions`; raises SessionLost when one is lost."""
    with closing(Engine(jobs=jobs).run_sessions(sessions, make)) as messages:
        for message in messages:
            if isinstance(message, SessionAbandoned):
                raise SessionLost(message)
            yield message
