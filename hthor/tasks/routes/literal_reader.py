"""Follows directions to the letter on a floor plan: the listener that every generated instruction has to satisfy.

It knows no route, only the plan, and makes no guess: at each step exactly one thing must fit the words.
"""

import math
from collections.abc import Sequence

from msgspec import Struct

from hthor.geometry.plane import wrap
from hthor.navigation.directions import Direction, off_side
from hthor.tasks.routes.landmarks import outline_distance
from hthor.tasks.routes.passages import Passage, exits
from hthor.tasks.routes.route import room_at
from hthor.types import HouseSpec, Pose, Thing, Vec2

OFF_RAD = math.radians(60.0)
"""By how much [rad] a door may be off the side that is named. Our choice."""
APART_RAD = math.radians(25.0)
"""By how much [rad] the door that is meant has to fit its side better than any other. Our choice."""
APART_M = 0.5
"""By how much [m] the door "by the sofa" has to be nearer to the sofa than any other. Our choice."""


class Position(Struct, frozen=True, kw_only=True):
    """Where the reader is: a room, a place [m] and a heading [rad] in it, and the passage it came through, if any."""

    room: str
    place: Vec2
    heading: float
    came: Passage | None = None


def follow(house: HouseSpec, start: Pose, directions: Sequence[Direction]) -> tuple[tuple[str, ...], Thing | None]:
    """The passages (ids) that a literal reader goes through, and the thing where it stops.

    The thing is None when the directions cannot be followed: nothing fits a step, or several things do.
    """
    room = room_at(house, (start.x, start.y))
    if room is None:
        return (), None
    now = Position(room=room.id, place=(start.x, start.y), heading=start.yaw)
    doors: list[str] = []
    for step in directions:
        if step.act in ("door", "opening"):
            door = chosen_door(house, now, step)
            if door is None:
                return tuple(doors), None
            doors.append(door.id)
            now = _through(now, door)
            continue
        thing = only_thing(house, now.room, step.landmark)
        if thing is None or step.act == "stop":
            return tuple(doors), thing
        if step.act == "turn":
            now = _turned(now, thing, step)
    return tuple(doors), None


def chosen_door(house: HouseSpec, now: Position, step: Direction) -> Passage | None:
    """The passage that a step means, among those by which the room can be left; None unless exactly one fits."""
    rooms = {room.id: room for room in house.rooms}
    is_door = step.act == "door"
    ways = [way for way in exits(house, now.room) if way.is_door == is_door and way != now.came]
    if step.landmark:
        thing = only_thing(house, now.room, step.landmark)
        best = _clearly_first([(outline_distance(thing, door.middle), door) for door in ways] if thing else [], APART_M)
    else:
        best = _clearly_first([(_off(now, step, door), door) for door in ways], APART_RAD)
        if best is not None and _off(now, step, best) > OFF_RAD:
            best = None
    return best if best is not None and rooms[best.other_side(now.room)].kind == step.room else None


def only_thing(house: HouseSpec, room: str, kind: str) -> Thing | None:
    """The only thing of a kind in a room, None when there is none or are several."""
    found = [thing for thing in house.things if thing.room == room and thing.kind == kind and not thing.parent]
    return found[0] if len(found) == 1 else None


def _off(now: Position, step: Direction, door: Passage) -> float:
    """By how much [rad] a passage is off the side that a step names."""
    x, y = door.middle
    bearing = math.atan2(y - now.place[1], x - now.place[0]) - now.heading
    return off_side(step.side or "ahead", wrap(bearing))


def _clearly_first(rows: list[tuple[float, Passage]], apart: float) -> Passage | None:
    """The passage with the least number, if every other one is larger by at least ``apart``."""
    rows = sorted(rows, key=lambda row: (row[0], row[1].id))
    if not rows or (len(rows) > 1 and rows[1][0] - rows[0][0] < apart):
        return None
    return rows[0][1]


def _through(now: Position, door: Passage) -> Position:
    """Just behind a passage, looking straight ahead."""
    x, y = door.middle
    inside = door.other_side(now.room)
    heading = door.heading(now.place, (x, y))
    return Position(room=inside, place=(x, y), heading=heading, came=door)


def _turned(now: Position, thing: Thing, step: Direction) -> Position:
    """Beside a landmark, after a turn by a right angle from the direction in which it was approached."""
    x, y = thing.centre[0], thing.centre[1]
    came = math.atan2(y - now.place[1], x - now.place[0])
    share = max(0.0, 1.0 - (0.6 + max(thing.size[:2]) / 2) / max(math.dist((x, y), now.place), 1e-9))
    place = (now.place[0] + share * (x - now.place[0]), now.place[1] + share * (y - now.place[1]))
    turn = math.pi / 2 if step.side == "left" else -math.pi / 2
    return Position(room=now.room, place=place, heading=wrap(came + turn), came=now.came)
