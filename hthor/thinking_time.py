"""Thinking time as time of the trial: decisions come as late as they were made.

Time is measured while the mind decides, without what it takes to draw or scan for it. It adds up in ticks: whoever
thinks a third of a tick each time is a tick late every third time, so that nothing is rounded away.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import Any

import msgspec
from msgspec import Struct

from hthor import rules
from hthor.types import Action, Mind, Observation

_HAIR = 1e-9
"""Of a tick: three tenths of a second are three ticks, however they were added up."""


class Decision(Struct, frozen=True, kw_only=True):
    """What a seat's mind decided on; ``moves`` says whether its body was free, so that the motion counts."""

    seat: str
    action: Action
    moves: bool


class Thinking:
    """Holds back what minds decided until their thinking time is over; meanwhile they are not asked again.

    Args:
        clock: seconds of any clock that only goes forward.
    """

    def __init__(self, clock: Callable[[], float] = time.perf_counter) -> None:
        self._clock = clock
        self._owed: dict[str, float] = {}
        self._held: dict[str, tuple[int, Decision]] = {}

    def busy(self, seat: str) -> bool:
        """Whether its mind is still at the last question."""
        return seat in self._held

    def ask(self, seat: str, mind: Mind, observation: Observation) -> Action:
        """The mind's action; how long it took is kept in mind."""
        senses = Timed(observation.senses, self._clock)
        began = self._clock()
        action = mind.act(msgspec.structs.replace(observation, senses=senses))
        spent = self._clock() - began - senses.spent
        self._owed[seat] = self._owed.get(seat, 0.0) + max(0.0, spent)
        return action

    def late(self, seat: str) -> int:
        """How many whole ticks its thinking took, which are then paid for."""
        ticks = int(self._owed.get(seat, 0.0) / rules.TICK_S + _HAIR)
        self._owed[seat] = self._owed.get(seat, 0.0) - ticks * rules.TICK_S
        return ticks

    def hold(self, decision: Decision, until: int) -> None:
        """Keep a decision back until a tick."""
        self._held[decision.seat] = (until, decision)

    def due(self, tick: int, seats: Iterable[str]) -> list[Decision]:
        """The decisions whose time has come, in the order of these seats."""
        found = [self._held[seat] for seat in seats if seat in self._held]
        ripe = [decision for until, decision in found if until <= tick]
        for decision in ripe:
            del self._held[decision.seat]
        return ripe


class Timed:
    """A body's senses, and how long they took to work: ``spent`` [s]."""

    def __init__(self, senses: Any, clock: Callable[[], float]) -> None:
        self._senses, self._clock, self.spent = senses, clock, 0.0

    def timed(self, name: str) -> Callable[..., Any]:
        """The sense of this name, on the clock."""
        sense = getattr(self._senses, name)

        def timed(*given: Any) -> Any:
            began = self._clock()
            try:
                return sense(*given)
            finally:
                self.spent += self._clock() - began

        return timed

    def __getattr__(self, name: str) -> Callable[..., Any]:
        return self.timed(name)
