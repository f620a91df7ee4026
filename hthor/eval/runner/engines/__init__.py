"""Engines run sessions on one machine or many: one file for each engine, and here what they share.

An engine reports every trial at least once. A trial depends only on its specification, so one that is run again gives
the same record, and the listener keeps it once. Engines read and write no files.
"""

from __future__ import annotations

import importlib
from collections.abc import Generator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from hthor.errors import HthorError, UnknownName
from hthor.eval.runner.messages import Failed, News, RunnerFactory
from hthor.eval.runner.queue import LIMIT_S

if TYPE_CHECKING:
    from hthor.eval.config.sessions import Session

LOCAL = "local"


class Engine(Protocol):
    """What runs sessions. A file in `hthor.eval.runner.engines` defines a class ``Engine`` with these methods."""

    def __init__(self, *, jobs: int | None, address: str, gpus: float, limit_s: float) -> None:
        """Prepare the engine.

        Args:
            jobs: how many workers; None for as many as there is room for.
            address: where the engine is, such as a cluster; empty for the default.
            gpus: how much of a GPU each worker needs.
            limit_s: a worker that takes longer for a trial [s] is ended.
        """

    def run_sessions(self, sessions: Sequence[Session], make: RunnerFactory) -> Generator[News | None, None, None]:
        """Run sessions and report what happens, None from time to time. Closing the generator ends the workers.

        A session that ends `hthor.eval.runner.queue.ATTEMPTS` workers is `SessionAbandoned`, and the others go on.

        Raises:
            SessionFailed: when the user has to mend something first.
        """

    def drain(self) -> None:
        """Start no more trials; those that are running are finished."""


class SessionFailed(HthorError):
    """No session could be run; the message is for the user."""

    def __init__(self, failed: Failed) -> None:
        self.exit_code = failed.exit_code
        super().__init__(failed.message)


def engine_names() -> list[str]:
    """The names of all engines, the default first."""
    stems = (path.stem for path in Path(__file__).parent.glob("*.py") if not path.stem.startswith("_"))
    return sorted(stems, key=lambda name: (name != LOCAL, name))


def find_engine(
    name: str, *, jobs: int | None = None, address: str = "", gpus: float = 0.0, limit_s: float = LIMIT_S
) -> Engine:
    """The engine of this name, ready to run sessions.

    Raises:
        UnknownName: when there is none.
        HthorError: when it cannot be used here.
    """
    if name not in engine_names():
        raise UnknownName("engine", name, engine_names())
    module = importlib.import_module(f"hthor.eval.runner.engines.{name}")
    engine: Engine = module.Engine(jobs=jobs, address=address, gpus=gpus, limit_s=limit_s)
    return engine
