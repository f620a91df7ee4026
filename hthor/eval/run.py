"""One run from its configuration to its result: claim the folder, play what is missing, score; prints nothing."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from pathlib import Path
from types import FrameType
from typing import Protocol

from hthor import jsonio
from hthor.errors import HthorError, RunError
from hthor.eval import control, engines, guarded, log, record, score, setup
from hthor.eval.engines import Engine, Make, SessionFailed
from hthor.eval.log import Log
from hthor.eval.remains import Keeper
from hthor.eval.score import Effort, Result
from hthor.eval.session import Session
from hthor.eval.setup import Setup
from hthor.eval.worker import Finished, Played

EFFORT = "effort.json"
"""What a shard took. A result it has none, as that is of whole runs."""


class Watcher(Protocol):
    """Who wants to know how a run goes."""

    def begin(self, total: int, kept: int) -> None:
        """The run has ``total`` trials, of which ``kept`` were played by an earlier command."""

    def played(self, met: bool, faulty: bool) -> None:
        """A trial was played."""

    def beat(self) -> None:
        """Some time passed."""

    def note(self, text: str) -> None:
        """Something that the user should read."""


class Interrupted(HthorError):
    """The user stopped the run; what was played is kept."""

    exit_code = 130


def evaluate(
    plan: Setup,
    sessions: Sequence[Session],
    make: Make,
    *,
    folder: Path,
    jobs: int | None = None,
    engine: Engine | None = None,
    watch: Watcher,
    extra: Mapping[str, bytes] | None = None,
    again: str = "",
) -> Result:
    """Play what a run still lacks, and score it.

    Args:
        plan: the configuration. sessions: its trials, or those of its shard.
        make: picklable; called in each worker, gives what plays a session.
        folder: the run's folder; made when absent, finished when it holds a part of this run.
        jobs: number of worker processes, when no ``engine`` is given.
        engine: where sessions are played; on this machine when not given.
        extra: other files to leave in the folder, by name, such as a suite that was made for this run.
        again: the command that plays one of its trials once more, but for the trial's key.

    Raises:
        RunLocked: when another process writes this run.
        RunError: when the folder holds another run or is damaged, or a worker died again and again.
        Interrupted: on Ctrl-C or SIGTERM.
    """
    began = time.monotonic()
    setup.examine(folder, plan)
    with Log(folder) as book:
        setup.write(folder, plan)
        for name, data in (extra or {}).items():
            jsonio.write(folder / name, data)
        keys = [[record.key(trial) for trial in session.trials] for session in sessions]
        wanted = [key for some in keys for key in some]
        left = [session for session, some in zip(sessions, keys, strict=True) if any(key not in book for key in some)]
        watch.begin(len(wanted), sum(key in book for key in wanted))
        if book.torn:
            watch.note(f"cut {book.torn} bytes of a trial that was being written when the last command ended")
        where, keeper = engine or engines.find(engines.LOCAL, jobs=jobs), Keeper(folder, again)
        cost = _play(book, where, left, make, watch, keeper, steady=not plan.realtime) if left else None
        missing = [key for key in wanted if key not in book]
        if missing:
            raise RunError(f"{folder}: {len(missing)} trials were not played, {missing[0]} is one. Run it again.")
    if cost is None:
        return _finish(folder, plan, None)
    cpu_s, trials = cost
    wall_s = time.monotonic() - began
    return _finish(folder, plan, Effort(wall_s=round(wall_s, 3), cpu_s=round(cpu_s, 3), trials=trials))


def _play(
    book: Log,
    engine: Engine,
    sessions: Sequence[Session],
    make: Make,
    watch: Watcher,
    keeper: Keeper,
    *,
    steady: bool,
) -> tuple[float, int]:
    """Play sessions and write down what is new; CPU time [s] and the number of new trials."""
    cpu_s, new, other = 0.0, 0, 0
    with stoppable() as stop, closing(engine.perform(sessions, make)) as stream:
        try:
            for news in stream:
                if isinstance(news, Played):
                    if book.append(news.key, news.line):
                        new += 1
                        watch.played(news.met, news.faulty)
                        if news.left is not None:
                            keeper.keep(news.left)
                    else:
                        other += not book.agrees(news.key, news.line)
                elif isinstance(news, Finished):
                    cpu_s += news.cpu_s
                book.sync(due=True)
                watch.beat()
                if stop.is_set():
                    raise Interrupted(f"interrupted after {len(book)} trials; resume with the same command.")
        except SessionFailed as failure:
            if failure.detail:
                jsonio.write(book.path.with_name("error.txt"), failure.detail.encode())
                raise InternalFailure(f"{failure}. The traceback is in {book.path.with_name('error.txt')}.") from None
            raise
    if other and steady:
        watch.note(f"{other} trials went otherwise when they were played again: something here does not repeat itself")
    return cpu_s, new


class InternalFailure(HthorError):
    """A trial failed by our own fault."""

    exit_code = 1


def _finish(folder: Path, plan: Setup, effort: Effort | None) -> Result:
    """Score what is there, and store that: a whole run's result, or what a shard took."""
    there, records = score.digest(folder, plan)
    if plan.shard:
        if effort is not None:
            jsonio.write(folder / EFFORT, jsonio.pretty(effort))
        return score.summarise(plan, log.fetch(there), records, effort)
    stored = score.load(folder)
    result = score.summarise(
        plan,
        log.fetch(there),
        records,
        effort or (stored.effort if stored else None),
        uplift=control.beside(folder, plan, records),
        isolation=guarded.load(folder),
    )
    if result != stored:
        score.store(folder, result)
    return result


@contextmanager
def stoppable() -> Iterator[threading.Event]:
    """Turn the first Ctrl-C or SIGTERM into a flag; a second one ends at once."""
    flag = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield flag
        return

    def stop(_number: int, _frame: FrameType | None) -> None:
        if flag.is_set():
            raise KeyboardInterrupt
        flag.set()

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield flag
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
