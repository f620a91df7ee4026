"""Listening to an engine: what is new goes to the log, what is lost is told; knows nothing of scores."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from hthor import jsonio
from hthor.errors import HthorError, RunError
from hthor.eval.news import Again, Finished, Lost, Played

if TYPE_CHECKING:
    from hthor.eval.engines import Engine, Make
    from hthor.eval.log import Log
    from hthor.eval.remains import Keeper
    from hthor.eval.run import Watcher
    from hthor.eval.session import Session

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
class Course:
    """What came of playing: CPU time [s], new trials, sessions that began again, and those that were given up."""

    cpu_s: float = 0.0
    new: int = 0
    other: int = 0
    played: int = 0
    replays: int = 0
    lost: list[Lost] = field(default_factory=list)

    @property
    def hopeless(self) -> bool:
        """Whether it is no use to go on."""
        return not self.played and len(self.lost) >= _HOPELESS


def play(
    book: Log,
    engine: Engine,
    sessions: Sequence[Session],
    make: Make,
    watch: Watcher,
    keeper: Keeper,
    stop: threading.Event,
    *,
    steady: bool = True,
) -> Course:
    """Play sessions and write down what is new, and beside the log what is left of agents that failed.

    Args:
        steady: whether a trial that is played again has to go the same way.
    """
    came, draining = Course(), False
    with closing(engine.perform(sessions, make)) as stream:
        for news in stream:
            if isinstance(news, Played):
                came.played += 1
                if book.append(news.key, news.line):
                    came.new += 1
                    watch.played(news.met, news.faulty)
                    if news.left is not None:
                        keeper.keep(news.left)
                else:
                    came.other += not book.agrees(news.key, news.line)
            elif isinstance(news, Finished):
                came.cpu_s += news.cpu_s
            elif isinstance(news, Again):
                came.replays += 1
                watch.note(f"the session of participant {news.participant} begins again: {news.cause}")
            elif isinstance(news, Lost):
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
    if came.other and steady:
        watch.note(
            f"{came.other} trials went otherwise when they were played again: something here does not repeat itself"
        )
    return came


def unfinished(folder: Path, lost: Sequence[Lost], missing: int, wanted: int) -> HthorError:
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
