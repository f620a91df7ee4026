"""Where sessions are played: one file an engine; what they share stands here.

An engine gets sessions, and tells of every trial at least once: trials depend on nothing but their specification, so
one that is played again is the same again, and whoever listens writes it down once. Engines know nothing of files.
"""

from __future__ import annotations

import importlib
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from hthor.errors import HthorError, RunError, UnknownName
from hthor.eval.worker import Failed, News

if TYPE_CHECKING:
    from hthor.eval.record import Record
    from hthor.eval.session import Session

LOCAL = "local"
ATTEMPTS = 3
"""How often a session may cost a worker its life."""
BEAT_S = 0.25
"""After so long without news [s] an engine tells that there is none, so that its listener may look around."""

Make = Callable[[], "Callable[[Session], Iterator[Record]]"]
"""Picklable; called once in each worker, gives what plays a session."""


class Engine(Protocol):
    """What plays sessions. A file of `hthor.eval.engines` defines a class ``Engine`` that can do this."""

    def __init__(self, *, jobs: int | None, address: str, gpus: float) -> None:
        """``jobs`` workers, None for as many as there is room for; ``gpus`` is what one of them needs."""

    def perform(self, sessions: Sequence[Session], make: Make) -> Generator[News | None, None, None]:
        """Play sessions and tell what happens; None when nothing does. Closing the generator ends the workers.

        Raises:
            SessionFailed: when playing raised an exception.
            RunError: when a session ended `ATTEMPTS` workers.
        """


class SessionFailed(HthorError):
    """A session could not be played. ``detail`` is a traceback when the fault is ours, empty when it is the user's."""

    def __init__(self, failed: Failed) -> None:
        self.exit_code, self.detail = failed.exit_code, failed.detail
        super().__init__(failed.message)


class Queue:
    """Sessions that wait for a worker, and how often each has ended one."""

    def __init__(self, sessions: Sequence[Session]) -> None:
        self._waiting = deque((session, 1) for session in sessions)

    def __len__(self) -> int:
        return len(self._waiting)

    def take(self) -> tuple[Session, int]:
        """The next session, and the number of this attempt."""
        return self._waiting.popleft()

    def again(self, session: Session, attempt: int, cause: str) -> None:
        """A worker died with this session in hand; it comes next.

        Raises:
            RunError: when it has ended too many.
        """
        if attempt >= ATTEMPTS:
            raise RunError(
                f"the session of participant {session.participant} ended {ATTEMPTS} workers, the last by {cause}. "
                "What was played before is kept. If memory ran out, repeat the command with fewer --jobs."
            )
        self._waiting.appendleft((session, attempt + 1))


def names() -> list[str]:
    """The engines that there are, the usual one first."""
    found = (path.stem for path in Path(__file__).parent.glob("*.py") if not path.stem.startswith("_"))
    return sorted(found, key=lambda name: (name != LOCAL, name))


def find(name: str, *, jobs: int | None = None, address: str = "", gpus: float = 0.0) -> Engine:
    """The engine of this name, ready to be told what to play.

    Raises:
        UnknownName: when there is none.
        HthorError: when it cannot be used here.
    """
    if name not in names():
        raise UnknownName("engine", name, names())
    engine: Engine = importlib.import_module(f"hthor.eval.engines.{name}").Engine(jobs=jobs, address=address, gpus=gpus)
    return engine
