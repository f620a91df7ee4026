"""Writes the directions of a route: the doors on the way, the rooms behind them, and the landmarks in sight.

A speaker and a listener: the writer proposes directions, from the most telling to the plainest, and takes the first
that `literal_reader.follow` follows through the same doors to the same end.
"""

import math
from collections.abc import Iterator

from hthor.geometry.plane import wrap
from hthor.navigation.directions import Act, Direction, Side, nearest_side, off_side
from hthor.tasks.routes import literal_reader
from hthor.tasks.routes.landmarks import (
    SHARP_RAD,
    Passing,
    in_sight,
    is_landmark,
    is_unambiguous,
    passings,
    places_along,
)
from hthor.tasks.routes.literal_reader import OFF_RAD
from hthor.tasks.routes.passages import Passage
from hthor.tasks.routes.route import Route, Stretch
from hthor.types import HouseSpec, Pose, Thing, Vec2

_BESIDE_RAD = math.radians(40.0)
"""By how much [rad] a landmark may be off "on your left" where the route is next to it. Our choice."""


def directions_of(house: HouseSpec, start: Pose, route: Route, landmark: Thing) -> tuple[Direction, ...] | None:
    """Directions that lead a literal reader along the route's doors to the landmark; None when none do.

    Args:
        start: where the route begins, and the heading that the first room's sides refer to.
        landmark: where the route ends. It is in sight from the last stretch.
    """
    doors = tuple(stretch.exit.id for stretch in route.stretches if stretch.exit is not None)
    if not in_sight(house, landmark, places_along(route.stretches[-1].points)):
        return None
    done: list[Direction] = []
    for number, stretch in enumerate(route.stretches):
        last = Direction(act="stop", landmark=landmark.kind)
        for steps in _proposals(house, route, number, landmark):
            rest = () if stretch.exit is None else (last,)
            passed, _ = literal_reader.follow(house, start, (*done, *steps, *rest))
            if passed[: number + 1] == doors[: number + 1]:
                done += steps
                break
        else:
            return None
    reached = literal_reader.follow(house, start, done)
    return tuple(done) if reached == (doors, landmark) else None


def _proposals(house: HouseSpec, route: Route, number: int, landmark: Thing) -> Iterator[list[Direction]]:
    """Directions for one stretch: with what it passes and where it turns, with one of these, with none."""
    stretch = route.stretches[number]
    found = [one for one in passings(house, stretch) if one.thing.id != landmark.id]
    turns = [one for one in found if abs(one.bend) >= SHARP_RAD]
    sides = [one for one in found if _side_of(one) is not None and abs(one.bend) < SHARP_RAD]
    ends = list(_endings(house, stretch, landmark))
    for turn in turns:
        before = [_past(one) for one in sides if one.at < turn.at][-1:]
        step = Direction(act="turn", side="left" if turn.bend > 0.0 else "right", landmark=turn.thing.kind)
        yield from ([*before, step, end] for end in _after_turn(house, stretch, turn, landmark))
    for one in sides:
        yield from ([_past(one), end] for end in ends if _agrees(stretch, one, end))
    yield from ([end] for end in ends)


def _endings(house: HouseSpec, stretch: Stretch, landmark: Thing) -> Iterator[Direction]:
    """How a stretch may end, seen from where it begins: by its door's side, or also by a landmark next to the door."""
    if stretch.exit is None:
        yield Direction(act="stop", landmark=landmark.kind)
        return
    door, room = stretch.exit, _kind_behind(house, stretch)
    side = _side_from(stretch.points[0], stretch.heading, door.middle)
    yield Direction(act=_act(door), side=side, room=room)
    near = (thing for thing in house.things if thing.room == stretch.room.id and is_landmark(thing))
    for thing in near:
        if is_unambiguous(house, thing, places_along(stretch.points)):
            yield Direction(act=_act(door), side=side, landmark=thing.kind, room=room)


def _after_turn(house: HouseSpec, stretch: Stretch, turn: Passing, landmark: Thing) -> Iterator[Direction]:
    """How a stretch may end after a turn, which its door's side then refers to."""
    if stretch.exit is None:
        yield Direction(act="stop", landmark=landmark.kind)
        return
    side = _side_from(turn.place, turn.heading + turn.bend, stretch.exit.middle)
    yield Direction(act=_act(stretch.exit), side=side, room=_kind_behind(house, stretch))


def _act(passage: Passage) -> Act:
    return "door" if passage.is_door else "opening"


def _agrees(stretch: Stretch, one: Passing, end: Direction) -> bool:
    """Whether a door's side is the same for somebody who has already walked past the landmark."""
    if stretch.exit is None or end.side is None:
        return True
    x, y = stretch.exit.middle
    bearing = math.atan2(y - one.place[1], x - one.place[0]) - one.heading
    return off_side(end.side, wrap(bearing)) <= OFF_RAD


def _past(one: Passing) -> Direction:
    return Direction(act="past", side=_side_of(one), landmark=one.thing.kind)


def _side_of(one: Passing) -> Side | None:
    """On which hand a landmark is that the route goes past; None when it is more in front or behind."""
    side = nearest_side(one.bearing)
    return side if side in ("left", "right") and off_side(side, one.bearing) <= _BESIDE_RAD else None


def _side_from(place: Vec2, heading: float, point: Vec2) -> Side:
    return nearest_side(wrap(math.atan2(point[1] - place[1], point[0] - place[0]) - heading))


def _kind_behind(house: HouseSpec, stretch: Stretch) -> str:
    """The kind of the room behind the door by which a stretch leaves its room."""
    assert stretch.exit is not None
    other = stretch.exit.other_side(stretch.room.id)
    return next(room.kind for room in house.rooms if room.id == other)
