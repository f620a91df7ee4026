"""One run from its configuration to its result: claim the folder, play what is missing, score; prints nothing."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Protocol

from hthor import jsonio
from hthor.eval.config import run_config
from hthor.eval.config.run_config import RunConfig
from hthor.eval.config.sessions import Session
from hthor.eval.records import platform, reader, run_isolation, session_restarts, trial_log, trial_record
from hthor.eval.records.trial_log import TrialLog
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import aggregate, baseline, result_file
from hthor.eval.results.result_file import Effort, RunResult
from hthor.eval.runner import collector, engines
from hthor.eval.runner.engines import Engine, RunnerFactory
from hthor.eval.runner.fault_report import FaultArchive
from hthor.eval.runner.interrupt import Interrupted, stoppable

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


def run_evaluation(
    plan: RunConfig,
    sessions: Sequence[Session],
    make: RunnerFactory,
    *,
    folder: Path,
    jobs: int | None = None,
    engine: Engine | None = None,
    watch: Watcher,
    extra: Mapping[str, bytes] | None = None,
    again: str = "",
    check: Callable[[RunConfig, Sequence[TrialRecord]], None] | None = None,
) -> RunResult:
    """Play what a run still lacks, and score it.

    Args:
        plan: the configuration. sessions: its trials, or those of its shard.
        make: picklable; called in each worker, gives what plays a session.
        folder: the run's folder; made when absent, finished when it holds a part of this run.
        jobs: number of worker processes, when no ``engine`` is given.
        engine: where sessions are played; on this machine when not given.
        extra: other files to leave in the folder, by name, such as a suite that was made for this run.
        again: the command that plays one of its trials once more, but for the trial's key.
        check: looks at what was played before, and raises when no more may be added to it.

    Raises:
        RunLocked: when another process writes this run.
        RunError: when the folder holds another run or is damaged.
        Unfinished, InternalFailure: when sessions had to be given up. All others are played first.
        Interrupted: on Ctrl-C or SIGTERM.
    """
    with stoppable() as stop:
        where = engine or engines.find_engine(engines.LOCAL, jobs=jobs)
        result = _evaluate(plan, sessions, make, folder, where, watch, extra, again, check, stop)
        if stop.is_set():
            raise Interrupted("interrupted; resume with the same command.")
        return result


def _evaluate(
    plan: RunConfig,
    sessions: Sequence[Session],
    make: RunnerFactory,
    folder: Path,
    engine: Engine,
    watch: Watcher,
    extra: Mapping[str, bytes] | None,
    again: str,
    check: Callable[[RunConfig, Sequence[TrialRecord]], None] | None,
    stop: threading.Event,
) -> RunResult:
    began = time.monotonic()
    run_config.check_folder(folder, plan)
    plan = run_config.with_stored_title(folder, plan)
    with TrialLog(folder) as book:
        run_config.write_config(folder, plan)
        for name, data in (extra or {}).items():
            jsonio.write(folder / name, data)
        keys = [[trial_record.key(trial) for trial in session.trials] for session in sessions]
        wanted = [key for some in keys for key in some]
        left = [session for session, some in zip(sessions, keys, strict=True) if any(key not in book for key in some)]
        if check is not None and len(book):
            check(plan, reader.digest(folder, plan)[1])
        watch.begin(len(wanted), sum(key in book for key in wanted))
        if book.torn:
            watch.note(f"cut {book.torn} bytes of a trial that was being written when the last command ended")
        keeper = FaultArchive(folder, again)
        if left:
            platform.note(folder)
        came = (
            collector.collect(book, engine, left, make, watch, keeper, stop, steady=not plan.realtime) if left else None
        )
        if stop.is_set():
            raise Interrupted(f"interrupted after {len(book)} trials; resume with the same command.")
        missing = [key for key in wanted if key not in book]
        if missing:
            raise collector.unfinished_error(folder, came.lost if came else [], len(missing), len(wanted))
    if came is None:
        return _finish(folder, plan, None)
    effort = Effort(
        wall_s=round(time.monotonic() - began, 3),
        cpu_s=round(came.cpu_s, 3),
        trials=came.new,
        replays=came.replays,
    )
    return _finish(folder, plan, effort)


def _finish(folder: Path, plan: RunConfig, effort: Effort | None) -> RunResult:
    """Score what is there, and store that: a whole run's result, or what a shard took."""
    there, records = reader.digest(folder, plan)
    if plan.shard:
        if effort is not None:
            jsonio.write(folder / EFFORT, jsonio.pretty(effort))
        return aggregate.make_result(plan, trial_log.fetch(there), records, effort)
    stored = result_file.load_result(folder)
    result = aggregate.make_result(
        plan,
        trial_log.fetch(there),
        records,
        effort or (stored.effort if stored else None),
        uplift=baseline.uplift_or_stored(folder, plan, records),
        isolation=run_isolation.load_isolation(folder),
        replays=session_restarts.count(folder),
    )
    if result != stored:
        result_file.store_result(folder, result)
    return result
