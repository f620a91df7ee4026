"""Where sessions are played: one file an engine; what they share stands here.

An engine gets sessions, and tells of every trial at least once: trials depend on nothing but their specification, so
one that is played again is the same again, and whoever listens writes it down once. Engines know nothing of files.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Generator, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from hthor.errors import HthorError, UnknownName
from hthor.eval.runner.messages import Failed, News
from hthor.eval.runner.queue import LIMIT_S

if TYPE_CHECKING:
    from hthor.eval.config.sessions import Session
    from hthor.eval.records.trial_record import TrialRecord

LOCAL = "local"

RunnerFactory = Callable[[], "Callable[[Session], Iterator[TrialRecord]]"]
"""Picklable; called once in each worker, gives what plays a session."""


class Engine(Protocol):
    """What plays sessions. A file of `hthor.eval.runner.engines` defines a class ``Engine`` that can do this."""

    def __init__(self, *, jobs: int | None, address: str, gpus: float, limit_s: float) -> None:
        """``jobs`` workers, None for as many as there is room for.

        ``gpus`` is what one of them needs; one that plays a trial for more than ``limit_s`` [s] is ended.
        """

    def perform(self, sessions: Sequence[Session], make: RunnerFactory) -> Generator[News | None, None, None]:
        """Play sessions and tell what happens; None when nothing does. Closing the generator ends the workers.

        A session that costs `hthor.eval.runner.queue.ATTEMPTS` workers is `SessionAbandoned`, and the others go on.

        Raises:
            SessionFailed: when there is something that the user has to mend first.
        """

    def drain(self) -> None:
        """Begin no more trials; those that are being played come to their end."""


class SessionFailed(HthorError):
    """No session could be played; the message is for the user."""

    def __init__(self, failed: Failed) -> None:
        self.exit_code = failed.exit_code
        super().__init__(failed.message)


def engine_names() -> list[str]:
    """The engines that there are, the usual one first."""
    found = (path.stem for path in Path(__file__).parent.glob("*.py") if not path.stem.startswith("_"))
    return sorted(found, key=lambda name: (name != LOCAL, name))


def find_engine(
    name: str, *, jobs: int | None = None, address: str = "", gpus: float = 0.0, limit_s: float = LIMIT_S
) -> Engine:
    """The engine of this name, ready to be told what to play.

    Raises:
        UnknownName: when there is none.
        HthorError: when it cannot be used here.
    """
    if name not in engine_names():
        raise UnknownName("engine", name, engine_names())
    module = importlib.import_module(f"hthor.eval.runner.engines.{name}")
    engine: Engine = module.Engine(jobs=jobs, address=address, gpus=gpus, limit_s=limit_s)
    return engine
