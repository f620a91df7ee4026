"""The supervisor of worker processes: hands out sessions, replaces workers that die; knows nothing of files."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager
from multiprocessing.connection import Connection, wait
from typing import TYPE_CHECKING

from hthor.errors import HthorError, RunError
from hthor.eval import provenance, worker
from hthor.eval.worker import Failed, Finished, News, Played

if TYPE_CHECKING:
    from hthor.eval.record import Record
    from hthor.eval.session import Session

ATTEMPTS = 3
"""How often a session may cost a worker its life."""

Make = Callable[[], "Callable[[Session], Iterator[Record]]"]


class SessionFailed(HthorError):
    """A session could not be played. ``detail`` is a traceback when the fault is ours, empty when it is the user's."""

    def __init__(self, failed: Failed) -> None:
        self.exit_code, self.detail = failed.exit_code, failed.detail
        super().__init__(failed.message)


def perform(
    sessions: Sequence[Session], make: Make, *, jobs: int, beat_s: float = 0.25
) -> Generator[News | None, None, None]:
    """Play sessions in worker processes and tell what happens, at least once for every trial.

    A trial is told of again when its session had to be started again. Closing the iterator ends the workers.

    Args:
        make: picklable; called once in each worker, gives what plays a session.
        jobs: how many workers.
        beat_s: after so many seconds [s] without news comes None, so that the caller may look around.

    Raises:
        SessionFailed: when playing raised an exception.
        RunError: when a session ended `ATTEMPTS` workers.
    """
    queue = deque((session, 1) for session in sessions)
    hands: list[_Hand] = []
    try:
        while queue or any(hand.task for hand in hands):
            hands = [hand for hand in hands if not hand.dead]
            while len(hands) < min(jobs, len(queue) + sum(1 for hand in hands if hand.task)):
                hands.append(_Hand(make))
            for hand in hands:
                if queue and not hand.task:
                    hand.give(*queue.popleft())
            yield from _listen(hands, queue, beat_s)
    finally:
        for hand in hands:
            hand.end()


def _listen(hands: list[_Hand], queue: deque[tuple[Session, int]], beat_s: float) -> Iterator[News | None]:
    ready = wait([hand.pipe for hand in hands], timeout=beat_s)
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
            queue.appendleft(hand.retry())


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

    def retry(self) -> tuple[Session, int]:
        """What the dead worker had in hand, for another attempt."""
        assert self.task is not None
        (session, attempt), self.task = self.task, None
        if attempt >= ATTEMPTS:
            raise RunError(
                f"the session of participant {session.participant} ended {ATTEMPTS} workers, the last by "
                f"{_cause(self.process.exitcode)}. What was played before is kept. If memory ran out, repeat the "
                "command with a smaller --jobs."
            )
        return (session, attempt + 1)

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


__all__ = ["ATTEMPTS", "Failed", "Finished", "Make", "News", "Played", "SessionFailed", "perform"]
