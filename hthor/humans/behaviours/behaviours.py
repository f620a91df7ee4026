"""What a person does in a trial, as deeds built from looking, walking and handling: search, fetch, deliver, follow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

from hthor import rules
from hthor.humans.behaviours.carry import Hauling
from hthor.humans.behaviours.deliver import Delivering
from hthor.humans.behaviours.follow_message import Following
from hthor.humans.core.trial_context import Deed, Subject
from hthor.humans.memory.location_priors import expectation
from hthor.humans.memory.spatial_memory import Memory
from hthor.humans.memory.subgoals import Duties, Duty
from hthor.humans.motor.approach import PATIENCE, REACH, Approach
from hthor.humans.motor.locomotion import Walker, never
from hthor.humans.motor.manipulation import Hands
from hthor.humans.perception.perception import Eyes
from hthor.humans.search.exploration import Exploring
from hthor.humans.search.option_choice import Search
from hthor.types import Detection, Pick, Vec3

_FOUND_M = 1.3
_SLACK_M = 0.04
_BLINK_S = 0.4
_TRIES = 3
_REST_S = 4.0


class Errands:
    """Everything the person can set out to do."""

    def __init__(self, me: Subject, eyes: Eyes, memory: Memory, walker: Walker, duties: Duties) -> None:
        self.me, self.eyes, self.memory, self.walker = me, eyes, memory, walker
        self.hands = Hands(me)
        self.exploring = Exploring(me, eyes, memory, walker, self.hands)
        self.approach = Approach(me, eyes, memory, walker)
        self.following = Following(me, eyes, memory, walker, self.exploring)
        self.delivering = Delivering(me, memory, walker, self.approach, self.exploring, self.hands, duties)
        self.hauling = Hauling(me, memory, walker, self.approach, self.exploring, self.hands, duties)
        self._patience = _TRIES if duties.many else PATIENCE
        self._for_targets = Search(me, memory, walker, {}, "target")
        self.expect(tuple(duties.all.values()))

    def anew(self, duty: Duty | None = None) -> None:
        """Forget what was tried: another errand begins, about this object."""
        self.approach.anew()
        self.eyes.attention = None
        if duty is not None:
            self.eyes.subject = duty.known

    def expect(self, missing: Sequence[Duty]) -> None:
        """These are the objects to search for: hope lies where any of them may be, but hardly where it shall go."""
        search, w_prior = self._for_targets, self.me.traits.w_prior
        search.hope, search.knowledge, search.uniform = (self._hope(missing, share) for share in (w_prior, 1.0, 0.0))

    def _hope(self, missing: Sequence[Duty], w_prior: float) -> dict[str, float]:
        hope: dict[str, float] = {}
        for duty in missing:
            wanted = expectation(duty.kind, w_prior)
            for home in duty.job.destinations:
                if home in wanted:
                    wanted = {**wanted, home: wanted[home] * self.me.traits.dest_factor}
            hope = {kind: hope.get(kind, 0.0) + share / len(missing) for kind, share in wanted.items()}
        return hope

    def searching(self, errand: str) -> Search:
        """The search that a robot's word would spare the person: for where to "bring" what is in hand, or for it."""
        return self.delivering.search if errand == "bring" else self._for_targets

    def begin(self) -> Deed:
        """Take a moment, then look round."""
        yield from self.me.rest(self.me.traits.t_on)
        yield from self.exploring.look_round(self.me.traits.scan_first)
        return True

    def search(self) -> Deed:
        """Look for what is missing, one place or room after the other, for ever."""
        yield from self.exploring.look_for(self._for_targets, never)
        return True

    def rest(self) -> Deed:
        """All is done: look about now and then."""
        yield from self.me.rest(_REST_S)
        yield from self.exploring.look_round(self.me.traits.scan)
        return True

    def fetch(self, duty: Duty) -> Deed:
        """Go to an object where it was noticed; take it in hand unless finding is all. False when that failed."""
        target = duty.known.lies
        if target is None:
            return False
        self.eyes.attention = target.position
        if duty.job.relation == "find":
            stop = partial(self._is_close, duty)
            reach = self._sight_m(target.position)
            arrived = yield from self.approach.to_object(target.position, target.support, reach, stop)
        else:
            arrived = yield from self.approach.to_object(target.position, target.support, self.me.body.reach * REACH)
        if not arrived:
            self._despair(duty)
            return False
        visible = yield from self._check(duty, target)
        if not visible or duty.job.relation == "find":
            return visible
        reason = yield from self.hands.do(Pick(object=target.id), f"pick {target.id}")
        return not reason

    def follow(self, position: Vec3) -> Deed:
        """Go where a robot says something is, and look there; True when all was done, whatever was found."""
        return (yield from self.following.follow(position))

    def look_into(self, position: Vec3) -> Deed:
        """Go to the furniture that a robot wants looked into, open it and look; search for it when it is next door."""
        yield from self.exploring.make_for(position, lambda: self.memory.at(position) is not None, self._for_targets)
        return (yield from self.follow(position))

    def _is_close(self, duty: Duty) -> bool:
        known = duty.known
        return known.seen is not None and known.at == self.me.now.tick and known.seen.distance < _FOUND_M

    def _check(self, duty: Duty, target: Detection) -> Deed:
        """Whether the object is in view from here; after several tries without, it is taken for gone."""
        yield from self.me.look_at(target.position)
        since = self.me.now.tick
        yield from self.me.rest(_BLINK_S)
        if duty.known.at >= since:
            return True
        self._despair(duty)
        return False

    def _despair(self, duty: Duty) -> None:
        """After several tries the object is taken for gone, or for a mistake."""
        if self.approach.tries > self._patience:
            self.anew()
            self.eyes.lose(duty.known)

    def _sight_m(self, point: Vec3) -> float:
        """How far off [m] on the floor a point is near enough to the eye to count as found."""
        return math.sqrt(max(0.25, rules.FIND_RANGE_M**2 - (self.me.body.eye - point[2]) ** 2)) - _SLACK_M
