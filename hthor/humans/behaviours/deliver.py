"""Bringing the object in hand to where it belongs: the choice of a place and of a spot on it."""

from functools import partial

from hthor import catalog
from hthor.geometry.plane import to_house, to_local
from hthor.humans.core.trial_context import Behaviour
from hthor.humans.memory.spatial_memory import KnownPlace
from hthor.humans.memory.subgoals import Subgoal, SubgoalTracker
from hthor.humans.motor.approach import PATIENCE, Approach
from hthor.humans.search.exploration import Exploration
from hthor.humans.search.option_choice import OptionChoice
from hthor.types import Drop, Place, Vec2, Vec3

_EDGE_M = 0.12
"""[m] People put things down at least this far from the edge. Our choice."""
_REACHABLE_Z_M = (0.25, 1.4)
"""[m] Heights of the surfaces that people use first. Our choice."""
_SHIFTS_M = (0.0, 0.3, -0.3)
"""[m] Shifts of the point along the surface, one per try in turn. Our choice."""
_BESIDE_M = 0.5
"""[m] Distance from a place's outline at which the estimated path to it ends. Our choice."""


class Delivery:
    """Brings objects to where they belong."""

    def __init__(self, approach: Approach, exploration: Exploration, subgoals: SubgoalTracker) -> None:
        self.approach, self.exploration, self.subgoals, self.hands = approach, exploration, subgoals, exploration.hands
        self.human, self.memory, self.walker = approach.human, approach.memory, approach.walker
        self.search = OptionChoice(self.human, self.memory, self.walker, "destination")

    def deliver(self, subgoal: Subgoal, advised: Vec3 | None = None) -> Behaviour:
        """Bring the object in hand to where it belongs: its spot, a place ``advised`` [m] by a robot, or one found."""
        if subgoal.spot is not None:
            if self.approach.tries <= PATIENCE or not subgoal.job.destinations:
                return (yield from self._restore(subgoal, subgoal.spot))
            subgoal.spot = None  # any spot on the place is good enough
        is_known = partial(self.subgoals.knows_destination, subgoal)
        if advised is not None:
            yield from self.exploration.make_for(advised, is_known, self.search)
        if self.subgoals.forgot_destination(subgoal) and not is_known():
            yield from self.exploration.retrace(is_known)
        yield from self.exploration.look_for(self.search, is_known)
        place = self._destination(subgoal)
        if place is None:
            return False
        self.memory.heading = place.id
        if not (yield from self.approach.to_place(place)):
            return False
        if place.state == "closed" and (yield from self.exploration.open(place)):
            return False
        point = _resting_point(place, self.human.here, self.approach.tries - 1)
        yield from self.human.look_at(point)
        reason = yield from self.hands.do(Place(on=place.id, position=point), f"place {place.id}")
        return not reason

    def seek(self, subgoal: Subgoal, remembered: Vec3) -> Behaviour:
        """Look for the object's destination near a place that is ``remembered`` [m]; whether it is known then."""
        is_known = partial(self.subgoals.knows_destination, subgoal)
        return (yield from self.exploration.make_for(remembered, is_known, self.search))

    def _restore(self, subgoal: Subgoal, spot: Vec3) -> Behaviour:
        """Put the object back exactly, on or in its old support, which has to be recognised first."""
        support = subgoal.job.destinations[0] if subgoal.job.destinations else ""
        known = partial(self._recognises, support)
        yield from self.exploration.make_for(spot, known, self.search)
        if not (yield from self.approach.to_object(spot, support, self.approach.arm)):
            return False
        place = self.memory.places.get(support) or self.memory.at(spot)
        if place is not None and place.state == "closed":
            if (yield from self.exploration.open(place)):
                return False
            yield from self.human.look_at(spot)
        on = support or (place.id if place is not None else "")
        motion = Place(on=on, position=spot) if on else Drop()
        reason = yield from self.hands.do(motion, f"place {subgoal.target}")
        return not reason

    def _recognises(self, support: str) -> bool:
        return not support or support in self.memory.places

    def _destination(self, subgoal: Subgoal) -> KnownPlace | None:
        """The nearest known place where the object belongs; after several refusals, the next nearest."""
        known = self.subgoals.known_destinations(subgoal)
        if not known:
            return None
        spots = [(place.centre[0], place.centre[1]) for place in known]
        reach = [max(place.size[:2]) / 2.0 + _BESIDE_M for place in known]
        far = [self.walker.map.planner.distance(self.human.here, spot, r) for spot, r in zip(spots, reach, strict=True)]
        order = sorted(range(len(known)), key=lambda k: (far[k], known[k].id))
        return known[order[self.approach.tries // PATIENCE % len(order)]]


def _resting_point(place: KnownPlace, here: Vec2, number: int) -> Vec3:
    """A point on a surface of the place [m], near to the participant at first, farther along at later tries."""
    surfaces = catalog.kind(place.kind).rests(place.size)
    low, high = _REACHABLE_Z_M
    usable = [s for s in surfaces if low <= place.centre[2] + s.centre[2] <= high] or list(surfaces)
    turn, shift = divmod(number, len(_SHIFTS_M))
    surface = usable[turn % len(usable)] if usable else None
    if surface is None:
        return place.centre
    x, y, _ = to_local((here[0], here[1], 0.0), place.centre, place.yaw)
    half = [max(0.0, h - _EDGE_M) for h in surface.half]
    cx, cy, cz = surface.centre
    u, v = (x - cx, y - cy)
    if abs(v) - half[1] > abs(u) - half[0]:
        u += _SHIFTS_M[shift]
    else:
        v += _SHIFTS_M[shift]
    spot = (cx + max(-half[0], min(half[0], u)), cy + max(-half[1], min(half[1], v)), cz)
    return to_house(spot, place.centre, place.yaw)
