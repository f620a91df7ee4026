"""Engines run sessions on one machine or many: one file per engine; this file has their common parts.

An engine reports every trial at least once. A trial depends only on its specification, so one that is run again gives
the same record, and the listener keeps it once. Engines read and write no files.
"""

from __future__ import annotations

import importlib
import signal
import threading
import time
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Protocol

from hthor import rules
from hthor.errors import HthorError, UnknownName
from hthor.eval.runner.messages import Failed, News, RunnerFactory, SessionAbandoned, SessionRestarted

if TYPE_CHECKING:
    from hthor.trials.sessions import Session
    from hthor.types import TaskSpec

LOCAL = "local"
ATTEMPTS = 3
"""How many workers a session may end before it is given up. Our choice."""
LIMIT_S = 600.0
"""How long [s] a worker may take for a trial: a hundred times the usual time, as the first also builds a world."""
_GUEST_S, _GUEST_STEP_S, _SLACK_S = 300.0, 5.0, 1.0
"""Time of a submitted agent [s]: for its start, for each step (its default deadline), and a margin for each step."""
_LEAP_S = 1.0
"""If a clock is not read for longer than this [s], the process is assumed to have been stopped."""


class Engine(Protocol):
    """Runs sessions. A file in `hthor.eval.runner.engines` defines a class ``Engine`` with these methods."""

    def __init__(self, *, jobs: int | None, address: str, gpus: float, limit_s: float) -> None:
        """Prepare the engine.

        Args:
            jobs: how many workers; None for as many as there is room for.
            address: where the engine is, such as a cluster; empty for the default.
            gpus: how much of a GPU each worker needs.
            limit_s: a worker that takes longer for a trial [s] is ended.
        """

    def run_sessions(self, sessions: Sequence[Session], make: RunnerFactory) -> Generator[News | None, None, None]:
        """Run sessions and report what happens, with None from time to time. Closing the generator ends the workers.

        A session that ends `ATTEMPTS` workers is `SessionAbandoned`, and the others go on.

        Raises:
            SessionFailed: when the user has to fix something first.
        """

    def drain(self) -> None:
        """Start no more trials; those that are running are finished."""


class SessionFailed(HthorError):
    """No session could be run; the message is for the user."""

    def __init__(self, failed: Failed) -> None:
        self.exit_code = failed.exit_code
        super().__init__(failed.message)


class Interrupted(HthorError):
    """The user stopped the run; finished trials are kept."""

    exit_code = 130


@contextmanager
def stoppable() -> Iterator[threading.Event]:
    """Turn the first Ctrl-C or SIGTERM into a flag; a second one ends at once, and raises Interrupted."""
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
    except KeyboardInterrupt:
        raise Interrupted("interrupted at once; resume with the same command.") from None
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def engine_names() -> list[str]:
    """The names of all engines, the default first."""
    stems = (path.stem for path in Path(__file__).parent.glob("*.py") if not path.stem.startswith("_"))
    return sorted(stems, key=lambda name: (name != LOCAL, name))


def find_engine(
    name: str, *, jobs: int | None = None, address: str = "", gpus: float = 0.0, limit_s: float = LIMIT_S
) -> Engine:
    """The engine of this name, ready to run sessions.

    Raises:
        UnknownName: when no engine has this name.
        HthorError: when the engine cannot be used here.
    """
    if name not in engine_names():
        raise UnknownName("engine", name, engine_names())
    module = importlib.import_module(f"hthor.eval.runner.engines.{name}")
    engine: Engine = module.Engine(jobs=jobs, address=address, gpus=gpus, limit_s=limit_s)
    return engine


def trial_limit_s(tasks: Sequence[TaskSpec], guests: int, step_limit_s: float | None = None) -> float:
    """How long [s] a worker may take for a trial with so many submitted agents.

    It is longer than the agents' own deadlines, so that a slow agent is not taken for a stuck worker.

    Args:
        step_limit_s: the deadline of an action [s], None for the default.
    """
    ticks = max((task.longest for task in tasks), default=0.0) / rules.TICK_S
    return LIMIT_S + guests * (_GUEST_S + (max(_GUEST_STEP_S, step_limit_s or 0.0) + _SLACK_S) * ticks)


class Queue:
    """Sessions that wait for a worker, with the number of the attempt."""

    def __init__(self, sessions: Sequence[Session]) -> None:
        self._waiting = deque((session, 1) for session in sessions)

    def __len__(self) -> int:
        return len(self._waiting)

    def take(self) -> tuple[Session, int]:
        """The next session and its attempt, counted from 1."""
        return self._waiting.popleft()

    def again(self, session: Session, attempt: int, cause: str) -> SessionRestarted | SessionAbandoned:
        """A worker was lost while it ran this session: run it again next, or give it up after `ATTEMPTS`."""
        if attempt >= ATTEMPTS:
            return SessionAbandoned(session=session.number, cause=f"it ended {ATTEMPTS} workers, the last by {cause}")
        self._waiting.appendleft((session, attempt + 1))
        return SessionRestarted(session=session.number, cause=f"its worker was ended by {cause}")

    def clear(self) -> None:
        """Give out no more sessions."""
        self._waiting.clear()


class PausableClock:
    """Time [s] for callers that read it often; it stands still while this process is stopped or waits for a disk."""

    def __init__(self) -> None:
        self._last = time.monotonic()
        self._now = 0.0

    def now(self) -> float:
        last, self._last = self._last, time.monotonic()
        self._now += min(self._last - last, _LEAP_S)
        return self._now
