"""The sessions that wait for a worker, and how long a worker may take for a trial."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Sequence
from typing import TYPE_CHECKING

from hthor import rules
from hthor.eval.runner.messages import SessionAbandoned, SessionRestarted

if TYPE_CHECKING:
    from hthor.eval.config.sessions import Session
    from hthor.types import TaskSpec

ATTEMPTS = 3
"""How many workers a session may end before it is given up. Our choice."""
LIMIT_S = 600.0
"""How long [s] a worker may take for a trial: a hundred times what one takes, as the first also builds a world."""
_GUEST_S, _GUEST_STEP_S, _SLACK_S = 300.0, 5.0, 1.0
"""What a submitted agent adds [s]: for its start, for each step (its default deadline), and a margin for each step."""
_LEAP_S = 1.0
"""A clock that was not read for longer than this [s] stood still meanwhile."""


def trial_limit_s(tasks: Sequence[TaskSpec], guests: int, step_limit_s: float | None = None) -> float:
    """How long [s] a worker may take for a trial with so many submitted agents.

    It is longer than the agents' own deadlines, so that a slow agent is not taken for a stuck worker.

    Args:
        step_limit_s: the deadline of an action [s], None for the default.
    """
    ticks = max((task.time_limit for task in tasks), default=0.0) / rules.TICK_S
    return LIMIT_S + guests * (_GUEST_S + (max(_GUEST_STEP_S, step_limit_s or 0.0) + _SLACK_S) * ticks)


class Queue:
    """Sessions that wait for a worker, with the number of this attempt."""

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
            return SessionAbandoned(
                participant=session.participant, cause=f"it ended {ATTEMPTS} workers, the last by {cause}"
            )
        self._waiting.appendleft((session, attempt + 1))
        return SessionRestarted(participant=session.participant, cause=f"its worker was ended by {cause}")

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
