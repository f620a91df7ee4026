"""`hthor live` as one function: a run whose people are at pages."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable

import msgspec

from hthor import rules
from hthor.errors import HthorError
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning.resolve import resolve
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.replay.recorded_session import LIVE
from hthor.eval.runner import experiment
from hthor.eval.runner.experiment import FinishedRun
from hthor.eval.runner.progress import Watcher
from hthor.live import local_network, wire
from hthor.live.certificate import Certificate, certificate
from hthor.live.control import SessionControl
from hthor.live.desk import Desk
from hthor.live.engine import LiveEngine
from hthor.live.loop import RealTimeLoop
from hthor.live.run_book import RunBook
from hthor.live.seat import LiveSeat
from hthor.live.server import DESK, LiveServer
from hthor.live.sessions import LiveSessions
from hthor.live.tokens import SessionTokens
from hthor.live.unfinished import UnfinishedTrial

_FAREWELL_S = 1.0
"""[s] For the pages to hear that the session is over. Our choice."""


class LiveRun:
    """A run of people at pages; a context manager that serves the pages.

    Args:
        options: those of `hthor eval`, with people called "live" among ``humans``.
        port, page: where to serve, and whether to browsers.
        lan: whether other machines on the local network may connect, with encryption; else only this one.
        experimenter_starts: whether each trial waits for the experimenter.
        now, sleep: as of `hthor.live.loop.RealTimeLoop`.

    Attributes:
        scheduled: the run. seats: the people at pages, by seat. server: what they connect to.
        hosts: this machine's addresses on the local network, if other machines may connect.
        certificate: what the server shows to other machines.

    Raises:
        HthorError: for any invalid option.
    """

    def __init__(
        self,
        options: EvalOptions,
        *,
        port: int = 0,
        page: bool = True,
        lan: bool = False,
        experimenter_starts: bool = False,
        tell: Callable[[str], None] = lambda _: None,
        now: Callable[[], float] = time.perf_counter,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        options = msgspec.structs.replace(options, clock="concurrent", control=False, jobs=1)
        resolved = resolve(options, tell)
        if len(resolved.runs) != 1:
            raise HthorError("a person meets one robot team in a session: name one --agent and one word of --humans.")
        (self.scheduled,) = resolved.runs
        people = self.scheduled.people
        first = people.seats(0)
        live = [human.seat for human, word in zip(first, people.models, strict=True) if word == LIVE]
        if not live:
            raise HthorError(
                f"--humans {people.word}: nobody in it takes part at a page. Write live, live,live or live,proxy; "
                "simulated people alone are evaluated with 'hthor eval'."
            )
        self.seats = {seat: LiveSeat(seat) for seat in live}
        self.control = SessionControl(experimenter_starts=experimenter_starts)
        self._book = RunBook(self.scheduled.folder)
        self.desk = Desk(self.control, self.seats, self._book)
        self._tokens = SessionTokens(self.scheduled.folder.path)
        self.hosts: tuple[str, ...] = ()
        self.certificate: Certificate | None = None
        self.server = self._make_server(port, lan=lan)
        self._resolved, self._now, self._sleep, self._page, self._tell = resolved, now, sleep, page, tell

    def __enter__(self) -> LiveRun:
        self.server.start(page=self._page)
        return self

    def __exit__(self, *_: object) -> None:
        self.control.stop()
        self.server.close()

    def play(self, make_watcher: Callable[[str], Watcher]) -> FinishedRun:
        """Play what is left of the run, and score it; errors as in `hthor.eval.runner.run.run_evaluation`."""
        run = self.scheduled
        most = max(len(one.trials) for one in run.sessions)
        unfinished = UnfinishedTrial(run.folder.path)
        loop = RealTimeLoop(
            self.seats,
            self.control,
            self.desk,
            trials=most,
            publish=self.server.publish,
            unfinished=unfinished,
            now=self._now,
            sleep=self._sleep,
        )
        sessions = functools.partial(
            LiveSessions, run.sources, self.seats, loop, run.folder, unfinished, self._book.due
        )
        live = msgspec.structs.replace(run, engine=LiveEngine(self.control), runner=sessions)
        self._void_unfinished(run.folder, unfinished)
        (done,) = experiment.run_experiment(msgspec.structs.replace(self._resolved, runs=(live,)), make_watcher)
        for seat in self.seats.values():
            seat.show(wire.Over(trials=sum(len(one.trials) for one in run.sessions)))
        time.sleep(_FAREWELL_S)
        self._tokens.forget()
        return done

    def _void_unfinished(self, folder: RunFolder, unfinished: UnfinishedTrial) -> None:
        """Add the trial in which the last command was killed to the log, as an attempt that does not count."""
        if not folder.holds_run:
            return
        with folder.open_log() as log:
            record = unfinished.add_to(log)
        if record is not None:
            seconds = record.ticks * rules.TICK_S
            self._tell(f"trial {record.spec.index + 1} was interrupted after {seconds:.0f} s, and is repeated")

    def _make_server(self, port: int, *, lan: bool) -> LiveServer:
        """A server for this machine, or for others too."""
        tokens = self._tokens.of((*self.seats, DESK))
        if not lan:
            return LiveServer(self.seats, self.desk, port=port, tokens=tokens)
        self.hosts = local_network.addresses()
        if not self.hosts:
            raise HthorError(
                "--lan: this machine has no address that other machines could open. Connect it to the network, or "
                "leave out --lan."
            )
        hosts = (*self.hosts, local_network.host_name())
        self.certificate = certificate((*hosts, "localhost", "127.0.0.1"))
        where = local_network.EVERYWHERE
        return LiveServer(
            self.seats, self.desk, host=where, port=port, hosts=hosts, certificate=self.certificate, tokens=tokens
        )
