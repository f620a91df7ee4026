"""Following an instruction that describes the way to a landmark, by what is seen on the way.

People are told the instruction once. Of its steps they keep as many as working memory holds, four chunks (Cowan 2001,
"The magical number 4 in short-term memory"), and always the last one, their goal. Which of the others are lost is
random. Where a step is missing they look for the landmark as they look for objects, or make for the place that a robot
has named, if they accepted its message. Everywhere they take the direct way as soon as they have noticed the landmark
itself.

Sides are relative to how a room was entered (`hthor.navigation.directions`). Landmarks that are only walked past change
nothing for the participant; what kind of room they have entered is not checked. Both are our choice.
"""

import math
from collections.abc import Callable, Sequence
from functools import partial

from hthor.errors import HthorError
from hthor.geometry.plane import wrap
from hthor.humans.core.trial_context import Behaviour, HumanContext
from hthor.humans.memory.spatial_memory import KnownDoorway, KnownPlace
from hthor.humans.motor.approach import viewpoints_of_place
from hthor.humans.search.exploration import Exploration
from hthor.humans.search.option_choice import OptionChoice
from hthor.navigation import directions
from hthor.navigation.directions import BEARINGS, Direction, off_side
from hthor.types import WALKERS, Vec2, Vec3

CHUNKS = 4
"""[count] How many steps of an instruction people keep in mind. Source: Cowan 2001."""
_OFF_RAD = math.radians(60.0)
"""[rad] By how much a doorway may be off the side that the instruction names. Our choice."""
_BEYOND_M = 0.6
"""[m] How far behind a doorway people walk when they go through it. Our choice."""
_INSIDE_M = 0.4
"""[m] How far behind a doorway people notice that they are in another room. Our choice."""
_OPENING_M = (2.0, 3.0, 4.0, 1.2)
"""[m] How far away people look for an opening without a door, in this order. Our choice."""
_AT_LANDMARK_M = 1.2
"""[m] Distance from a landmark at which people turn. Our choice."""
_TRIES = 4
"""[count] Tries to find a step's door: at once, after a look round, and twice after walking on. Our choice."""
_VENTURE_M = (1.5, 0.8)
"""[m] How far people walk on, in this order, when they see no door that fits a step. Our choice."""
_STAND_S = 3.0
"""[s] How long people stand where they think that the way ends, before they look again. Our choice."""


