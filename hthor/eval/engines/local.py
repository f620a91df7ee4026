"""Worker processes on this machine: hands out sessions, replaces workers that die; knows nothing of files."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from multiprocessing.connection import Connection, wait
from typing import TYPE_CHECKING

from hthor.errors import HthorError
from hthor.eval import provenance, worker
from hthor.eval.engines import BEAT_S, Make, Queue, SessionFailed
from hthor.eval.worker import Failed, Finished, News

if TYPE_CHECKING:
    from hthor.eval.session import Session


class Engine:
    """The supervisor. Workers are fresh processes that die with it.

    Args:
        jobs: how many workers; None is one a CPU.
        address: must be empty.
    """

    def __init__(self, *, jobs: int | None = None, address: str = "", gpus: float = 0.0) -> None:
        del gpus  # whoever shares a machine's GPU shares it among the jobs
        if address:
            raise HthorError(f"--address {address}: the engine 'local' has none. Leave it out, or add --engine ray.")
        self._jobs = jobs or len(os.sched_getaffinity(0))

    def perform(self, sessions: Sequence[Session], make: Make) -> Generator[News | None, None, None]:
        """See `hthor.eval.engines.Engine`."""
        queue = Queue(sessions)
        hands: list[_Hand] = []
        try:
            while queue or any(hand.task for hand in hands):
                hands = [hand for hand in hands if not hand.dead]
                while len(hands) < min(self._jobs, len(queue) + sum(1 for hand in hands if hand.task)):
                    hands.append(_Hand(make))
                for hand in hands:
                    if queue and not hand.task:
                        hand.give(*queue.take())
                yield from _listen(hands, queue)
        finally:
            for hand in hands:
                hand.end()


def _listen(hands: list[_Hand], queue: Queue) -> Iterator[News | None]:
    ready = wait([hand.pipe for hand in hands], timeout=BEAT_S)
    if not ready:
        yield None
    for hand in hands:
        if hand.pipe not in ready:
            continue
        news = hand.hear()
        if isinstance(news, Failed):
            raise SessionFailed(news)
        if news is not None:
            yield news
        elif hand.task:
            queue.again(*hand.task, _cause(hand.process.exitcode))
            hand.task = None


class _Hand:
    """A worker process, the pipe to it, and the session it has in hand."""

    def __init__(self, make: Make) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe: Connection
        self.pipe, far = context.Pipe(duplex=True)
        self.process = context.Process(target=worker.work, args=(far, make, os.getpid()), daemon=True)
        with _quiet_environment():
            self.process.start()
        far.close()  # so that the worker's end closes with the worker
        self.task: tuple[Session, int] | None = None
        self.dead = False

    def give(self, session: Session, attempt: int) -> None:
        """Hand over a session; a worker that is already dead is noticed by `hear`."""
        self.task = (session, attempt)
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
        if isinstance(news, Finished):
            self.task = None
        return news

    def end(self) -> None:
        """End the worker, kindly when it has nothing to do."""
        if self.dead:
            return
        if self.task is not None:
            self.process.kill()
        self.pipe.close()
        self.process.join()


def _cause(code: int | None) -> str:
    if code is not None and code < 0:
        return f"signal {signal.Signals(-code).name}"
    return f"exit status {code}"


@contextmanager
def _quiet_environment() -> Iterator[None]:
    """What workers inherit: one thread a library, compiled code of this version alone, and no Ctrl-C for now."""
    before = dict(os.environ)
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    os.environ.update(worker.ONE_THREAD, PYTHONHASHSEED="0")
    os.environ.setdefault("NUMBA_CACHE_DIR", str(provenance.compiled()))
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
