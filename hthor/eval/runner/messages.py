"""Messages of workers and engines about sessions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from msgspec import Struct

if TYPE_CHECKING:
    from hthor.eval.records.trial_record import TrialRecord
    from hthor.eval.runner.fault_report import FaultReport
    from hthor.trials.sessions import Session


class TrialOutcome(Struct, frozen=True, kw_only=True):
    """A trial that was run: its record, and a fault report for the authors of agents that failed in it."""

    record: TrialRecord
    fault_report: FaultReport | None = None


class TrialDone(Struct, frozen=True, kw_only=True):
    """A trial is over.

    Attributes:
        line: its record as a line of the log.
        met: whether the goal was met.
        faulty: whether an agent failed in it; ``fault_report`` says how, if that is known.
        killed: whether an agent's process was killed, apparently from outside; its session may be restarted.
    """

    key: str
    session: int
    line: bytes
    met: bool
    faulty: bool
    fault_report: FaultReport | None = None
    killed: bool = False


class Finished(Struct, frozen=True, kw_only=True):
    """A session is over; ``cpu_s`` is the CPU time [s] that it took, with its agents' processes."""

    cpu_s: float


class SessionRestarted(Struct, frozen=True, kw_only=True):
    """A session is run again from its first trial, because its worker was lost."""

    session: int
    cause: str


class SessionAbandoned(Struct, frozen=True, kw_only=True):
    """A session was given up; the others go on.

    Attributes:
        detail: the traceback of a bug, otherwise empty.
        killed: whether an agent's process was killed, apparently from outside, before the agent was known.
    """

    session: int
    cause: str
    detail: str = ""
    killed: bool = False


class Failed(Struct, frozen=True, kw_only=True):
    """No session can be run until the user has fixed something: ``message`` says what."""

    exit_code: int
    message: str


SessionRunner = Callable[["Session"], "Iterator[TrialOutcome]"]
"""Runs a session, trial by trial."""
RunnerFactory = Callable[[], SessionRunner]
"""Makes a session runner; must be picklable, and is called once in each worker."""
News = TrialDone | Finished | SessionRestarted | SessionAbandoned | Failed
