"""One run from its configuration to its result: claim the folder, run the missing trials, score; prints nothing."""

import threading
import time
from collections.abc import Callable, Mapping, Sequence

import msgspec

from hthor import jsonio
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records import platform, trial_log, trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_log import TrialLog
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import aggregate, result_file
from hthor.eval.results.result_file import Effort, RunResult
from hthor.eval.runner import engines
from hthor.eval.runner.collector import CollectedTrials, Collector, unfinished_error
from hthor.eval.runner.engines import Engine, Interrupted, stoppable
from hthor.eval.runner.fault_report import FaultArchive
from hthor.eval.runner.messages import RunnerFactory
from hthor.eval.runner.progress import Watcher
from hthor.trials.sessions import Session
from hthor.types.specs import LOCKSTEP


def run_evaluation(
    config: RunConfig,
    sessions: Sequence[Session],
    make: RunnerFactory,
    *,
    folder: RunFolder,
    watcher: Watcher,
    jobs: int | None = None,
    engine: Engine | None = None,
    extra: Mapping[str, bytes] | None = None,
    rerun_command: str = "",
    check: Callable[[RunConfig, Sequence[TrialRecord]], None] | None = None,
) -> RunResult:
    """Run the trials that a run still lacks, and score it.

    Args:
        sessions: the run's trials, or those of its shard.
        make: makes a session runner; picklable, called in each worker.
        folder: made when absent, completed when it holds a part of this run.
        jobs: number of worker processes, when no ``engine`` is given.
        engine: where sessions are run; this machine by default.
        extra: other files to write into the folder, by name, such as a suite that was generated for this run.
        rerun_command: the command that runs one of its trials once more, without the trial's key.
        check: looks at the trials of earlier commands, and raises when no trial may be added to them.

    Raises:
        RunLocked: when another process writes this run.
        RunError: when the folder holds another run or is damaged.
        Unfinished, InternalFailure: when sessions had to be given up. All others are finished first.
        Interrupted: on Ctrl-C or SIGTERM.
    """
    with stoppable() as stop:
        engine = engine or engines.find_engine(engines.LOCAL, jobs=jobs)
        started = time.monotonic()
        folder.check_free(config)
        with folder.open_log() as log:
            config = folder.write_config(config)
            for name, data in (extra or {}).items():
                folder.write(name, data)
            if check is not None and len(log):
                check(config, folder.played())
            faults = FaultArchive(folder.path, rerun_command)
            collector = Collector(folder, log, engine, watcher, faults, stop)
            collected = _run_missing(config, sessions, make, folder, log, collector, watcher, stop)
        effort = None
        if collected is not None:
            effort = Effort(
                wall_s=round(time.monotonic() - started, 3),
                cpu_s=round(collected.cpu_s, 3),
                trials=collected.new,
                replays=collected.restarts,
            )
        result = _score(folder, effort)
        if stop.is_set():
            raise Interrupted("interrupted; resume with the same command.")
        return result


def _run_missing(
    config: RunConfig,
    sessions: Sequence[Session],
    make: RunnerFactory,
    folder: RunFolder,
    log: TrialLog,
    collector: Collector,
    watcher: Watcher,
    stop: threading.Event,
) -> CollectedTrials | None:
    """Run the sessions that lack trials; None when no session does. Trials that were voided are repeated.

    A trial that a correction voided is repeated only if the correction says so: simulated people would do the same.
    """
    sessions = [msgspec.structs.replace(session, trials=tuple(map(log.due, session.trials))) for session in sessions]
    keys = {session.number: [trial_record.key(trial) for trial in session.trials] for session in sessions}
    expected = [key for some in keys.values() for key in some]
    left = [session for session in sessions if any(key not in log for key in keys[session.number])]
    watcher.begin(len(expected), sum(key in log for key in expected))
    if log.torn:
        watcher.note(f"cut {log.torn} bytes of a trial that was being written when the last command ended")
    collected = None
    if left:
        platform.join(folder.path, (), (platform.this_platform(),))
        collected = collector.collect(left, make, repeatable=config.mode == LOCKSTEP)
    if stop.is_set():
        raise Interrupted(f"interrupted after {log.counted} trials; resume with the same command.")
    missing = [key for key in expected if key not in log]
    if missing:
        raise unfinished_error(folder, collected.lost if collected else [], len(missing), len(expected))
    return collected


def _score(folder: RunFolder, effort: Effort | None) -> RunResult:
    """Score the run and store the result of a whole run, or the effort of a shard."""
    places, records = folder.digest()
    lines = trial_log.fetch(places)
    if folder.config.shard:
        if effort is not None:
            jsonio.write(folder.effort_file, jsonio.pretty(effort))
        return aggregate.score_shard(folder, lines, records, effort)
    stored = result_file.load_result(folder.path)
    result = aggregate.score_run(folder, lines, records, effort or (stored.effort if stored else None))
    if result != stored:
        result_file.store_result(folder.path, result)
    return result
