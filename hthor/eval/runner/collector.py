"""Listening to an engine: what is new goes to the log, what is lost is told."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from hthor import jsonio
from hthor.errors import HthorError, RunError
from hthor.eval.records.session_restarts import SessionRestarts
from hthor.eval.runner.messages import Finished, SessionAbandoned, SessionRestarted, TrialDone

if TYPE_CHECKING:
    from hthor.eval.config.sessions import Session
    from hthor.eval.records.trial_log import TrialLog
    from hthor.eval.runner.engines import Engine, RunnerFactory
    from hthor.eval.runner.fault_report import FaultArchive
    from hthor.eval.runner.run import Watcher

ERRORS = "error.txt"
_HOPELESS = 3
"""So many sessions are given up before a run ends of which nothing at all could be played."""


class Unfinished(RunError):
    """Some sessions could not be played; what could is kept."""

    exit_code = 1


class InternalFailure(HthorError):
    """A trial failed by our own fault."""

    exit_code = 1


@dataclass
class CollectedTrials:
    """What came of playing: CPU time [s], new trials, sessions that began again, and those that were given up.

    ``void`` are the participants whose sessions are to be played again: what came of them does not count.
    """

    cpu_s: float = 0.0
    new: int = 0
    other: int = 0
    played: int = 0
    replays: int = 0
    lost: list[SessionAbandoned] = field(default_factory=list)
    void: set[int] = field(default_factory=set)

    @property
    def hopeless(self) -> bool:
        """Whether it is no use to go on."""
        return not self.played and len(self.lost) >= _HOPELESS


def collect(
    book: TrialLog,
    engine: Engine,
    sessions: Sequence[Session],
    make: RunnerFactory,
    watch: Watcher,
    keeper: FaultArchive,
    stop: threading.Event,
    *,
    steady: bool = True,
) -> CollectedTrials:
    """Play sessions and write down what is new, and beside the log what is left of agents that failed.

    Args:
        steady: whether a trial that is played again has to go the same way.
    """
    came, do_overs = CollectedTrials(), SessionRestarts(book.path.parent)
    _listen(book, engine, sessions, make, watch, keeper, stop, came, do_overs)
    if (left := [session for session in sessions if session.participant in came.void]) and not stop.is_set():
        came.void.clear()
        _listen(book, engine, left, make, watch, keeper, stop, came, do_overs)
    if came.other and steady:
        watch.note(
            f"{came.other} trials went otherwise when they were played again: something here does not repeat itself"
        )
    return came


def _listen(
    book: TrialLog,
    engine: Engine,
    sessions: Sequence[Session],
    make: RunnerFactory,
    watch: Watcher,
    keeper: FaultArchive,
    stop: threading.Event,
    came: CollectedTrials,
    do_overs: SessionRestarts,
) -> None:
    """Take in what an engine tells of sessions, until all are over; `CollectedTrials` has what came of it."""
    draining = False
    with closing(engine.perform(sessions, make)) as stream:
        for news in stream:
            if isinstance(news, TrialDone):
                came.played += 1
                if _voided(news, came, do_overs, watch, known=news.key in book):
                    continue
                if book.append(news.key, news.line):
                    came.new += 1
                    watch.played(news.met, news.faulty)
                    if news.left is not None:
                        keeper.keep(news.left)
                else:
                    came.other += not book.agrees(news.key, news.line)
            elif isinstance(news, Finished):
                came.cpu_s += news.cpu_s
            elif isinstance(news, SessionRestarted):
                came.replays += 1
                watch.note(f"the session of participant {news.participant} begins again: {news.cause}")
            elif isinstance(news, SessionAbandoned) and not _voided(news, came, do_overs, watch):
                came.lost.append(news)
                watch.note(f"the session of participant {news.participant} is given up: {news.cause}")
            book.sync(due=True)
            watch.beat()
            if came.hopeless:
                break
            if stop.is_set() and not draining:
                draining = True
                engine.drain()
                watch.note("stopping when the trials that are being played are over; Ctrl-C again stops at once")


def _voided(
    news: TrialDone | SessionAbandoned,
    came: CollectedTrials,
    do_overs: SessionRestarts,
    watch: Watcher,
    *,
    known: bool = False,
) -> bool:
    """Whether news is of a session that is to be played again, as an agent's process was killed in it."""
    if news.participant not in came.void:
        if known or not news.killed or not do_overs.take(news.participant):
            return False
        came.void.add(news.participant)
        came.replays += 1
        watch.note(f"the session of participant {news.participant} begins again: an agent's process was killed")
    return True


def unfinished_error(folder: Path, lost: Sequence[SessionAbandoned], missing: int, wanted: int) -> HthorError:
    """What to tell of sessions that were given up; their tracebacks go to a file."""
    told = "; ".join(f"participant {one.participant}: {one.cause.rstrip('.')}" for one in lost[:_HOPELESS])
    more = f"; and {len(lost) - _HOPELESS} more" if len(lost) > _HOPELESS else ""
    tail = f"{missing} of {wanted} trials are missing, all others are kept."
    if details := [f"participant {one.participant}\n{one.detail}" for one in lost if one.detail]:
        jsonio.write(folder / ERRORS, "\n".join(details).encode())
        return InternalFailure(f"{told}{more}. {tail} The traceback is in {folder / ERRORS}.")
    return Unfinished(
        f"{told}{more}. {tail} The same command tries them again; if memory ran out, with fewer --jobs, and if a trial "
        "needs longer, with a higher --trial-limit."
    )
