"""Sessions with people at pages, in this process: a server, and trials in a thread."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import msgspec
import relay
from live_client import ScriptedPerson

from hthor.episode import EpisodeLog
from hthor.errors import HthorError
from hthor.guest import GuestPool
from hthor.live.control import SessionControl, SessionStopped
from hthor.live.desk import Desk
from hthor.live.desk_wire import PlayedTrial
from hthor.live.loop import RealTimeLoop
from hthor.live.seat import LiveSeat
from hthor.live.server import LiveServer
from hthor.live.sessions import welcome
from hthor.trials import TrialRunner, form_team, make_sessions, make_sources
from hthor.trials.robot_team import RobotTeam
from hthor.trials.sessions import Session
from hthor.types import HUMAN, TaskSpec
from hthor.world import World

FASTER = 3.0
"""How many times faster than real time trials are that no browser takes part in."""

AGENT = """
from hthor.types import Action, Send, Wait


class Agent:
    def begin(self, briefing):
        self.said = False

    def act(self, observation):
        if self.said or observation.tick < 5:
            return Action(motion=Wait(seconds=0.2))
        self.said = True
        return Action(say=Send(text="It is over there.", object="apple", position=(1.0, 1.0, 0.8)))
"""


def smoke_session(team: RobotTeam, seconds: float = 4.0, trials: int = 1, humans: str = "live") -> Session:
    """The first trials of the smoke suite with a live person, cut to a few seconds."""
    first = make_sessions("smoke", agent=team, humans=humans, clock="concurrent")[0]
    short = [
        msgspec.structs.replace(one, task=msgspec.structs.replace(one.task, time_limit=seconds)) for one in first.trials
    ]
    return msgspec.structs.replace(first, trials=tuple(short[:trials]))


def with_tasks(session: Session, tasks: Sequence[TaskSpec]) -> Session:
    """A session with these tasks in place of its own."""
    trials = [msgspec.structs.replace(session.trials[0], task=task, index=number) for number, task in enumerate(tasks)]
    return msgspec.structs.replace(session, trials=tuple(trials))


class Book:
    """A run's log without a run."""

    def __init__(self) -> None:
        self.corrections: list[tuple[str, str, bool | None, str]] = []
        self.repeated: list[tuple[str, str]] = []

    def played(self) -> tuple[PlayedTrial, ...]:
        return ()

    def repeat(self, trial: str, reason: str) -> None:
        if not reason:
            raise HthorError("a correction needs a reason.")
        self.repeated.append((trial, reason))

    def correct(self, trial: str, seat: str, adopted: bool | None, reason: str) -> None:
        if not reason:
            raise HthorError("a correction needs a reason.")
        self.corrections.append((trial, seat, adopted, reason))


class LiveSession:
    """A session that is played in a thread, with a robot that sends a message after half a second.

    Args:
        tasks: played in ``world`` in place of those of the smoke suite.
        faster: how many times faster than real time. options: see `smoke_session`.
        experimenter_starts: whether each trial waits for the experimenter.
    """

    def __init__(
        self,
        folder: Path,
        tasks: Sequence[TaskSpec] = (),
        world: World | None = None,
        faster: float = FASTER,
        experimenter_starts: bool = False,
        **options: Any,
    ) -> None:
        path = folder / "teller.py"
        path.write_text(AGENT, encoding="utf-8")
        team = form_team(["scout"], [str(path)])
        self.session, self._world = smoke_session(team, **options), world
        if tasks:
            self.session = with_tasks(self.session, tasks)
        self.seat = LiveSeat(HUMAN)
        self.control = SessionControl(experimenter_starts=experimenter_starts)
        self.seats = {HUMAN: self.seat}
        self.book = Book()
        self.desk = Desk(self.control, self.seats, self.book)
        self.server = LiveServer(self.seats, self.desk, hosts=(relay.HOST,))
        self.server.start(page=world is not None)
        self.logs: list[EpisodeLog] = []
        loop = RealTimeLoop(
            self.seats,
            self.control,
            self.desk,
            trials=len(self.session.trials),
            publish=self.server.publish if world is not None else None,
            now=lambda: faster * time.perf_counter(),
            sleep=lambda seconds: time.sleep(seconds / faster),
        )
        self._runner = TrialRunner(make_sources(team), GuestPool(), loop=loop)
        self.thread = threading.Thread(target=self._play)
        self.thread.start()

    def _play(self) -> None:
        with suppress(SessionStopped), self._runner.enter(self.session) as participants:
            welcome(participants, self.seats)
            for trial in self.session.trials:
                self.logs.append(self._runner.run(participants, trial, self._world).log)

    def person(self, *, token: str = "", **changes: Any) -> ScriptedPerson:
        """Somebody at a page without a browser."""
        return ScriptedPerson(self.server.address, token or self.server.tokens[HUMAN], **changes)

    def wait_until(self, done: Callable[[], bool], seconds: float = 60.0) -> None:
        """Wait until something is so."""
        end = time.monotonic() + seconds
        while not done():
            assert time.monotonic() < end
            time.sleep(0.02)

    def log(self) -> EpisodeLog:
        """The log of the first trial; waits for the end of the session."""
        self.thread.join(60.0)
        return self.logs[0]

    def close(self) -> None:
        """End the session."""
        self.control.stop()
        self.thread.join(60.0)
        self.server.close()
