"""Collecting an engine's messages: new trials go to the log, lost sessions are reported."""

import threading
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, field

from hthor.errors import HthorError, RunError
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.session_restarts import SessionRestarts
from hthor.eval.records.trial_log import TrialLog
from hthor.eval.runner.engines import Engine
from hthor.eval.runner.fault_report import FaultArchive
from hthor.eval.runner.messages import Finished, News, RunnerFactory, SessionAbandoned, SessionRestarted, TrialDone
from hthor.eval.runner.progress import Watcher
from hthor.trials.sessions import Session

ERRORS = "error.txt"
_HOPELESS = 3
"""A run ends when so many sessions were given up before a single trial was finished. Our choice."""


class Unfinished(RunError):
    """Some sessions could not be run; all finished trials are kept."""

    exit_code = 1


class InternalFailure(HthorError):
    """A trial failed because of a bug in hthor."""

    exit_code = 1


@dataclass
class CollectedTrials:
    """The result of running sessions.

    Attributes:
        cpu_s: CPU time [s].
        new: trials that were added to the log.
        different: trials that were run again and differ from the log.
        received: trials that workers reported.
        restarts: sessions that were run again.
        lost: sessions that were given up.
        void: sessions that are to be run again; what their workers still report does not count.
    """

    cpu_s: float = 0.0
    new: int = 0
    different: int = 0
    received: int = 0
    restarts: int = 0
    lost: list[SessionAbandoned] = field(default_factory=list)
    void: set[int] = field(default_factory=set)


class Collector:
    """Runs sessions on an engine, and writes new trials to the open log and fault reports next to it.

    ``stop`` is set when the user wants the run to end.
    """

    def __init__(
        self,
        folder: RunFolder,
        log: TrialLog,
        engine: Engine,
        watcher: Watcher,
        faults: FaultArchive,
        stop: threading.Event,
    ) -> None:
        self._log, self._engine, self._watcher, self._faults, self._stop = log, engine, watcher, faults, stop
        self._restarts = SessionRestarts(folder.path)
        self._collected = CollectedTrials()

    def collect(self, sessions: Sequence[Session], make: RunnerFactory, *, repeatable: bool = True) -> CollectedTrials:
        """Run these sessions; rerun those in which an agent's process was killed, while the run has restarts left.

        ``repeatable`` says whether a trial that is run again must give the same record.
        """
        collected = self._collected
        self._listen(sessions, make)
        if (left := [one for one in sessions if one.number in collected.void]) and not self._stop.is_set():
            collected.void.clear()
            self._listen(left, make)
        if collected.different and repeatable:
            what = f"{collected.different} re-run trials differ from the log"
            self._watcher.note(f"{what}: something on this machine is not deterministic")
        return collected

    def _listen(self, sessions: Sequence[Session], make: RunnerFactory) -> None:
        draining = False
        with closing(self._engine.run_sessions(sessions, make)) as messages:
            for message in messages:
                self._receive(message)
                self._log.sync(due=True)
                self._watcher.beat()
                if not self._collected.received and len(self._collected.lost) >= _HOPELESS:
                    break
                if self._stop.is_set() and not draining:
                    draining = True
                    self._engine.drain()
                    self._watcher.note(
                        "stopping when the trials that are being played are over; Ctrl-C again stops at once"
                    )

    def _receive(self, message: News | None) -> None:
        collected = self._collected
        if isinstance(message, TrialDone):
            collected.received += 1
            if not self._is_void(message, known=message.key in self._log):
                self._keep(message)
        elif isinstance(message, Finished):
            collected.cpu_s += message.cpu_s
        elif isinstance(message, SessionRestarted):
            collected.restarts += 1
            self._watcher.note(f"session {message.session} begins again: {message.cause}")
        elif isinstance(message, SessionAbandoned) and not self._is_void(message):
            collected.lost.append(message)
            self._watcher.note(f"session {message.session} is given up: {message.cause}")

    def _keep(self, trial: TrialDone) -> None:
        counted = self._log.counted
        if not self._log.append(trial.key, trial.line):
            self._collected.different += not self._log.agrees(trial.key, trial.line)
            return
        self._collected.new += 1
        if self._log.counted > counted:  # else it was voided, and is repeated
            self._watcher.played(trial.met, trial.faulty)
        if trial.fault_report is not None:
            self._faults.keep(trial.fault_report)

    def _is_void(self, message: TrialDone | SessionAbandoned, *, known: bool = False) -> bool:
        """Whether a message does not count, because its session is to be run again after a killed agent."""
        if message.session not in self._collected.void:
            if known or not message.killed or not self._restarts.take(message.session):
                return False
            self._collected.void.add(message.session)
            self._collected.restarts += 1
            self._watcher.note(f"session {message.session} begins again: an agent's process was killed")
        return True


def unfinished_error(
    folder: RunFolder, lost: Sequence[SessionAbandoned], missing: int, expected: int
) -> Unfinished | InternalFailure:
    """The error for sessions that were given up; their tracebacks go to a file."""
    causes = "; ".join(f"session {one.session}: {one.cause.rstrip('.')}" for one in lost[:_HOPELESS])
    more = f"; and {len(lost) - _HOPELESS} more" if len(lost) > _HOPELESS else ""
    tail = f"{missing} of {expected} trials are missing, all others are kept."
    if details := [f"session {one.session}\n{one.detail}" for one in lost if one.detail]:
        folder.write(ERRORS, "\n".join(details).encode())
        return InternalFailure(f"{causes}{more}. {tail} The traceback is in {folder.path / ERRORS}.")
    return Unfinished(
        f"{causes}{more}. {tail} The same command tries them again; if memory ran out, with fewer --jobs, and if a "
        "trial needs longer, with a higher --trial-limit."
    )
