"""`hthor live` as one function: a run whose people are at pages."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import msgspec

from hthor import guest, rules
from hthor.errors import HthorError
from hthor.eval.config import human_populations
from hthor.eval.config.human_populations import LIVE
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning.resolve import resolve
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.runner import experiment
from hthor.eval.runner.experiment import FinishedRun
from hthor.eval.runner.progress import Watcher
from hthor.eval.runner.run_job import ScheduledRun
from hthor.live import local_network, wire
from hthor.live.certificate import Certificate, certificate
from hthor.live.control import SessionControl, SessionStopped
from hthor.live.desk import Desk
from hthor.live.desk_wire import SessionOver
from hthor.live.engine import LiveEngine
from hthor.live.loop import RealTimeLoop
from hthor.live.robot_programs import RobotPrograms
from hthor.live.run_book import RunBook
from hthor.live.seat import LiveSeat
from hthor.live.server import DESK, LiveServer
from hthor.live.sessions import LiveSessions
from hthor.live.tokens import SessionTokens
from hthor.live.unfinished import UnfinishedTrial
from hthor.report.person import person_page
from hthor.trials import robot_team
from hthor.trials.human_team import HumanTeam

_FAREWELL_S, _FETCH_S = 1.0, 15.0
"""[s] For the pages to hear that the session is over, and to fetch what it says of each person. Our choice."""


class LiveRun:
    """A run of people at pages; a context manager that serves the pages.

    Args:
        options: those of `hthor eval`, with people called "live" among ``humans``.
        port, page: where to serve, and whether to browsers.
        lan: whether other machines on the local network may connect, with encryption; else only this one.
        experimenter_starts: whether each trial waits for the experimenter.
        practice: whether each session begins with a practice, see `hthor.live.practice`.
        tell: called with a sentence before something that takes a while, and with the addresses of robots' programs.
        sections: called with the run's folder when the session is over: more for each person's own page, as HTML, by
            the person's number.
        now, sleep: as of `hthor.live.loop.RealTimeLoop`.

    Attributes:
        seats: the people at pages, by seat. server: what they connect to.
        scheduled: the run, from the moment that it is entered. It depends on what the robots' programs say about
            themselves, so the server comes first, and entering waits for them.
        hosts: this machine's addresses on the local network, if other machines may connect.
        certificate: what the server shows to other machines.

    Raises:
        HthorError: for any invalid option, also when it is entered.
    """

    scheduled: ScheduledRun

    def __init__(
        self,
        options: EvalOptions,
        *,
        port: int = 0,
        page: bool = True,
        lan: bool = False,
        experimenter_starts: bool = False,
        practice: bool = False,
        tell: Callable[[str], None] = lambda _: None,
        sections: Callable[[Path], Mapping[int, str]] = lambda _: {},
        now: Callable[[], float] = time.perf_counter,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        people = _people(options)
        options = msgspec.structs.replace(
            options,
            participants=options.participants or len(people.members),
            clock="concurrent",
            control=False,
            jobs=1,
        )
        self.seats = {seat: LiveSeat(seat) for seat in _live_seats(people)}
        self.control = SessionControl(experimenter_starts=experimenter_starts)
        programs = _named_programs(options)
        self._session_tokens = SessionTokens(options)
        tokens = self._session_tokens.of((*self.seats, DESK, *programs))
        self.robots = RobotPrograms({word: tokens[word] for word in programs}, tell=tell, wait=self._wait)
        self._book = RunBook()
        self.desk = Desk(self.control, self.seats, self._book)
        self.hosts: tuple[str, ...] = ()
        self.certificate: Certificate | None = None
        self.server = self._make_server(port, tokens, lan=lan)
        self._options, self._tell, self._sections = options, tell, sections
        self._now, self._sleep, self._page, self._practice = now, sleep, page, practice

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
        run, unfinished = self.scheduled, UnfinishedTrial(self.scheduled.folder.path)
        loop = RealTimeLoop(
            self.seats,
            self.control,
            self.desk,
            trials=max(len(one.trials) for one in run.sessions),
            publish=self.server.publish,
            unfinished=unfinished,
            now=self._now,
            sleep=self._sleep,
        )
        sessions = functools.partial(
            LiveSessions,
            run.sources,
            self.seats,
            loop,
            run.folder,
            unfinished,
            self._book.due,
            practice=self._practice,
        )
        live = msgspec.structs.replace(run, engine=LiveEngine(self.control), runner=sessions)
        self._void_unfinished(run.folder, unfinished)
        (done,) = experiment.run_experiment(msgspec.structs.replace(self._resolved, runs=(live,)), make_watcher)
        self._part(run)
        self._session_tokens.forget()
        return done

    def _part(self, run: ScheduledRun) -> None:
        """Tell everybody that the session is over, and give each person of the last one their own page."""
        over = wire.Over(trials=sum(len(one.trials) for one in run.sessions), making=True)
        for seat in self.seats.values():
            seat.show(over)
        pages: dict[str, str] = {}
        files: dict[str, str] = {}
        try:
            written = person_page.write_pages(RunFolder(run.folder.path), self._sections(run.folder.path))
            for human in run.sessions[-1].trials[0].humans:
                if human.seat in self.seats and human.participant in written:
                    page = written[human.participant]
                    files[human.seat] = f"{page.parent.name}/{page.name}"
                    pages[human.seat] = self.server.own_pages.publish(page.read_bytes())
        except HthorError as error:
            self._tell(f"the people's own pages were not made: {error}")
        for name, seat in self.seats.items():
            seat.show(msgspec.structs.replace(over, page=pages.get(name, ""), making=False))
        self.desk.show_over(SessionOver(folder=str(run.folder.path), pages=files))
        time.sleep(_FAREWELL_S)
        if all(seat.absent_s() == 0.0 for seat in self.seats.values()):
            self.server.own_pages.wait(_FETCH_S if self._page else 0.0)

    def _void_unfinished(self, folder: RunFolder, unfinished: UnfinishedTrial) -> None:
        """Add the trial in which the last command was killed to the log, as an attempt that does not count."""
        if not folder.holds_run:
            return
        with folder.open_log() as log:
            record = unfinished.add_to(log)
        if record is not None:
            seconds = record.ticks * rules.TICK_S
            self._tell(f"trial {record.spec.index + 1} was interrupted after {seconds:.0f} s, and is repeated")

    def _make_server(self, port: int, tokens: dict[str, str], *, lan: bool) -> LiveServer:
        """A server for this machine, or for others too."""
        make = functools.partial(LiveServer, self.seats, self.desk, port=port, tokens=tokens, robots=self.robots)
        if not lan:
            return make()
        self.hosts = local_network.addresses()
        if not self.hosts:
            raise HthorError(
                "--lan: this machine has no address that other machines could open. Connect it to the network, or "
                "leave out --lan."
            )
        hosts = (*self.hosts, local_network.host_name())
        self.certificate = certificate((*hosts, "localhost", "127.0.0.1"))
        return make(host=local_network.EVERYWHERE, hosts=hosts, certificate=self.certificate)

    def _wait(self, seconds: float) -> None:
        """Wait for a robot's program, unless the session is to end."""
        if self.control.draining:
            raise SessionStopped
        self.control.wait(seconds)


def _people(options: EvalOptions) -> HumanTeam:
    """The people of a trial; raises HthorError when several populations or robot teams are named."""
    peoples = human_populations.find_people(options.humans)
    if len(peoples) != 1 or len(options.agent) > 1:
        raise HthorError("a person meets one robot team in a session: name one --agent and one word of --humans.")
    return peoples[0]


def _live_seats(people: HumanTeam) -> list[str]:
    """The seats of the people who take part at pages; raises HthorError when there is none."""
    live = [human.seat for human, word in zip(people.seats(0), people.models, strict=True) if word == LIVE]
    if not live:
        raise HthorError(
            f"--humans {people.word}: nobody in it takes part at a page. Write live, live,live or live,proxy; "
            "simulated people alone are evaluated with 'hthor eval'."
        )
    return live


def _named_programs(options: EvalOptions) -> list[str]:
    """The words among these options for programs that connect."""
    named = [agent for _, agent in robot_team.split_robots(options.robots)] if options.robots else []
    return [word for word in dict.fromkeys([*named, *options.agent]) if guest.is_socket(word)]
