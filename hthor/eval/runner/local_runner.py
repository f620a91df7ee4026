"""Plays sessions in processes of this machine, for callers that offer no choice of engine."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import closing
from typing import TYPE_CHECKING

from hthor.errors import HthorError
from hthor.eval.runner.engines import RunnerFactory, SessionFailed
from hthor.eval.runner.engines.local import Engine
from hthor.eval.runner.messages import News, SessionAbandoned

if TYPE_CHECKING:
    from hthor.eval.config.sessions import Session


class SessionLost(HthorError):
    """A session could not be played. ``detail`` is the traceback of a bug, empty when there is none."""

    def __init__(self, lost: SessionAbandoned) -> None:
        self.exit_code, self.detail = 1 if lost.detail else HthorError.exit_code, lost.detail
        super().__init__(lost.cause if lost.detail else f"the session of participant {lost.participant}: {lost.cause}")


def run_sessions(sessions: Sequence[Session], make: RunnerFactory, *, jobs: int) -> Generator[News | None, None, None]:
    """Play sessions in ``jobs`` worker processes; see `hthor.eval.runner.engines.Engine`.

    Raises:
        SessionLost: when one is lost, as none of these can be done without.
    """
    with closing(Engine(jobs=jobs).perform(sessions, make)) as stream:
        for news in stream:
            if isinstance(news, SessionAbandoned):
                raise SessionLost(news)
            yield news


__all__ = ["SessionFailed", "SessionLost", "run_sessions"]
