"""The engine of live sessions: what it reports is taken before the next trial, and it ends when nobody listens."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import eval_fakes
import pytest

from hthor.eval.runner.messages import TrialDone, TrialOutcome
from hthor.live.control import SessionControl
from hthor.live.engine import LiveEngine
from hthor.trials.sessions import Session


def test_a_report_is_taken_before_the_next_trial_begins() -> None:
    (session, *_) = eval_fakes.run_of(20)[1]
    played: list[str] = []

    def play(session: Session) -> Iterator[TrialOutcome]:
        for record in eval_fakes.records(session):
            yield TrialOutcome(record=record)
            played.append(record.key)

    taken: list[str] = []
    for message in LiveEngine(SessionControl()).run_sessions([session], lambda: play):
        if isinstance(message, TrialDone):
            assert len(played) == len(taken)
            taken.append(message.key)
    assert taken == played
    assert len(taken) == len(session.trials)


def test_a_session_to_which_nobody_listens_any_more_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    (session, *_) = eval_fakes.run_of(20)[1]
    begin, reported = threading.Event(), threading.Event()
    engine = LiveEngine(SessionControl())
    wait = engine._wait_until_taken
    monkeypatch.setattr(engine, "_wait_until_taken", lambda news: (reported.set(), wait(news)))

    def play(session: Session) -> Iterator[TrialOutcome]:
        begin.wait()
        yield from (TrialOutcome(record=record) for record in eval_fakes.records(session))

    news = engine.run_sessions([session], lambda: play)
    assert next(news) is None
    begin.set()
    assert reported.wait(60.0)
    news.close()
    assert not any(thread.name == "trials" for thread in threading.enumerate())
