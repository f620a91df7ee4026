"""Worker processes on this machine: hands out sessions, replaces workers that die."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from multiprocessing.connection import Connection, wait
from typing import TYPE_CHECKING

from hthor import code_identity
from hthor.errors import HthorError
from hthor.eval.runner import worker
from hthor.eval.runner.engines import RunnerFactory, SessionFailed
from hthor.eval.runner.messages import Failed, Finished, News, SessionAbandoned, TrialDone
from hthor.eval.runner.queue import BEAT_S, LIMIT_S, PausableClock, Queue

if TYPE_CHECKING:
    from hthor.eval.config.sessions import Session

_FAREWELL_S = 10.0


class Engine:
    """The supervisor. Workers are fresh processes that die with it.

    Args:
        jobs: how many workers; None is one a CPU.
        address: must be empty.
        limit_s: how long [s] a worker may play a trial before it counts as stuck.
    """

    def __init__(
        self, *, jobs: int | None = None, address: str = "", gpus: float = 0.0, limit_s: float = LIMIT_S
    ) -> None:
        del gpus  # whoever shares a machine's GPU shares it among the jobs
        if address:
            raise HthorError(f"--address {address}: the engine 'local' has none. Leave it out, or add --engine ray.")
        self._jobs = jobs or len(os.sched_getaffinity(0))
        self._limit_s, self._clock, self._draining = limit_s, PausableClock(), False

    def perform(self, sessions: Sequence[Session], make: RunnerFactory) -> Generator[News | None, None, None]:
        """See `hthor.eval.runner.engines.Engine`."""
        queue = Queue(sessions)
        hands: list[_Hand] = []
        try:
            while queue or any(hand.task for hand in hands):
                hands = [hand for hand in hands if not hand.dead]
                while len(hands) < min(self._jobs, len(queue) + sum(1 for hand in hands if hand.task)):
                    hands.append(_Hand(make))
                for hand in hands:
                    if queue and not hand.task:
                        hand.give(*queue.take(), self._clock.now())
                yield from self._listen(hands, queue)
                if self._draining:
                    queue.clear()
        finally:
            for hand in hands:
                hand.end()

    def drain(self) -> None:
        """See `hthor.eval.runner.engines.Engine`."""
        self._draining = True

    def _listen(self, hands: list[_Hand], queue: Queue) -> Iterator[News | None]:
        ready, now = wait([hand.pipe for hand in hands], timeout=BEAT_S), self._clock.now()
        if not ready:
            yield None
        for hand in hands:
            if hand.pipe not in ready:
                if hand.task and now - hand.since > self._limit_s:
                    hand.give_up(self._limit_s)
                continue
            news, hand.since = hand.hear(), now
            if isinstance(news, Failed):
                raise SessionFailed(news)
            if news is not None:
                yield news
            elif hand.task:
                yield queue.again(*hand.task, hand.cause)
                hand.task = None
            if self._draining and isinstance(news, TrialDone):
                hand.end()


class _Hand:
    """A worker process, the pipe to it, and the session it has in hand."""

    def __init__(self, make: RunnerFactory) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe: Connection
        self.pipe, far = context.Pipe(duplex=True)
        self.process = context.Process(target=worker.run_worker, args=(far, make, os.getpid()), daemon=True)
        with _quiet_environment():
            self.process.start()
        far.close()  # so that the worker's end closes with the worker
        self.task: tuple[Session, int] | None = None
        self.since = 0.0
        self.dead = False
        self._stuck = ""

    def give(self, session: Session, attempt: int, now: float) -> None:
        """Hand over a session; a worker that is already dead is noticed by `hear`."""
        self.task, self.since = (session, attempt), now
        try:
            self.pipe.send(session)
        except OSError:
            return

    def hear(self) -> News | None:
        """The next piece of news, None when the worker died."""
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
        """End a worker that is stuck; `hear` notices."""
        self._stuck = f"the limit of {after_s:.0f} s for a trial"
        self.process.kill()

    @property
    def cause(self) -> str:
        """What ended a dead worker."""
        code = self.process.exitcode
        if self._stuck:
            return self._stuck
        return f"signal {signal.Signals(-code).name}" if code is not None and code < 0 else f"exit status {code}"

    def end(self) -> None:
        """End the worker, kindly when it has nothing to do."""
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
    """What workers inherit: one thread a library, compiled code of this version alone, and no Ctrl-C for now."""
    before = dict(os.environ)
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    os.environ.update(worker.ONE_THREAD, PYTHONHASHSEED="0")
    code_identity.keep_compiled()
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
