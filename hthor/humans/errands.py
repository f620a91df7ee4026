"""What a person does in a trial, as deeds built from looking, walking and handling: search, fetch, deliver, follow.

Knows nothing of when to change from one to another.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator

from hthor import catalog
from hthor.geometry import to_house, to_local
from hthor.humans import standing
from hthor.humans.beliefs import expectation
from hthor.humans.hands import Hands
from hthor.humans.memory import Memory, Place
from hthor.humans.perception import Eyes
from hthor.humans.search import Option, Search
from hthor.humans.subject import Deed, Subject
from hthor.humans.walking import Walker, never
from hthor.navigation.frontier import frontiers
from hthor.types import Detection, Motion, Open, Pick, Vec2, Vec3
from hthor.types import Place as Put

_INSIDE_M = 0.5
_FOUND_M = 1.3
_EDGE_M = 0.12
_SWEEP_RAD = 1.0
_REACH = 0.85
_PATIENCE = 6


class Errands:
    """Everything the person can set out to do.

    ``fresh`` is where a room was entered that was not looked round in yet.
    """

    def __init__(self, me: Subject, eyes: Eyes, memory: Memory, walker: Walker) -> None:
        self.me, self.eyes, self.memory, self.walker = me, eyes, memory, walker
        self.hands = Hands(me)
        self.fresh: Vec2 | None = None
        self._turns = 0
        self._tries = 0
        wanted = expectation(me.task.target, me.traits.w_prior)
        if me.task.destination in wanted:
            wanted = {**wanted, me.task.destination: wanted[me.task.destination] * me.traits.dest_factor}
        self._for_target = Search(me, memory, walker, wanted, "target")
        self._for_destination = Search(me, memory, walker, {}, "destination")

    def anew(self) -> None:
        """Forget what was tried: another errand begins."""
        self._tries = 0
        self.eyes.attention = None

    def begin(self) -> Deed:
        """Take a moment, then look round."""
        yield from self.me.rest(self.me.traits.t_on)
        yield from self._round(self.me.traits.scan_first)
        return True

    def search(self) -> Deed:
        """Look for the target, one place or room after the other, for ever."""
        yield from self._look_for(self._for_target, never)
        return True

    def fetch(self) -> Deed:
        """Go to the target where it was noticed; take it in hand unless finding is all. False when that failed."""
        target = self.eyes.target
        if target is None:
            return False
        self.eyes.attention = target.position
        if self.me.task.relation == "find":
            arrived = yield from self._approach(target.position, target.support, _FOUND_M, self._is_close)
        else:
            arrived = yield from self._approach(target.position, target.support, self.me.body.reach * _REACH)
        yield from self._check(target)
        if self.eyes.target is None or self.me.task.relation == "find":
            return arrived
        reason = yield from self.hands.do(Pick(object=target.id), f"pick {target.id}")
        return not reason

    def deliver(self) -> Deed:
        """Bring what is held to the destination, and look for one first when none is known."""
        yield from self._look_for(self._for_destination, lambda: self._destination() is not None)
        place = self._destination()
        if place is None:
            return False
        yield from self._go_to(place, self._tries)
        if place.state == "closed" and (yield from self._open(place)):
            return False
        point = _resting_point(place, self.me.here, self._tries)
        self._tries += 1
        yield from self.me.look_at(point)
        reason = yield from self.hands.do(Put(on=place.id, position=point), f"place {place.id}")
        return not reason

    def follow(self, position: Vec3) -> Deed:
        """Go where a robot says something is, and look there; True when all was done, whatever was found."""
        self.eyes.attention = position
        support = self.memory.at(position)
        yield from self._approach(position, support.id if support else "", 1.0, lambda: self._learnt(position, support))
        place = self.memory.at(position)
        if place is not support:
            yield from self._approach(position, place.id if place else "", 1.0)
        if place is not None and place.state == "closed":
            yield from self._open(place)
        yield from self.me.look_at(position)
        yield from self.me.rest(self.me.traits.t_look)
        if place is not None:
            self.memory.expose(place, self.me.traits.e_done, self.me.now.tick)
        return True

    def _look_for(self, search: Search, enough: Callable[[], bool]) -> Deed:
        while not enough():
            if self.fresh is not None:
                self.fresh = None
                yield from self._round(self.me.traits.scan)
                continue
            option = search.choose()
            if option is None:
                yield from self._wander()
            elif option.place is not None:
                yield from self._inspect(option.place, option.spot)
            else:
                yield from self._pass(option, enough)
        return True

    def _pass(self, option: Option, enough: Callable[[], bool]) -> Deed:
        """Go through a doorway."""
        arrived = yield from self.walker.go(option.spot, stop=lambda: self._inside() or enough())
        tried = not arrived or math.dist(self.me.here, option.spot) < _INSIDE_M
        if option.doorway is not None and tried:
            option.doorway.passed = True
        return arrived

    def _inspect(self, place: Place, spot: Vec2) -> Deed:
        """Go to a place and look at all of it; pass it by when it turns out on the way that nothing is there."""
        me, memory = self.me, self.memory
        self.eyes.attention = place

        def plain() -> bool:
            return place.state != "closed" and memory.exposure(place, me.now.tick) > me.traits.e_skip

        arrived = yield from self.walker.go(spot, stop=lambda: self._inside() or plain())
        if arrived and (plain() or self._inside()):
            self.eyes.attention = None
            return True
        refused = ""
        if arrived and place.state == "closed":
            refused = yield from self._open(place)
        if arrived and not refused:
            gazes = _gazes(place, me.here)
            for gaze in gazes:
                yield from me.look_at(gaze)
                yield from me.rest(me.traits.t_dwell * (1.0 if len(gazes) == 1 else 0.6))
        memory.expose(place, me.traits.e_done, me.now.tick)
        self.eyes.attention = None
        return True

    def _open(self, place: Place) -> Generator[Motion, None, str]:
        yield from self.me.look_at(place.centre)
        reason = yield from self.hands.do(Open(thing=place.id), f"open {place.id}")
        if not reason:
            place.state = "open"
        return reason

    def _wander(self) -> Deed:
        """Nothing comes to mind: go where the known floor ends, or look round once more."""
        edges = frontiers(self.walker.grid, self.walker.planner, self.me.now.pose)
        if edges:
            nearest = min(edges, key=lambda edge: edge.distance)
            arrived = yield from self.walker.go(nearest.centre, stop=self._inside)
            if arrived and math.dist(self.me.here, nearest.centre) > 0.3:
                return True
        yield from self._round(self.me.traits.scan)
        return True

    def _round(self, angle: float) -> Deed:
        self.fresh = None
        self._turns += 1
        yield from self.me.look_round(angle, "round", self._turns)
        return True

    def _inside(self) -> bool:
        """Whether the person has taken a step into a room not looked round in yet."""
        return self.fresh is not None and math.dist(self.fresh, self.me.here) > _INSIDE_M

    def _approach(self, point: Vec3, support: str, reach: float, stop: Callable[[], bool] = never) -> Deed:
        """Walk to within ``reach`` [m] of an object, a little elsewhere at each new try."""
        place = self.memory.places.get(support) or self.memory.at(point)
        spots = standing.near(point, place, self.walker, reach)
        if place is not None and place.state:
            spots = standing.in_reach(standing.at(place, self.walker, front=True), point, reach) or spots
        self._tries += 1
        spot = self._nearest(spots, self._tries - 1)
        if spot is not None:
            arrived = yield from self.walker.go(spot, stop=stop)
        else:
            arrived = yield from self.walker.go((point[0], point[1]), within=reach, stop=stop)
        yield from self.me.look_at(point)
        return arrived

    def _go_to(self, place: Place, number: int) -> Deed:
        spots = standing.at(place, self.walker, front=bool(place.state))
        spot = self._nearest(spots, number)
        if spot is None:
            reach = self.me.body.reach * _REACH + min(place.size[:2]) / 2.0
            return (yield from self.walker.go((place.centre[0], place.centre[1]), within=reach))
        return (yield from self.walker.go(spot))

    def _nearest(self, spots: list[Vec2], number: int) -> Vec2 | None:
        """The nearest spot on foot, or at later tries another one."""
        if not spots:
            return None
        distances = self.walker.planner.distances(self.me.here, spots)
        ranked = sorted((far, spot) for far, spot in zip(distances, spots, strict=True) if math.isfinite(far))
        return ranked[(number % _PATIENCE) * 3 % len(ranked)][1] if ranked else None

    def _is_close(self) -> bool:
        target = self.eyes.target
        return target is not None and self.eyes.seen_at == self.me.now.tick and target.distance < _FOUND_M

    def _check(self, target: Detection) -> Deed:
        """Look where the target should be; without it in view it is not there any more, or was never."""
        yield from self.me.look_at(target.position)
        since = self.me.now.tick
        yield from self.me.rest(0.4)
        if self.eyes.seen_at < since and self._tries > 2:
            self._tries = 0
            self.eyes.lose()
        return True

    def _learnt(self, position: Vec3, before: Place | None) -> bool:
        """Whether the furniture at a position came into view on the way."""
        return before is None and self.memory.at(position) is not None

    def _destination(self) -> Place | None:
        """The nearest place known of the kind that the target shall go to; after several refusals, another one."""
        kind = self.me.task.destination
        known = [place for place in self.memory.places.values() if place.kind == kind]
        if not known:
            return None
        spots = [(place.centre[0], place.centre[1]) for place in known]
        reach = [max(place.size[:2]) / 2.0 + 0.5 for place in known]
        far = [self.walker.planner.distance(self.me.here, spot, r) for spot, r in zip(spots, reach, strict=True)]
        order = sorted(range(len(known)), key=lambda k: (far[k], known[k].id))
        return known[order[self._tries // _PATIENCE % len(order)]]


def _gazes(place: Place, here: Vec2) -> list[Vec3]:
    """Where to look to see all of a place from ``here``: its middle, or parts of a long one from left to right."""
    w, d, h = place.size
    top = h / 2.0 if h < 1.3 and not place.state else 0.0
    ends = [(-w / 2.0, 0.0, top), (w / 2.0, 0.0, top)] if w >= d else [(0.0, -d / 2.0, top), (0.0, d / 2.0, top)]
    a, b = (to_house(end, place.centre, place.yaw) for end in ends)
    bearings = [math.atan2(p[1] - here[1], p[0] - here[0]) for p in (a, b)]
    wide = abs(math.remainder(bearings[1] - bearings[0], 2.0 * math.pi))
    count = max(1, math.ceil(wide / _SWEEP_RAD - 0.3))
    shares = [(k + 0.5) / count for k in range(count)]
    return [(a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2]) for s in shares]


def _resting_point(place: Place, here: Vec2, number: int) -> Vec3:
    """A point on a surface of the place, near to the person at first, further along at later tries."""
    surfaces = catalog.kind(place.kind).surfaces(place.size)
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
