"""What controls a session from outside: the experimenter, and the time."""

from __future__ import annotations

import threading
from collections.abc import Callable

from hthor import rules
from hthor.errors import HthorError
from hthor.types import SUBTICKS

STEP_S = rules.TICK_S / SUBTICKS
"""[s] of a step."""
_BEHIND_S = 0.25
"""[s] A trial that is later than this gives up the time, so that it does not hurry afterwards. Our choice."""


class SessionStopped(HthorError):
    """The session ends now, in the middle of a trial."""

    exit_code = 130

    def __init__(self) -> None:
        super().__init__(
            "the session was ended before its end; the same command goes on with the trial that was not finished."
        )


class SessionControl:
    """What the experimenter may do to a session, from any thread.

    Attributes:
        paused: why the trial is paused; empty while it goes on.
        void: why the trial that is going on is to be voided; empty if it is not.
        draining: whether the session ends with the trial that is going on, which then waits for nobody.
        experimenter_starts: whether each trial waits for the experimenter. started: whether they have started the
            trial that is announced.
    """

    def __init__(self, *, experimenter_starts: bool = False) -> None:
        self.experimenter_starts = experimenter_starts
        self.started = False
        self.paused = self.void = ""
        self.draining = False
        self._stopped = threading.Event()

    def stop(self) -> None:
        """End the session now."""
        self._stopped.set()

    @property
    def stopped(self) -> bool:
        """Whether the session is to end."""
        return self._stopped.is_set()

    def wait(self, seconds: float) -> None:
        """Wait so long; raises SessionStopped when the session is to end."""
        if self._stopped.wait(seconds):
            raise SessionStopped


class Pacer:
    """Lets every step of a trial take its time; `figures` says how well that worked."""

    def __init__(self, now: Callable[[], float], sleep: Callable[[float], None]) -> None:
        self._now, self._sleep = now, sleep
        self._steps = self._late = 0
        self._worst = self._lost = 0.0
        self.restart()

    def restart(self) -> None:
        """Begin to count time now, after a pause."""
        self._due = self._now()

    def wait(self) -> None:
        """Wait until the time of this step is over."""
        self._steps += 1
        self._due += STEP_S
        left = self._due - self._now()
        if left > 0.0:
            self._sleep(left)
            return
        self._late += left < -STEP_S
        self._worst = max(self._worst, -left)
        if -left > _BEHIND_S:
            self._lost -= left
            self._due -= left

    @property
    def factor(self) -> float:
        """Trial time by wall-clock time so far."""
        spent = self._steps * STEP_S
        return round(spent / (spent + self._lost), 4) if self._steps else 1.0

    def figures(self) -> dict[str, float]:
        """How well a trial kept the time.

        Returns:
            "late": steps that ended more than a step too late; "worst_s" [s]: the longest delay; "lost_s" [s]: the time
            that was given up; "factor": trial time by wall-clock time.
        """
        return {
            "late": self._late,
            "worst_s": round(self._worst, 3),
            "lost_s": round(self._lost, 3),
            "factor": self.factor,
        }
