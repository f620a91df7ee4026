"""Bringing what is in hand to where it belongs: which place, which spot on it."""

from __future__ import annotations

from functools import partial

from hthor import catalog
from hthor.geometry.plane import to_house, to_local
from hthor.humans.core.trial_context import Deed, Subject
from hthor.humans.memory.spatial_memory import Memory, Place
from hthor.humans.memory.subgoals import Duties, Duty
from hthor.humans.motor.approach import PATIENCE, REACH, Approach
from hthor.humans.motor.locomotion import Walker
from hthor.humans.motor.manipulation import Hands
from hthor.humans.search.exploration import Exploring
from hthor.humans.search.option_choice import Search
from hthor.types import Drop, Vec2, Vec3
from hthor.types import Place as Put

_EDGE_M = 0.12


class Delivering:
    """Brings things home."""

    def __init__(
        self,
        me: Subject,
        memory: Memory,
        walker: Walker,
        approach: Approach,
        exploring: Exploring,
        hands: Hands,
        duties: Duties,
    ) -> None:
        self.me, self.memory, self.walker, self.approach = me, memory, walker, approach
        self.exploring, self.hands, self.duties = exploring, hands, duties
        self.search = Search(me, memory, walker, {}, "destination")

    def deliver(self, duty: Duty, lead: Vec3 | None = None) -> Deed:
        """Bring what is held where it belongs; look for that first when it is not known.

        Args:
            lead: where a robot says that such a place is [m].
        """
        if duty.spot is not None:
            if self.approach.tries <= PATIENCE or not duty.job.destinations:
                return (yield from self._restore(duty, duty.spot))
            duty.spot = None  # anywhere on it will do
        knows = partial(self.duties.knows, duty)
        if lead is not None:
            yield from self.exploring.make_for(lead, knows, self.search)
        if self.duties.forgot(duty) and not knows():
            yield from self.exploring.retrace(knows)
        yield from self.exploring.look_for(self.search, knows)
        place = self._destination(duty)
        if place is None:
            return False
        self.memory.heading = place.id
        if not (yield from self.approach.to_place(place)):
            return False
        if place.state == "closed" and (yield from self.exploring.open(place)):
            return False
        point = _resting_point(place, self.me.here, self.approach.tries - 1)
        yield from self.me.look_at(point)
        reason = yield from self.hands.do(Put(on=place.id, position=point), f"place {place.id}")
        return not reason

    def _restore(self, duty: Duty, spot: Vec3) -> Deed:
        """Put it back just there: on or in what it was on or in, which has to be recognised first."""
        support = duty.job.destinations[0] if duty.job.destinations else ""
        known = partial(self._recognises, support)
        yield from self.exploring.make_for(spot, known, self.search)
        if not (yield from self.approach.to_object(spot, support, self.me.body.reach * REACH)):
            return False
        place = self.memory.places.get(support) or self.memory.at(spot)
        if place is not None and place.state == "closed":
            if (yield from self.exploring.open(place)):
                return False
            yield from self.me.look_at(spot)
        on = support or (place.id if place is not None else "")
        motion = Put(on=on, position=spot) if on else Drop()
        reason = yield from self.hands.do(motion, f"place {duty.target}")
        return not reason

    def _recognises(self, support: str) -> bool:
        return not support or support in self.memory.places

    def _destination(self, duty: Duty) -> Place | None:
        """The nearest place known where the object belongs; after several refusals, another one."""
        known = self.duties.places(duty)
        if not known:
            return None
        spots = [(place.centre[0], place.centre[1]) for place in known]
        reach = [max(place.size[:2]) / 2.0 + 0.5 for place in known]
        far = [self.walker.planner.distance(self.me.here, spot, r) for spot, r in zip(spots, reach, strict=True)]
        order = sorted(range(len(known)), key=lambda k: (far[k], known[k].id))
        return known[order[self.approach.tries // PATIENCE % len(order)]]


def _resting_point(place: Place, here: Vec2, number: int) -> Vec3:
    """A point on a surface of the place, near to the person at first, further along at later tries."""
    surfaces = catalog.kind(place.kind).rests(place.size)
    usable = [s for s in surfaces if 0.25 <= place.centre[2] + s.centre[2] <= 1.4] or list(surfaces)
    surface = usable[number // 3 % len(usable)] if usable else None
    if surface is None:
        return place.centre
    x, y, _ = to_local((here[0], here[1], 0.0), place.centre, place.yaw)
    shift = (0.0, 0.3, -0.3)[number % 3]
    half = [max(0.0, h - _EDGE_M) for h in surface.half]
    cx, cy, cz = surface.centre
    u, v = (x - cx, y - cy)
    if abs(v) - half[1] > abs(u) - half[0]:
        u += shift
    else:
        v += shift
    spot = (cx + max(-half[0], min(half[0], u)), cy + max(-half[1], min(half[1], v)), cz)
    return to_house(spot, place.centre, place.yaw)
