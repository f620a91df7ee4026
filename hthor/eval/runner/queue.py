"""Sessions that wait for a worker, and how long a worker may be silent."""

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
"""How many workers a session may cost."""
BEAT_S = 0.05
"""After so long without news [s] an engine tells that there is none, so that its listener may look around."""
LIMIT_S = 600.0
"""How long [s] a worker may play a trial. It takes a hundredth of that, but a first one also builds a world."""
_GUEST_S, _GUEST_STEP_S, _SLACK_S = 300.0, 5.0, 1.0
_LEAP_S = 1.0


def trial_limit_s(tasks: Sequence[TaskSpec], guests: int, step_limit_s: float | None = None) -> float:
    """How long [s] a worker may play a trial at most, when so many of its agents are submitted ones.

    Those have deadlines of their own, which are to end first: a submitted agent that takes its time is no stuck worker.

    Args:
        step_limit_s: the deadline of an action [s], None for the usual one.
    """
    ticks = max((task.time_limit for task in tasks), default=0.0) / rules.TICK_S
    return LIMIT_S + guests * (_GUEST_S + (max(_GUEST_STEP_S, step_limit_s or 0.0) + _SLACK_S) * ticks)


class Queue:
    """Sessions that wait for a worker, and how many each has cost."""

    def __init__(self, sessions: Sequence[Session]) -> None:
        self._waiting = deque((session, 1) for session in sessions)

    def __len__(self) -> int:
        return len(self._waiting)

    def take(self) -> tuple[Session, int]:
        """The next session, and the number of this attempt."""
        return self._waiting.popleft()

    def again(self, session: Session, attempt: int, cause: str) -> SessionRestarted | SessionAbandoned:
        """A worker was lost with this session in hand; it comes next, unless it has cost too many."""
        if attempt >= ATTEMPTS:
            return SessionAbandoned(
                participant=session.participant, cause=f"it ended {ATTEMPTS} workers, the last by {cause}"
            )
        self._waiting.appendleft((session, attempt + 1))
        return SessionRestarted(participant=session.participant, cause=f"its worker was ended by {cause}")

    def clear(self) -> None:
        """Hand out no more."""
        self._waiting.clear()


class PausableClock:
    """Time [s] for those who look at it often. It stands still while this process does, stopped or kept by a disk."""

    def __init__(self) -> None:
        self._last = time.monotonic()
        self._now = 0.0

    def now(self) -> float:
        last, self._last = self._last, time.monotonic()
        self._now += min(self._last - last, _LEAP_S)
        return self._now
