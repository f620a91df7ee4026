"""Real-time trials: an agent's thinking time counts as time of the trial, so its actions come later.

The time is measured while the agent decides, without the time that its sensors take. It adds up: an agent that thinks
for a third of a tick each time is one tick late every third time, so that nothing is rounded away.
"""

import time
from collections.abc import Callable, Iterable
from typing import Any

import msgspec
from msgspec import Struct

from hthor import rules
from hthor.types import Action, Mind, Observation

_TOLERANCE = 1e-9
"""Tolerance [ticks], so that 0.1 + 0.1 + 0.1 s counts as 3 ticks."""


class Decision(Struct, frozen=True, kw_only=True):
    """An action that an agent decided on; ``moves`` says whether its body was free, so that the motion counts."""

    seat: str
    action: Action
    moves: bool


class Thinking:
    """Holds actions back until the agents' thinking time is over; until then, these agents are not asked again."""

    def __init__(self, clock: Callable[[], float] = time.perf_counter) -> None:
        self._clock = clock
        self._owed: dict[str, float] = {}
        self._held: dict[str, tuple[int, Decision]] = {}

    def busy(self, seat: str) -> bool:
        """Whether the seat's last action is still held back."""
        return seat in self._held

    def ask(self, seat: str, mind: Mind, observation: Observation) -> Action:
        """Ask the agent for an action, and measure how long it takes."""
        senses = Timed(observation.senses, self._clock)
        began = self._clock()
        action = mind.act(msgspec.structs.replace(observation, senses=senses))
        spent = self._clock() - began - senses.spent
        self._owed[seat] = self._owed.get(seat, 0.0) + max(0.0, spent)
        return action

    def late(self, seat: str) -> int:
        """How many whole ticks late the seat's action is; these ticks are then subtracted from its delay."""
        ticks = int(self._owed.get(seat, 0.0) / rules.TICK_S + _TOLERANCE)
        self._owed[seat] = self._owed.get(seat, 0.0) - ticks * rules.TICK_S
        return ticks

    def hold(self, decision: Decision, until: int) -> None:
        """Hold an action back until a tick."""
        self._held[decision.seat] = (until, decision)

    def due(self, tick: int, seats: Iterable[str]) -> list[Decision]:
        """The actions that are due at a tick, in the order of these seats."""
        held = [self._held[seat] for seat in seats if seat in self._held]
        due = [decision for until, decision in held if until <= tick]
        for decision in due:
            del self._held[decision.seat]
        return due


class Timed:
    """A body's sensors, with the time that reading them took: ``spent`` [s]."""

    def __init__(self, senses: Any, clock: Callable[[], float]) -> None:
        self._senses, self._clock, self.spent = senses, clock, 0.0

    def timed(self, name: str) -> Callable[..., Any]:
        """The sensor of this name, timed."""
        sensor = getattr(self._senses, name)

        def timed(*given: Any) -> Any:
            began = self._clock()
            try:
                return sensor(*given)
            finally:
                self.spent += self._clock() - began

        return timed

    def __getattr__(self, name: str) -> Callable[..., Any]:
        return self.timed(name)
