"""What a person does in a trial, as deeds built from looking, walking and handling: search, fetch, deliver, follow.

Knows nothing of when to change from one to another.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from functools import partial

from hthor import catalog
from hthor.geometry import to_house, to_local, wrap
from hthor.humans import standing
from hthor.humans.beliefs import expectation
from hthor.humans.hands import Hands
from hthor.humans.memory import Memory, Place
from hthor.humans.perception import Eyes
from hthor.humans.search import Option, Search
from hthor.humans.subject import Deed, Subject
from hthor.humans.walking import Walker, never
from hthor.navigation.frontier import frontiers
from hthor.navigation.map import FREE
from hthor.types import Detection, Motion, Open, Pick, Vec2, Vec3, Wait
from hthor.types import Place as Put

_INSIDE_M = 0.5
_FOUND_M = 1.3
_EDGE_M = 0.12
_SWEEP_RAD = 1.0
_REACH = 0.96
_TRIED_M = 0.35
_GLIMPSE_M = 1.5
_PATIENCE = 6
_PAUSE_S = 0.3


class Errands:
    """Everything the person can set out to do.

    ``fresh`` is where a room was entered that was not looked round in yet.
    """

    def __init__(self, me: Subject, eyes: Eyes, memory: Memory, walker: Walker) -> None:
        self.me, self.eyes, self.memory, self.walker = me, eyes, memory, walker
        self.hands = Hands(me)
        self.fresh: Vec2 | None = None
        self._turns = 0
        self.anew()
        wanted = expectation(me.task.target, me.traits.w_prior)
        if me.task.destination in wanted:
            wanted = {**wanted, me.task.destination: wanted[me.task.destination] * me.traits.dest_factor}
        self._for_target = Search(me, memory, walker, wanted, "target")
        self._for_destination = Search(me, memory, walker, {}, "destination")

    def anew(self) -> None:
        """Forget what was tried: another errand begins."""
        self._tries = 0
        self._tried: list[Vec2] = []
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
        visible = arrived and (yield from self._check(target))
        if not visible or self.me.task.relation == "find":
            return visible
        reason = yield from self.hands.do(Pick(object=target.id), f"pick {target.id}")
        return not reason

    def deliver(self) -> Deed:
        """Bring what is held to the destination, and look for one first when none is known."""
        yield from self._look_for(self._for_destination, lambda: self._destination() is not None)
        place = self._destination()
        if place is None:
            return False
        if not (yield from self._go_to(place)):
            self._tries += 1
            return False
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
        for _ in range(_PATIENCE):
            place = self.memory.at(position)
            arrived = yield from self._approach(
                position, place.id if place else "", 1.0, partial(self._learnt, position, place)
            )
            if arrived and self.memory.at(position) is place:
                break
        place = self.memory.at(position)
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
            option, since = search.choose(), self.me.now.tick
            if option is None:
                yield from self._wander(search)
            elif option.place is not None:
                yield from self._inspect(option.place, option.spot, partial(search.done, option.place))
            else:
                yield from self._pass(option, enough)
            if self.me.now.tick == since:
                yield Wait(seconds=_PAUSE_S)
        return True

    def _pass(self, option: Option, enough: Callable[[], bool]) -> Deed:
        """Go through a doorway."""
        arrived = yield from self.walker.go(option.spot, stop=lambda: self._inside() or enough())
        doorway = option.doorway
        if doorway is not None:
            doorway.failures += not arrived
            if doorway.failures > 1 or math.dist(self.me.here, option.spot) < _INSIDE_M:
                doorway.passed = True
        return arrived

    def _inspect(self, place: Place, spot: Vec2, plain: Callable[[], bool] = never) -> Deed:
        """Go to a place and look at all of it, or pass it by once it is ``plain`` on the way that nothing is there."""
        me, memory = self.me, self.memory
        self.eyes.attention = place
        arrived = yield from self.walker.go(spot, stop=lambda: self._inside() or plain())
        if arrived and (plain() or self._inside()):
            self.eyes.attention = None
            return True
        if not arrived:
            memory.expose(place, 1.0, me.now.tick)
            self.eyes.attention = None
            return False
        if place.state != "closed" or not (yield from self._open(place)):
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

    def _wander(self, search: Search) -> Deed:
        """Nothing comes to mind: go where the known floor ends, search something again, or look round."""
        since = self.me.now.tick
        edges = frontiers(self.walker.grid, self.walker.planner, self.me.now.pose)
        if edges:
            nearest = min(edges, key=lambda edge: edge.distance)
            arrived = yield from self.walker.go(nearest.centre, stop=self._inside)
            if arrived and self.me.now.tick > since:
                return True
        place = search.again()
        spots = search.spots(place) if place is not None else []
        if place is not None and spots:
            return (yield from self._inspect(place, spots[0]))
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

        def spots() -> list[Vec2]:
            place = self.memory.places.get(support) or self.memory.at(point)
            around = standing.near(point, place, self.walker, reach)
            if place is None or not place.state:
                return around
            return standing.in_reach(standing.at(place, self.walker, front=True), point, reach) or around

        self._tries += 1
        arrived = yield from self._stand(spots, point, reach, stop)
        yield from self.me.look_at(point)
        return arrived

    def _go_to(self, place: Place) -> Deed:
        def spots() -> list[Vec2]:
            return standing.at(place, self.walker, front=bool(place.state))

        reach = self.me.body.reach * _REACH + min(place.size[:2]) / 2.0
        return (yield from self._stand(spots, place.centre, reach, never))

    def _stand(self, spots: Callable[[], list[Vec2]], point: Vec3, reach: float, stop: Callable[[], bool]) -> Deed:
        """Walk to the best of the spots; choose again once near enough to see whether one can stand there."""
        for _ in range(_PATIENCE):
            spot = self._nearest(spots(), point)
            if spot is None:
                return (yield from self.walker.go((point[0], point[1]), within=reach, stop=stop))
            guessed = self.walker.grid.at(*spot) != FREE and math.dist(self.me.here, spot) > _GLIMPSE_M
            arrived = yield from self.walker.go(spot, stop=partial(self._halt, stop, spot if guessed else None))
            if not arrived or not guessed or stop() or math.dist(self.me.here, spot) < _TRIED_M:
                break
            self._tried.pop()
        return arrived

    def _halt(self, stop: Callable[[], bool], guess: Vec2 | None) -> bool:
        return stop() or (guess is not None and math.dist(self.me.here, guess) < _GLIMPSE_M)

    def _nearest(self, spots: list[Vec2], point: Vec3) -> Vec2 | None:
        """The nearest spot on foot; after failures another one, from where the object was seen if possible."""
        new = [spot for spot in spots if all(math.dist(spot, old) > _TRIED_M for old in self._tried)]
        if not new:
            new, self._tried = spots, []
        seen_from = self.eyes.seen_from if self._tried else None
        distances = self.walker.planner.distances(self.me.here, new) if new else ()
        ranked = [
            (far + _aslant(spot, point, seen_from), spot)
            for far, spot in zip(distances, new, strict=True)
            if math.isfinite(far)
        ]
        if not ranked:
            return None
        self._tried.append(min(ranked)[1])
        return self._tried[-1]

    def _is_close(self) -> bool:
        target = self.eyes.target
        return target is not None and self.eyes.seen_at == self.me.now.tick and target.distance < _FOUND_M

    def _check(self, target: Detection) -> Deed:
        """Whether the target is in view from here; after several tries without, it is taken for gone."""
        yield from self.me.look_at(target.position)
        since = self.me.now.tick
        yield from self.me.rest(0.4)
        if self.eyes.seen_at >= since:
            return True
        if self._tries > _PATIENCE:
            self.anew()
            self.eyes.lose()
        return False

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


def _aslant(spot: Vec2, point: Vec3, seen_from: Vec2 | None) -> float:
    """How far [rad] a spot lies off the line along which an object was seen; 0 when that does not matter."""
    if seen_from is None:
        return 0.0
    a = math.atan2(spot[1] - point[1], spot[0] - point[0])
    return abs(wrap(a - math.atan2(seen_from[1] - point[1], seen_from[0] - point[0])))


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
