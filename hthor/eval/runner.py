"""Playing sessions on this machine, for those who have no choice of engine to offer; see `hthor.eval.engines`."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import TYPE_CHECKING

from hthor.eval.engines import Make, SessionFailed
from hthor.eval.engines.local import Engine
from hthor.eval.worker import News

if TYPE_CHECKING:
    from hthor.eval.session import Session


def perform(sessions: Sequence[Session], make: Make, *, jobs: int) -> Generator[News | None, None, None]:
    """Play sessions in ``jobs`` worker processes; see `hthor.eval.engines.Engine`."""
    return Engine(jobs=jobs).perform(sessions, make)


__all__ = ["Make", "SessionFailed", "perform"]
