"""How a person looks for something: doorways, rooms, furniture one by one."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from functools import partial

from hthor.geometry.plane import to_house
from hthor.humans.core.trial_context import Deed, Subject
from hthor.humans.memory.spatial_memory import Memory, Place
from hthor.humans.motor.locomotion import Walker, never
from hthor.humans.motor.manipulation import Hands
from hthor.humans.perception.perception import Eyes
from hthor.humans.search.option_choice import Option, Search
from hthor.navigation.frontier import frontiers
from hthor.types import Motion, Open, Vec2, Vec3, Wait

_INSIDE_M = 0.5
_SWEEP_RAD = 1.0
_NEXT = 0.6
_PAUSE_S = 0.3
_BESIDE_M, _ROAM_S = 1.0, 40.0


class Exploring:
    """Going through the house. ``fresh`` is where a room was entered that was not looked round in yet."""

    def __init__(self, me: Subject, eyes: Eyes, memory: Memory, walker: Walker, hands: Hands) -> None:
        self.me, self.eyes, self.memory, self.walker, self.hands = me, eyes, memory, walker, hands
        self.fresh: Vec2 | None = None
        self._turns = 0

    def look_for(self, search: Search, enough: Callable[[], bool]) -> Deed:
        """Do what ``search`` chooses, one thing after the other, until it is ``enough``."""
        while not enough():
            if self.fresh is not None:
                self.fresh = None
                yield from self.look_round(self.me.traits.scan)
                continue
            option, since = search.choose(), self.me.now.tick
            if option is None:
                yield from self._wander(search, enough)
            elif option.place is not None:
                yield from self._inspect(option.place, option.spot, partial(search.done, option.place))
            else:
                yield from self._pass(option, enough)
            if self.me.now.tick == since:
                yield Wait(seconds=_PAUSE_S)
        return True

    def make_for(self, point: Vec3, known: Callable[[], bool], search: Search) -> Deed:
        """Go near a point [m] until what is there is ``known`` by sight.

        When it is not, it is in another room: by a doorway not gone through yet, or one entered elsewhere, whichever
        comes closer to it; and so on for a while.
        """
        until = self.me.now.tick + round(_ROAM_S / self.me.tick_s)
        tried: list[str] = []

        def enough() -> bool:
            return known() or self.me.now.tick >= until

        while not enough():
            since = self.me.now.tick
            tried.append(self.me.now.room)
            yield from self.walker.go((point[0], point[1]), within=_BESIDE_M, stop=enough)
            self.fresh, option = None, self._elsewhere(point, tried)
            if option is not None and not enough():
                tried.append(option.name)
                yield from self._pass(option, enough)
                yield from self._take_in(enough)
            if option is None or self.me.now.tick == since:
                yield from self.look_for(search, enough)
        return known()

    def _take_in(self, enough: Callable[[], bool]) -> Deed:
        """Look round in a room that was entered just now."""
        return (yield from self._sweep(enough)) if self.fresh is not None else True

    def _elsewhere(self, point: Vec3, tried: list[str]) -> Option | None:
        """The entrance to another room that is nearest to a point as the crow flies."""
        doors = [door for door in self.memory.doorways.values() if door.sides and not door.passed]
        ways = [Option(name=door.id, value=0.0, spot=door.beyond, doorway=door) for door in doors]
        ways += [Option(name=room, value=0.0, spot=spot) for room, spot in self.memory.entered.items()]
        left = [option for option in ways if option.name not in tried]
        return min(left, key=lambda option: (math.dist(option.spot, point[:2]), option.name), default=None)

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
        if place.state != "closed" or not (yield from self.open(place)):
            gazes = _gazes(place, me.here)
            for gaze in gazes:
                yield from me.look_at(gaze)
                yield from me.rest(me.traits.t_dwell * (1.0 if len(gazes) == 1 else _NEXT))
        memory.expose(place, me.traits.e_done, me.now.tick)
        self.eyes.attention = None
        return True

    def open(self, place: Place) -> Generator[Motion, None, str]:
        """Open the place; returns why not, empty when it worked."""
        yield from self.me.look_at(place.centre)
        reason = yield from self.hands.do(Open(thing=place.id), f"open {place.id}")
        if not reason:
            place.state = "open"
        return reason

    def retrace(self, enough: Callable[[], bool]) -> Deed:
        """Look round here and in one room after the other that was entered before, the nearest first."""
        left = dict(self.memory.entered)
        yield from self.look_round(self.me.traits.scan)
        while not enough():
            left.pop(self.me.now.room, None)
            if not left:
                return False
            far = self.walker.planner.distances(self.me.here, list(left.values()))
            yield from self.walker.go(left.pop(min(zip(far, left, strict=True))[1]), stop=enough)
            yield from self._sweep(enough)
        return True

    def _sweep(self, enough: Callable[[], bool]) -> Deed:
        if not enough():
            yield from self.look_round(self.me.traits.scan)
        return True

    def _wander(self, search: Search, enough: Callable[[], bool]) -> Deed:
        """Nothing comes to mind: go where the known floor ends, search something again, or go back and look round."""
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
        return (yield from self.retrace(enough))

    def look_round(self, angle: float) -> Deed:
        """Look round the room."""
        self.fresh = None
        self._turns += 1
        yield from self.me.look_round(angle, "round", self._turns)
        return True

    def _inside(self) -> bool:
        """Whether the person has taken a step into a room not looked round in yet."""
        return self.fresh is not None and math.dist(self.fresh, self.me.here) > _INSIDE_M


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