class InstructionFollowing:
    """The walk to a landmark. Made where the participant stands at the start, which the first side refers to.

    Attributes:
        steps: what the participant has kept of the instruction, without its end; None for a step that was forgotten.
    """

    def __init__(self, exploration: Exploration, search: OptionChoice) -> None:
        self.exploration, self.human = exploration, exploration.human
        self.memory, self.walker, self.search = exploration.memory, exploration.walker, search
        task, pose = self.human.task, self.human.now.pose
        self.walks = WALKERS[task.target] == self.human.seat
        self.steps = remembered(self.human, _passages(task.instruction))
        self._room, self._place, self._heading = self.human.now.room, (pose.x, pose.y), pose.yaw
        self._came = ""
        self._failed: set[str] = set()
        self._told: Vec3 | None = None

    def follow(self) -> Behaviour:
        """Walk step by step, look for the landmark where the steps end, and stop there."""
        while self.steps and not self._knows_end():
            step = self.steps[0]
            if self.human.now.room == self._room:  # if not, the step was done when something else came up
                yield from self._take(step) if step is not None else self._search(partial(self._has_left, self._room))
            lost = step is not None and step.act != "turn" and self.human.now.room == self._room
            self.steps = [] if lost else self.steps[1:]
            if self.human.now.room != self._room:
                self._enter()
        yield from self._stop_at_end()
        return True

    def go_to(self, position: Vec3) -> Behaviour:
        """Walk to the landmark at the ``position`` [m] that somebody named: by the steps, else by the map."""
        self._told = position
        return (yield from self.follow())

    @property
    def uses_map(self) -> bool:
        """Whether the participant follows the map to a place that somebody named, because the steps do not lead on."""
        return self._told is not None and not (self.steps and self.steps[0] is not None)

    def _take(self, step: Direction) -> Behaviour:
        """One step: through a passage, or a turn at a landmark."""
        if step.act == "turn":
            return (yield from self._turn(step))
        for number in range(_TRIES):
            room = self.human.now.room
            if number > 1:  # nothing fits from here: walk on, first ahead and then towards the side
                yield from self._venture(0.0 if number == 2 else BEARINGS[step.side or "ahead"], room)
            if number > 0:
                yield from self.exploration.look_round(self.human.traits.scan)
                if not self._came:
                    self._recognise_entrance()
            doorway = self._doorway(step) if step.act == "door" else None
            if doorway is not None:
                yield from self._go_through(doorway)
            elif step.act == "opening":
                yield from self._cross(step)
            if self.human.now.room != room or self._knows_end():
                return True
        return False

    def _venture(self, bearing: float, room: str) -> Behaviour:
        """Walk on for a bit, in a direction relative to how the room was entered."""
        angle = self._heading + bearing
        x, y = self.human.here
        for metres in _VENTURE_M:
            spot = (x + metres * math.cos(angle), y + metres * math.sin(angle))
            if (yield from self.walker.go(spot, within=_INSIDE_M, stop=lambda: self._has_left(room))):
                return True
        return False

    def _turn(self, step: Direction) -> Behaviour:
        """Walk up to a landmark and turn there; leave the step out if the landmark was not noticed."""
        mark = self._nearest(step.landmark)
        if mark is None:
            return False
        yield from self.walker.go(
            mark.centre[:2], within=_AT_LANDMARK_M / 2, stop=lambda: mark.distance(self.human.here) < _AT_LANDMARK_M
        )
        away = math.atan2(mark.centre[1] - self._place[1], mark.centre[0] - self._place[0])
        self._place, self._heading = self.human.here, away + BEARINGS[step.side or "ahead"]
        return True

    def _doorway(self, step: Direction) -> KnownDoorway | None:
        """The doorway of this room that fits a step best; None when none fits."""
        doors = [
            door
            for door in self.memory.doorways.values()
            if self._room in door.sides and door.id not in (self._came, *self._failed) and not self._is_beyond(door)
        ]
        fits = [(self._off(step, door.centre), door.id, door) for door in doors]
        off, _, best = min(fits, default=(math.inf, "", None))
        return best if off <= _OFF_RAD else None

    def _is_beyond(self, doorway: KnownDoorway) -> bool:
        """Whether a doorway was seen through another one, so that it belongs to the next room."""
        others = (other for other in self.memory.doorways.values() if other is not doorway)
        return any(other.is_crossed(self._place, doorway.centre) for other in others if other.id != self._came)

    def _is_inside_another(self, room: str) -> bool:
        """Whether the participant has walked a step into another room, the meant one or not."""
        now, here = self.human.now.room, self.human.here
        return now != room and math.dist(self.memory.entered.get(now, here), here) >= _INSIDE_M

    def _off(self, step: Direction, point: Vec2) -> float:
        """By how much [rad] a place is off a step's side; of a door by a landmark, only the landmark counts."""
        mark = self._nearest(step.landmark) if step.landmark else None
        if mark is not None:
            return _OFF_RAD * min(mark.distance(point) / _AT_LANDMARK_M, 1.0)
        bearing = math.atan2(point[1] - self._place[1], point[0] - self._place[0])
        return off_side(step.side or "ahead", wrap(bearing - self._heading))

    def _go_through(self, doorway: KnownDoorway) -> Behaviour:
        """Walk to a spot behind a doorway."""
        room, (cx, cy), (nx, ny) = self.human.now.room, doorway.centre, doorway.across
        side = (self.human.here[0] - cx) * nx + (self.human.here[1] - cy) * ny
        sign = -1.0 if side > 0.0 else 1.0
        beyond = (cx + sign * _BEYOND_M * nx, cy + sign * _BEYOND_M * ny)
        yield from self.walker.go(beyond, stop=lambda: self._is_inside_another(room) or self._knows_end())
        if self.human.now.room == room:
            self._failed.add(doorway.id)
            return False
        doorway.passed = True
        return True

    def _cross(self, step: Direction) -> Behaviour:
        """Walk towards the side of an opening until another room begins."""
        room, angle = self.human.now.room, self._heading + BEARINGS[step.side or "ahead"]
        for metres in _OPENING_M:
            spot = (self._place[0] + metres * math.cos(angle), self._place[1] + metres * math.sin(angle))
            yield from self.walker.go(spot, within=_INSIDE_M, stop=lambda: self._has_left(room))
            if self._has_left(room):
                return True
        return False

    def _enter(self) -> None:
        """Note where and how a new room was entered: as the participant walks, or straight through a known doorway."""
        self._room, self._place, self._heading = self.human.now.room, self.human.here, self.human.now.pose.yaw
        self._came, self._failed = "", set()
        self._recognise_entrance()

    def _recognise_entrance(self) -> None:
        """Tell directions from the doorway of this room next to which the participant came in, if it was noticed."""
        here, doors = self._place, self.memory.doorways.values()
        near = min(doors, key=lambda door: (math.dist(door.centre, here), door.id), default=None)
        if near is not None and math.dist(near.centre, here) <= 2 * _BEYOND_M and len(self.memory.entered) > 1:
            (cx, cy), (nx, ny) = near.centre, near.across
            sign = 1.0 if (here[0] - cx) * nx + (here[1] - cy) * ny > 0.0 else -1.0
            self._place, self._heading, self._came = near.centre, math.atan2(sign * ny, sign * nx), near.id

    def _search(self, enough: Callable[[], bool]) -> Behaviour:
        """Make for the place that somebody named, or look for the landmark where it may be."""
        if self._told is not None:
            return (yield from self.exploration.make_for(self._told, enough, self.search))
        return (yield from self.exploration.look_for(self.search, enough))

    def _stop_at_end(self) -> Behaviour:
        """Look for the landmark if it was not noticed yet, go there, and stand."""
        while True:
            if self._end() is None:
                yield from self._search(self._knows_end)
            yield from self._approach_end()
            yield from self.human.rest(_STAND_S)
            yield from self.exploration.look_round(self.human.traits.scan)

    def _approach_end(self) -> Behaviour:
        """Walk to a spot at the landmark's edge, the nearest first."""
        end = self._end()
        if end is None:
            return False
        for spot in self._by_distance(viewpoints_of_place(end, self.walker)):
            if (yield from self.walker.go(spot)):
                yield from self.human.look_at(end.centre)
                return True
        return False

    def _by_distance(self, spots: Sequence[Vec2]) -> list[Vec2]:
        far = self.walker.map.planner.distances(self.human.here, list(spots)) if spots else []
        return [spot for _, spot in sorted(zip(far, spots, strict=True))]

    def _has_left(self, room: str) -> bool:
        return self.human.now.room != room or self._knows_end()

    def _knows_end(self) -> bool:
        return self._end() is not None

    def _end(self) -> KnownPlace | None:
        """The landmark where the way ends, if it was noticed and not forgotten."""
        return self._nearest(self.human.task.destination)

    def _nearest(self, kind: str) -> KnownPlace | None:
        """The nearest known place of a kind."""
        here = self.human.here
        places = [place for place in self.memory.places.values() if place.kind == kind and place.recalled]
        return min(places, key=lambda place: (place.distance(here), place.id), default=None)


def remembered(human: HumanContext, steps: Sequence[Direction]) -> list[Direction | None]:
    """The steps, with None for those that the participant has forgotten: all but `CHUNKS` less the end of the way."""
    order = sorted(range(len(steps)), key=lambda number: human.draw("instruction", number))
    kept = set(order[: CHUNKS - 1])
    return [step if number in kept else None for number, step in enumerate(steps)]


def _passages(instruction: str) -> list[Direction]:
    """The steps in which the participant does something, except the last; none of an instruction in other words."""
    try:
        steps = directions.read(instruction)
    except HthorError:
        return []
    return [step for step in steps if step.act in ("door", "opening", "turn")]
