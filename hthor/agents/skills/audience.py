"""Which of several people a robot tells about a job."""

import math
from collections import Counter

from hthor.agents.skills.knowledge import Knowledge
from hthor.agents.skills.task_allocation import TaskAllocation, seat_order
from hthor.types import Job, Observation

_BUSY_S = 20.0
"""How long a person who has accepted a message is assumed to be on the way because of it [s]."""


class Audience:
    """Tells each person about another job: two people who hear the same message both go to the same object.

    With one person, messages have no addressee. Robots do not know what other robots have said.
    """

    def __init__(self, allocation: TaskAllocation, tick_s: float) -> None:
        self.allocation = allocation
        self._busy_ticks = round(_BUSY_S / tick_s)
        self._told: Counter[tuple[str, str]] = Counter()
        self._latest = ("", "")
        self._accepted: dict[str, tuple[str, int]] = {}

    def hear(self, observation: Observation) -> None:
        """Learn from the receipt of the last message who goes where."""
        receipt, (seat, target) = observation.receipt, self._latest
        if receipt is not None and seat == receipt.by:
            if receipt.status == "accepted":
                self._accepted[seat] = (target, receipt.tick)
            elif self._accepted.get(seat, ("", 0))[0] == target:
                self._accepted.pop(seat, None)

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
        doing = {seat for seat, (target, _) in self._accepted.items() if target == job.target}
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
        """Whether a person has accepted a message about another job a short while ago."""
        target, tick = self._accepted.get(seat, (job.target, 0))
        return target != job.target and self.allocation.tick < tick + self._busy_ticks
