"""Runs the sessions of a run in this process, one after another, with people at their pages."""

from __future__ import annotations

import functools
import queue
import threading
from collections.abc import Callable, Collection, Generator, Iterator, Mapping, Sequence

import msgspec

from hthor.eval.records import trial_record
from hthor.eval.records.trial_log import BEAT_S
from hthor.eval.runner import session_runner
from hthor.eval.runner.engines import SessionFailed
from hthor.eval.runner.messages import Failed, News, RunnerFactory, SessionRunner
from hthor.eval.runner.worker import SessionPlayer
from hthor.humans.models import live
from hthor.live.control import SessionControl
from hthor.live.loop import RealTimeLoop
from hthor.live.seat import LiveSeat
from hthor.trials import Participants, Sources
from hthor.trials.sessions import Session
from hthor.types import TrialSpec

_TURN_S = 0.05
"""[s] How often the trials' thread looks whether the log has what it sent. Our choice."""


class LiveEngine:
    """An engine of `hthor.eval.runner.engines` for people.

    Args:
        control: what the experimenter may do. done: the keys of trials that are over, which are not played again.
        due: the attempts that the log lacks of a session's trials, as they were voided; by the session's number.
    """

    def __init__(
        self,
        control: SessionControl,
        done: Collection[str] = (),
        due: Callable[[int], Sequence[TrialSpec]] = lambda _: (),
    ) -> None:
        self._control, self._done, self._due = control, frozenset(done), due
        self._sent = self._kept = 0  # messages, and how many of them have reached the log

    def run_sessions(self, sessions: Sequence[Session], make: RunnerFactory) -> Generator[News | None, None, None]:
        """Run what is left of the sessions, and report what happens; closing the generator ends the session."""
        news: queue.SimpleQueue[News | None] = queue.SimpleQueue()
        left = [rest for session in sessions if (rest := self._rest(session)).trials]
        thread = threading.Thread(target=self._play, args=(left, make, news), name="trials", daemon=True)
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
                yield message
                self._kept += 1
        finally:
            self._control.stop()
            thread.join()

    def drain(self) -> None:
        """Start no more trials; the one that is going on is finished."""
        self._control.draining = True

    def repetitions(self, session: Session) -> Iterator[TrialSpec]:
        """The session's trials that were voided, each as its next attempt, until every trial has one that counts."""
        while True:
            while self._kept < self._sent:
                self._control.wait(_TURN_S)
            due = self._due(session.number)
            if not due:
                return
            yield due[0]

    def _rest(self, session: Session) -> Session:
        trials = tuple(trial for trial in session.trials if trial_record.key(trial) not in self._done)
        return msgspec.structs.replace(session, trials=trials)

    def _play(self, sessions: Sequence[Session], make: RunnerFactory, news: queue.SimpleQueue[News | None]) -> None:
        player = SessionPlayer(make)
        try:
            for session in sessions:
                for message in player.run(session):
                    self._sent += 1
                    news.put(message)
                    if self._control.draining or self._control.stopped:
                        return
        finally:
            news.put(None)


def make_runner(
    sources: Sources,
    seats: Mapping[str, LiveSeat],
    loop: RealTimeLoop,
    repetitions: Callable[[Session], Iterator[TrialSpec]],
) -> SessionRunner:
    """The session runner of a live session, whose people sit at these pages; see `LiveEngine.repetitions`."""
    return session_runner.make_runner(sources, loop, functools.partial(welcome, seats=seats), repetitions)


def welcome(participants: Participants, seats: Mapping[str, LiveSeat]) -> None:
    """Connect the people of a session with the pages in their seats."""
    for name, seat in seats.items():
        human = participants.humans[name]
        assert isinstance(human, live.Model)
        human.port = seat
