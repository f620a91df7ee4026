"""Which of all there is to do a person is about now."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Literal

from msgspec import Struct

from hthor.humans.communication.interpretation import Claim, Claims
from hthor.humans.core.trial_context import Subject
from hthor.humans.memory.object_memory import Things
from hthor.humans.memory.spatial_memory import Memory
from hthor.humans.memory.subgoals import Duties, Duty
from hthor.types import Vec2, Vec3

Verb = Literal["begin", "deliver", "fetch", "haul", "follow", "search", "rest"]


class Aim(Struct, frozen=True, kw_only=True):
    """What a person sets out to do, with which object or on whose word. Two aims are one only if they are the same."""

    verb: Verb
    duty: Duty | None = None
    claim: Claim | None = None

    @property
    def position(self) -> Vec3:
        """Where it leads to [m]."""
        if self.claim is not None and self.claim.position is not None:
            return self.claim.position
        seen = self.duty.known.seen if self.duty is not None else None
        assert seen is not None, "only what leads somewhere is weighed"
        return seen.position

    @property
    def words(self) -> str:
        """Such as "fetch apple", or "search"."""
        if self.duty is not None:
            return f"{self.verb} {self.duty.known.id}"
        return self.verb if self.claim is None else f"{self.verb} message {self.claim.number}"


BEGIN, SEARCH, REST = Aim(verb="begin"), Aim(verb="search"), Aim(verb="rest")


class Agenda:
    """Chooses: first what is in hand, then the nearest of what is known or was told, then what is still to be found.

    ``missing`` are the jobs whose objects the person has to look for. A choice stands until there is news.

    Args:
        apart: walking distances [m] from a place to points.
    """

    def __init__(
        self,
        me: Subject,
        duties: Duties,
        things: Things,
        claims: Claims,
        memory: Memory,
        apart: Callable[[Vec2, Sequence[Vec2]], Sequence[float]],
    ) -> None:
        self.me, self.duties, self.things, self.claims, self.memory = me, duties, things, claims, memory
        self._apart = apart
        self.missing: tuple[Duty, ...] = tuple(duties.all.values())
        self._deliveries: dict[str, Aim] = {}
        self._fetches: dict[str, Aim] = {}
        for target, duty in duties.all.items():
            alone = duty.job.hands < 2
            self._fetches[target] = Aim(verb="fetch" if alone else "haul", duty=duty)
            self._deliveries[target] = Aim(verb="deliver", duty=duty) if alone else self._fetches[target]
        self._follows: dict[int, Aim] = {}
        self._held: Duty | None = None
        self._news = -1
        self._choice: Aim | None = None

    def aim(self) -> Aim | None:
        """What to be about now, None when there is nothing better than to search."""
        holding = self.me.now.holding
        if holding:
            delivery = self._deliveries.get(holding)
            if delivery is not None:
                self._held = delivery.duty
                return delivery
        elif self._held is not None:
            self._put_down(self._held)
        if self._fresh() != self._news:
            self._choice = self._choose()
            self._news = self._fresh()
        return self._choice

    def _fresh(self) -> int:
        """Grows with every piece of news, none of which is ever taken back."""
        places = len(self.memory.places) if self.duties.many else 0
        return self.things.news + self.claims.news + places

    def _put_down(self, duty: Duty) -> None:
        """What was in hand is not any more: it was put where it belongs, or lies where it fell."""
        self._held, outcome = None, self.me.now.outcome
        self.things.news += 1
        if self.duties.many and outcome is not None and outcome.ok and outcome.motion == "place":
            duty.done, duty.tries = "seen", duty.tries + 1
            duty.known.at = -1  # where exactly it lies is to be seen

    def _choose(self) -> Aim | None:
        self.duties.settle()
        todo = self.duties.open()
        lying = [duty for duty in todo if duty.known.lies is not None]
        for duty in lying:
            self.claims.forget(duty)
        self.missing = tuple(duty for duty in todo if duty.known.seen is None)
        options = [self._fetches[duty.target] for duty in lying]
        options += [self._follow(claim) for claim in self.claims.kept.values() if self._is_open(claim)]
        if len(options) > 1:
            return self._nearest(options)
        if options:
            return options[0]
        if not self.missing:
            self.missing = tuple(duty for duty in self.duties.all.values() if duty.done != "seen")
        return None if self.missing or not self.duties.many else REST

    def _is_open(self, claim: Claim) -> bool:
        return claim.duty is None or not claim.duty.done

    def _follow(self, claim: Claim) -> Aim:
        return self._follows.setdefault(claim.number, Aim(verb="follow", duty=claim.duty, claim=claim))

    def _nearest(self, options: list[Aim]) -> Aim:
        spots = [(aim.position[0], aim.position[1]) for aim in options]
        far = self._apart(self.me.here, spots)
        return options[min(range(len(options)), key=lambda k: (far[k], math.dist(self.me.here, spots[k]), k))]
