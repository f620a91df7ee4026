"""How a participant searches the house: doorways, rooms, furniture one by one."""

import math
from collections.abc import Callable, Generator
from functools import partial

from hthor.geometry.plane import to_house
from hthor.humans.core.trial_context import Behaviour, HumanContext
from hthor.humans.memory.spatial_memory import KnownPlace, SpatialMemory
from hthor.humans.motor.locomotion import Walker, never
from hthor.humans.motor.manipulation import Hands
from hthor.humans.perception.perception import Eyes
from hthor.humans.search.option_choice import OptionChoice
from hthor.humans.search.option_description import Option
from hthor.navigation.frontier import frontiers
from hthor.types import Motion, Open, Vec2, Vec3, Wait

_INSIDE_M = 0.5
"""[m] A room is entered from this depth on, a doorway passed within this distance of its far side. Our choice."""
_GAZE_WIDTH_RAD = 1.0
"""[rad] Width of furniture that one gaze covers; a wider piece is looked at part by part. Our choice."""
_GAZE_SLACK = 0.3
"""[gazes] How much wider than its gazes a piece may be, in widths of a gaze. Our choice."""
_TABLE_M = 1.3
"""[m] Open furniture lower than this is looked at on top, anything higher in the middle. Our choice."""
_PART_SHARE = 0.6
"""[ratio] Share of t_dwell for each part of a piece that is looked at part by part. Our choice."""
_PAUSE_S = 0.3
"""[s] A pause when nothing else can be done, such as in front of a blocked doorway. Our choice."""
_BESIDE_M = 1.0
"""[m] Distance at which people stop in front of a place that they know from the map. Our choice."""
_ROAM_S = 40.0
"""[s] How long people try to get near a place on the map before they give up. Our choice."""
_EXPOSURE_UNREACHED = 1.0
"""[exposure] Amount added to a place that cannot be reached, so that others come first. Our choice."""
_MAX_FAILURES = 1
"""[count] A doorway counts as passed after more failed attempts than this. Our choice."""


