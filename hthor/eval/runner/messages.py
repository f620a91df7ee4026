"""What engines and workers tell of sessions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

if TYPE_CHECKING:
    from hthor.eval.runner.fault_report import FaultReport


class TrialDone(Struct, frozen=True, kw_only=True):
    """A trial is over. ``line`` is its whole record, ``left`` what is left of agents that failed in it.

    ``killed`` says that an agent's process was ended as if from outside; its session may be played again.
    """

    key: str
    participant: int
    line: bytes
    met: bool
    faulty: bool
    left: FaultReport | None = None
    killed: bool = False


class Finished(Struct, frozen=True, kw_only=True):
    """A session is over; ``cpu_s`` [s] is what it cost, with its agents' processes."""

    cpu_s: float


class SessionRestarted(Struct, frozen=True, kw_only=True):
    """A session begins again, as its worker was lost."""

    participant: int
    cause: str


class SessionAbandoned(Struct, frozen=True, kw_only=True):
    """A session was given up; the others go on. ``detail`` is the traceback of a bug, empty when there is none.

    ``killed`` says that an agent's process was ended as if from outside before it could say what it is.
    """

    participant: int
    cause: str
    detail: str = ""
    killed: bool = False


class Failed(Struct, frozen=True, kw_only=True):
    """No session can be played, for a reason that is the user's to mend: ``exit_code`` and ``message``."""

    exit_code: int
    message: str


News = TrialDone | Finished | SessionRestarted | SessionAbandoned | Failed
