"""Which of several people a robot tells about a job."""

import math
from collections import Counter
from typing import NamedTuple

from hthor.agents.skills.knowledge import Knowledge
from hthor.agents.skills.task_allocation import TaskAllocation, seat_order
from hthor.types import Job, Observation

_BUSY_S, _PACE_M_S = 20.0, 0.4
"""A person who has accepted a message is assumed to be on the way because of it for as long as the walk takes at this
pace, that of people in a headset (docs/humans.md), and at least for so long [s]."""


class _Acceptance(NamedTuple):
    """An accepted message: its object, when it was accepted, and until when the person is on the way [tick]."""

    target: str
    tick: int
    until: int


class Audience:
    """Tells each person about another job: two people who hear the same message both go to the same object.

    With one person, messages have no addressee. Robots do not know what other robots have said.
    """

    def __init__(self, allocation: TaskAllocation, tick_s: float) -> None:
        self.allocation = allocation
        self.tick_s = tick_s
        self._told: Counter[tuple[str, str]] = Counter()
        self._latest = ("", "")
        self._accepted: dict[str, _Acceptance] = {}

    def hear(self, observation: Observation, knowledge: Knowledge) -> None:
        """Learn from the receipt of the last message who goes where."""
        receipt, (seat, target) = observation.receipt, self._latest
        if receipt is not None and seat == receipt.by:
            known = self._accepted.get(seat)
            if receipt.status != "accepted":
                if known is not None and known.target == target:
                    self._accepted.pop(seat)
            elif known is None or (known.target, known.tick) != (target, receipt.tick):
                until = receipt.tick + round(self._walk_s(seat, target, knowledge) / self.tick_s)
                self._accepted[seat] = _Acceptance(target, receipt.tick, until)

    def choose(self, job: Job, knowledge: Knowledge) -> str:
        """The person to tell: with free hands, told least often about this job, and nearest; empty for everybody."""
        people = self.allocation.people
        if len(people) < 2:
            return ""
        free = self._free(job, knowledge)
        spot = knowledge.states[job.target].position[:2] if job.target in knowledge.states else None

        def order(seat: str) -> tuple[int, float, tuple[bool, int, str]]:
            far = 0.0 if spot is None else math.dist(self.allocation.place(seat), spot)
            return self._told[seat, job.target], round(far, 1), seat_order(seat)

        return min(free or people, key=order)

    def has_somebody_else(self, job: Job, knowledge: Knowledge) -> bool:
        """Whether somebody is free to hear about other jobs while somebody does this one."""
        doing = {seat for seat, one in self._accepted.items() if one.target == job.target}
        return len(self.allocation.people) > 1 and any(seat not in doing for seat in self._free(job, knowledge))

    def _free(self, job: Job, knowledge: Knowledge) -> list[str]:
        """The people with free hands who are not on the way because of another job."""
        holders = {seat for state in knowledge.states.values() for seat in (state.held_by, *state.bearers)}
        people = self.allocation.people
        return [seat for seat in people if seat not in holders and not self._is_on_the_way(seat, job)]

    def note(self, seat: str, job: Job) -> None:
        """Note that a person, or everybody (""), is told about a job now."""
        self._latest = (seat, job.target)
        self._told[self._latest] += 1

    def _is_on_the_way(self, seat: str, job: Job) -> bool:
        """Whether a person is probably on the way because of a message about another job."""
        known = self._accepted.get(seat)
        return known is not None and known.target != job.target and self.allocation.tick < known.until

    def _walk_s(self, seat: str, target: str, knowledge: Knowledge) -> float:
        """How long the walk of a person to an object takes [s]."""
        if target not in knowledge.states:
            return _BUSY_S
        return max(_BUSY_S, self.allocation.distance(seat, knowledge.states[target].position) / _PACE_M_S)
