"""What a simulated person decided, sent through the socket by a scripted client, ends as it ended without one."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import pytest
from live_session import Book
from proxy_at_page import Course, Follower, Turns, attend, in_batch

from hthor.episode import EpisodeLog
from hthor.guest import GuestPool
from hthor.live.control import SessionControl
from hthor.live.desk import Desk
from hthor.live.loop import RealTimeLoop
from hthor.live.seat import LiveSeat
from hthor.live.server import LiveServer
from hthor.live.sessions import welcome
from hthor.trials import TrialRunner, form_team, make_sessions, make_sources
from hthor.types import HUMAN
from hthor.types.events import Accepted, Declined

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")


@contextmanager
def page_server(seat: LiveSeat, control: SessionControl, desk: Desk) -> Iterator[LiveServer]:
    server = LiveServer({HUMAN: seat}, desk)
    server.start(page=False)
    try:
        yield server
    finally:
        server.close()


def at_a_page(agent: str, session: int, courses: list[Course]) -> list[EpisodeLog]:
    """The same trials by a client that follows these courses."""
    team = form_team(["scout"], [agent])
    seat, control = LiveSeat(HUMAN), SessionControl()
    turns, desk = Turns(seat), Desk(control, {HUMAN: seat}, Book())
    loop = RealTimeLoop({HUMAN: seat}, control, desk, now=turns.now, sleep=turns.sleep)
    runner = TrialRunner(make_sources(team), GuestPool(), loop=loop)
    (chosen,) = (one for one in make_sessions("smoke", agent=team, humans="live") if one.number == session)
    logs = []
    with page_server(seat, control, desk) as server, runner.enter(chosen) as participants:
        welcome(participants, {HUMAN: seat})
        for trial, course in zip(chosen.trials, courses, strict=False):
            turns.restart()
            with Follower(server.address, server.tokens[HUMAN], trial.index, course) as person:
                threading.Thread(target=attend, args=(person, trial.index)).start()
                logs.append(runner.run(participants, trial).log)
    return logs


ALL = pytest.mark.nightly


@pytest.mark.parametrize(
    ("agent", "sessions", "trials"),
    [
        pytest.param("frontier", (0,), 2, id="two trials"),
        pytest.param("none", range(6), 10, id="all of smoke without a robot", marks=ALL),
        pytest.param("frontier", range(6), 10, id="all of smoke beside a robot", marks=ALL),
    ],
)
def test_what_a_proxy_decided_ends_at_a_page_as_in_batch(agent: str, sessions: Sequence[int], trials: int) -> None:
    for session in sessions:
        played = in_batch(agent, session, trials)
        again = at_a_page(agent, session, [course for _, course in played])
        for number, ((log, _), at_page) in enumerate(zip(played, again, strict=True)):
            where = f"session {session}, trial {number}"
            assert at_page.met == log.met, where
            assert abs(at_page.ticks - log.ticks) <= 3, where
            assert _answers(at_page) == _answers(log), where


def _answers(log: EpisodeLog) -> list[tuple[str, int]]:
    """How messages were answered."""
    return [(event.kind, event.message) for event in log.events if isinstance(event, Accepted | Declined)]
