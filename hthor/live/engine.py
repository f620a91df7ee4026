"""Runs the sessions of a run in this process, one after another, with people at their pages."""

from __future__ import annotations

import queue
import threading
from collections.abc import Generator, Sequence
from contextlib import suppress

from hthor.eval.records.trial_log import BEAT_S
from hthor.eval.runner.engines import SessionFailed
from hthor.eval.runner.messages import Failed, News, RunnerFactory, TrialDone
from hthor.eval.runner.worker import SessionPlayer
from hthor.live.control import SessionControl, SessionStopped
from hthor.trials.sessions import Session

_TURN_S = 0.01
"""[s] How often the trials' thread looks whether its news were taken. Our choice."""


class LiveEngine:
    """An engine of `hthor.eval.runner.engines` for people; ``control`` is what the experimenter may do."""

    def __init__(self, control: SessionControl) -> None:
        self._control = control

    def run_sessions(self, sessions: Sequence[Session], make: RunnerFactory) -> Generator[News | None, None, None]:
        """Run what is left of the sessions, and report what happens; closing the generator ends the session.

        A trial that was reported is in the log before the next begins.
        """
        news: queue.Queue[News | None] = queue.Queue()
        thread = threading.Thread(target=self._play, args=(sessions, make, news), name="trials", daemon=True)
        thread.start()
        try:
            while True:
                try:
                    message = news.get(timeout=BEAT_S)
                except queue.Empty:
                    yield None
                    continue
                if message is None:
                    return
                if isinstance(message, Failed):
                    raise SessionFailed(message)
                try:
                    yield message
                finally:
                    news.task_done()
        finally:
            self._control.stop()
            thread.join()

    def drain(self) -> None:
        """Start no more trials; the one that is going on is finished."""
        self._control.draining = True

    def _wait_until_taken(self, news: queue.Queue[News | None]) -> None:
        """Wait until all news were taken, but not for somebody who has closed the generator."""
        with suppress(SessionStopped):
            while news.unfinished_tasks:
                self._control.wait(_TURN_S)

    def _play(self, sessions: Sequence[Session], make: RunnerFactory, news: queue.Queue[News | None]) -> None:
        player = SessionPlayer(make)
        try:
            for session in sessions:
                for message in player.run(session):
                    news.put(message)
                    if isinstance(message, TrialDone):
                        self._wait_until_taken(news)
                    if self._control.draining or self._control.stopped:
                        return
        finally:
            news.put(None)
