"""`hthor live` as one function: a run whose people are at pages."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable

import msgspec

from hthor import guest
from hthor.errors import HthorError
from hthor.eval.config import human_populations
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning.resolve import resolve
from hthor.eval.runner import experiment
from hthor.eval.runner.experiment import FinishedRun
from hthor.eval.runner.progress import Watcher
from hthor.eval.runner.run_job import ScheduledRun
from hthor.live import engine, wire
from hthor.live.control import SessionControl, SessionStopped
from hthor.live.desk import Desk
from hthor.live.engine import LiveEngine
from hthor.live.loop import RealTimeLoop
from hthor.live.robot_programs import RobotPrograms
from hthor.live.run_book import RunBook
from hthor.live.seat import LiveSeat
from hthor.live.server import LiveServer
from hthor.trials import robot_team

_FAREWELL_S = 1.0
"""[s] For the pages to hear that the session is over. Our choice."""
LIVE = "live"
"""The word of --humans for somebody at a page."""


class LiveRun:
    """A run of people at pages; a context manager that serves the pages.

    Args:
        options: those of `hthor eval`, with people called "live" among ``humans``.
        host, port, page: where to serve, and whether to browsers. now, sleep: as of `hthor.live.loop.RealTimeLoop`.
        tell: called with a sentence before something that takes a while, and with the addresses of robots' programs.

    Attributes:
        seats: the people at pages, by seat. server: what they connect to.
        scheduled: the run, from the moment that it is entered. It depends on what the robots' programs say about
            themselves, so the server comes first, and entering waits for them.

    Raises:
        HthorError: for any invalid option, also when it is entered.
    """

    scheduled: ScheduledRun

    def __init__(
        self,
        options: EvalOptions,
        *,
        host: str = "127.0.0.1",
        port: int = 0,
        page: bool = True,
        tell: Callable[[str], None] = lambda _: None,
        now: Callable[[], float] = time.perf_counter,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        options = msgspec.structs.replace(options, clock="concurrent", control=False, jobs=1)
        peoples = human_populations.find_people(options.humans)
        if len(peoples) != 1 or len(options.agent) > 1:
            raise HthorError("a person meets one robot team in a session: name one --agent and one word of --humans.")
        (people,) = peoples
        first = people.seats(0)
        live = [human.seat for human, word in zip(first, people.models, strict=True) if word == LIVE]
        if not live:
            raise HthorError(
                f"--humans {people.word}: nobody in it takes part at a page. Write live, live,live or live,proxy; "
                "simulated people alone are evaluated with 'hthor eval'."
            )
        self.seats = {seat: LiveSeat(seat) for seat in live}
        self.control = SessionControl()
        self.robots = RobotPrograms(_named_programs(options), tell=tell, wait=self._wait)
        self._book = RunBook()
        self.desk = Desk(self.control, self.seats, self._book)
        self.server = LiveServer(self.seats, self.desk, host=host, port=port, robots=self.robots)
        self._options, self._tell = options, tell
        self._now, self._sleep, self._page = now, sleep, page

    def __enter__(self) -> LiveRun:
        self.server.start(page=self._page)
        try:
            for agent in self.robots.tokens:
                self._tell(f"{agent}: {self.server.robot_url(agent)}")
            self._resolved = resolve(self._options, self._tell, self.robots)
            (self.scheduled,) = self._resolved.runs
            self.robots.check_team(self.scheduled.team)
            self._book.open(self.scheduled.folder)
        except BaseException:
            self.server.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self.control.stop()
        self.server.close()

    def play(self, make_watcher: Callable[[str], Watcher]) -> FinishedRun:
        """Play what is left of the run, and score it; errors as in `hthor.eval.runner.run.run_evaluation`."""
        run = self.scheduled
        most = max(len(one.trials) for one in run.sessions)
        loop = RealTimeLoop(
            self.seats,
            self.control,
            self.desk,
            trials=most,
            publish=self.server.publish,
            now=self._now,
            sleep=self._sleep,
        )
        live = msgspec.structs.replace(
            run,
            engine=LiveEngine(self.control, self._done(run)),
            runner=functools.partial(engine.make_runner, run.sources, self.seats, loop),
        )
        (done,) = experiment.run_experiment(msgspec.structs.replace(self._resolved, runs=(live,)), make_watcher)
        for seat in self.seats.values():
            seat.show(wire.Over(trials=sum(len(one.trials) for one in run.sessions)))
        time.sleep(_FAREWELL_S)
        return done

    def _wait(self, seconds: float) -> None:
        """Wait for a robot's program, unless the session is to end."""
        if self.control.draining:
            raise SessionStopped
        self.control.wait(seconds)

    def _done(self, run: ScheduledRun) -> frozenset[str]:
        """The keys of the trials that are over."""
        if not run.folder.holds_run:
            return frozenset()
        return frozenset(record.key for record in run.folder.played())


def _named_programs(options: EvalOptions) -> list[str]:
    """The words among these options for programs that connect."""
    named = [agent for _, agent in robot_team.split_robots(options.robots)] if options.robots else []
    return [word for word in dict.fromkeys([*named, *options.agent]) if guest.is_socket(word)]