class Exploration:
    """Carries out a search. ``fresh`` [m] is where a room was entered, until the participant looks round in it."""

    def __init__(self, human: HumanContext, eyes: Eyes, memory: SpatialMemory, walker: Walker, hands: Hands) -> None:
        self.human, self.eyes, self.memory, self.walker, self.hands = human, eyes, memory, walker, hands
        self.fresh: Vec2 | None = None
        self._turns = 0

    def look_for(self, search: OptionChoice, enough: Callable[[], bool]) -> Behaviour:
        """Carry out what ``search`` chooses, one option after the other, until ``enough``."""
        while not enough():
            if self.fresh is not None:
                self.fresh = None
                yield from self.look_round(self.human.traits.scan)
                continue
            option, since = search.choose(), self.human.now.tick
            if option is None:
                yield from self._wander(search, enough)
            elif option.place is not None:
                yield from self._inspect(option.place, option.spot, partial(search.is_done, option.place))
            else:
                yield from self._pass(option, enough)
            if self.human.now.tick == since:
                yield Wait(seconds=_PAUSE_S)
        return True

    def make_for(self, point: Vec3, known: Callable[[], bool], search: OptionChoice) -> Behaviour:
        """Go near a point [m] until the place there is ``known`` by sight.

        Until then the point is assumed to be in another room: go to the entrance nearest to it, again and again.
        """
        until = self.human.now.tick + round(_ROAM_S / self.human.tick_s)
        tried: list[str] = []

        def enough() -> bool:
            return known() or self.human.now.tick >= until

        while not enough():
            since = self.human.now.tick
            tried.append(self.human.now.room)
            yield from self.walker.go((point[0], point[1]), within=_BESIDE_M, stop=enough)
            self.fresh, option = None, self._other_room(point, tried)
            if option is not None and not enough():
                tried.append(option.name)
                yield from self._pass(option, enough)
                yield from self._look_round_if_new(enough)
            if option is None or self.human.now.tick == since:
                yield from self.look_for(search, enough)
        return known()

    def _look_round_if_new(self, enough: Callable[[], bool]) -> Behaviour:
        return (yield from self._look_round_unless(enough)) if self.fresh is not None else True

    def _other_room(self, point: Vec3, tried: list[str]) -> Option | None:
        """The entrance to another room that is nearest to a point in a straight line."""
        doors = [door for door in self.memory.doorways.values() if door.sides and not door.passed]
        ways = [Option(name=door.id, value=0.0, spot=door.beyond, doorway=door) for door in doors]
        ways += [Option(name=room, value=0.0, spot=spot) for room, spot in self.memory.entered.items()]
        left = [option for option in ways if option.name not in tried]
        return min(left, key=lambda option: (math.dist(option.spot, point[:2]), option.name), default=None)

    def _pass(self, option: Option, enough: Callable[[], bool]) -> Behaviour:
        """Go through a doorway."""
        arrived = yield from self.walker.go(option.spot, stop=lambda: self._is_inside() or enough())
        doorway = option.doorway
        if doorway is not None:
            doorway.failures += not arrived
            if doorway.failures > _MAX_FAILURES or math.dist(self.human.here, option.spot) < _INSIDE_M:
                doorway.passed = True
        return arrived

    def _inspect(self, place: KnownPlace, spot: Vec2, is_done: Callable[[], bool] = never) -> Behaviour:
        """Go to a place and look at all of it, or pass it by once it ``is_done`` on the way."""
        human, memory = self.human, self.memory
        self.eyes.attention = place
        arrived = yield from self.walker.go(spot, stop=lambda: self._is_inside() or is_done())
        if arrived and (is_done() or self._is_inside()):
            self.eyes.attention = None
            return True
        if not arrived:
            memory.expose(place, _EXPOSURE_UNREACHED, human.now.tick)
            self.eyes.attention = None
            return False
        if place.state != "closed" or not (yield from self.open(place)):
            gazes = _gazes(place, human.here)
            for gaze in gazes:
                yield from human.look_at(gaze)
                yield from human.rest(human.traits.t_dwell * (1.0 if len(gazes) == 1 else _PART_SHARE))
        memory.expose(place, human.traits.e_done, human.now.tick)
        self.eyes.attention = None
        return True

    def open(self, place: KnownPlace) -> Generator[Motion, None, str]:
        """Open the place; returns the reason of a failure, empty when it worked."""
        yield from self.human.look_at(place.centre)
        reason = yield from self.hands.do(Open(thing=place.id), f"open {place.id}")
        if not reason:
            place.state = "open"
        return reason

    def retrace(self, enough: Callable[[], bool]) -> Behaviour:
        """Look round here and then in every room that was entered before, the nearest first."""
        left = dict(self.memory.entered)
        yield from self.look_round(self.human.traits.scan)
        while not enough():
            left.pop(self.human.now.room, None)
            if not left:
                return False
            far = self.walker.map.planner.distances(self.human.here, list(left.values()))
            yield from self.walker.go(left.pop(min(zip(far, left, strict=True))[1]), stop=enough)
            yield from self._look_round_unless(enough)
        return True

    def _look_round_unless(self, enough: Callable[[], bool]) -> Behaviour:
        if not enough():
            yield from self.look_round(self.human.traits.scan)
        return True

    def _wander(self, search: OptionChoice, enough: Callable[[], bool]) -> Behaviour:
        """Act without options: go to where the known floor ends, search a place again, or go back and look round."""
        since = self.human.now.tick
        edges = frontiers(self.walker.map.grid, self.walker.map.planner, self.human.now.pose)
        if edges:
            nearest = min(edges, key=lambda edge: edge.distance)
            arrived = yield from self.walker.go(nearest.centre, stop=self._is_inside)
            if arrived and self.human.now.tick > since:
                return True
        place = search.least_searched()
        spots = search.spots(place) if place is not None else []
        if place is not None and spots:
            return (yield from self._inspect(place, spots[0]))
        return (yield from self.retrace(enough))

    def look_round(self, angle: float) -> Behaviour:
        """Look round the room by ``angle`` [rad]."""
        self.fresh = None
        self._turns += 1
        yield from self.human.look_round(angle, "round", self._turns)
        return True

    def _is_inside(self) -> bool:
        """Whether the participant has stepped into a room not looked round in yet."""
        return self.fresh is not None and math.dist(self.fresh, self.human.here) > _INSIDE_M


def _gazes(place: KnownPlace, here: Vec2) -> list[Vec3]:
    """Points to look at to see all of a place from ``here``: its middle, or parts of a wide one from end to end."""
    w, d, h = place.size
    top = h / 2.0 if h < _TABLE_M and not place.state else 0.0
    ends = [(-w / 2.0, 0.0, top), (w / 2.0, 0.0, top)] if w >= d else [(0.0, -d / 2.0, top), (0.0, d / 2.0, top)]
    a, b = (to_house(end, place.centre, place.yaw) for end in ends)
    bearings = [math.atan2(p[1] - here[1], p[0] - here[0]) for p in (a, b)]
    wide = abs(math.remainder(bearings[1] - bearings[0], 2.0 * math.pi))
    count = max(1, math.ceil(wide / _GAZE_WIDTH_RAD - _GAZE_SLACK))
    shares = [(k + 0.5) / count for k in range(count)]
    return [(a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2]) for s in shares]
