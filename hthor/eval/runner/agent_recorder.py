"""A robot's mind that is watched while it acts: what it was given last and what it did; changes nothing of it."""

from __future__ import annotations

from collections import deque
from typing import Any

from hthor.types import Action, Briefing, Mind, Observation

LAST = 20
"""How many of the last times that a mind was asked are kept."""


class RecordedAgent:
    """A mind, and the observations that it was given in the trial with the actions that came of them.

    Args:
        mind: who is watched. last: how many are kept; None for all.

    Attributes:
        looks: the last pairs; the action of the last one is None when the mind failed.
    """

    def __init__(self, mind: Mind, last: int | None = LAST) -> None:
        self.mind: Any = mind
        self.looks: deque[tuple[Observation, Action | None]] = deque(maxlen=last)

    def begin(self, briefing: Briefing) -> None:
        self.looks.clear()
        self.mind.begin(briefing)

    def act(self, observation: Observation) -> Action:
        self.looks.append((observation, None))
        action: Action = self.mind.act(observation)
        self.looks[-1] = (observation, action)
        return action

    def finish(self) -> None:
        """Its trial is over."""
        if (finish := getattr(self.mind, "finish", None)) is not None:
            finish()

    def close(self) -> None:
        """Let the mind go."""
        self.mind.close()

    @property
    def output(self) -> str:
        """The end of what it printed."""
        return str(getattr(self.mind, "log", ""))
