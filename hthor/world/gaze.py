"""Everything that can be looked at in one world, and who sees what of it now; knows nothing of minds or goals."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from copy import copy
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from hthor import catalog
from hthor.geometry import to_house
from hthor.houses.solids import WALL_M
from hthor.types import HUMAN, Detection, Opening, Pose, Thing, Vec2, Vec3
from hthor.world import glance, sight
from hthor.world.doors import Doors
from hthor.world.objects import Item, Objects
from hthor.world.scene import Scene
from hthor.world.seats import Seat

BODY_RANGE_M = 3.0
"""People and robots are noticed at least this far away."""
CLUTTER_RANGE_M = 2.0
"""The many small things of a house that no task asks for are noticed within this."""
_DOORWAY_HEIGHT_M = 1.0
_ROUNDING_M = 1e-6
_INSET, _PROUD_M = 0.85, 0.02
"""A piece of furniture is looked for at its upper corners, pulled in to this share, and just off its surfaces."""


class Sight(Struct, frozen=True):
    """What stays the same about a thing that never moves: the detection's fields but for distance and state."""

    id: str
    kind: str
    family: str
    position: Vec3
    size: Vec3
    yaw: float
    points: tuple[Vec3, ...]


class _Look:
    """What a seat saw last: ``records`` are of what does not move, from the eye at ``place``."""

    __slots__ = ("found", "place", "records", "version")

    def __init__(self) -> None:
        self.version, self.place = (-1, -1, -1), (math.nan, math.nan)
        self.records: dict[int, Detection] = {}
        self.found: tuple[Detection, ...] = ()


class Gaze:
    """Looks for objects, furniture, doorways and bodies, in this order, in one compiled call."""

    def __init__(
        self,
        scene: Scene,
        objects: Objects,
        doors: Doors,
        statics: Iterable[Thing],
        openings: Iterable[Opening],
        seats: Sequence[Seat],
    ) -> None:
        self._scene, self._objects, self._doors, self._seats = (
            scene,
            objects,
            doors,
            seats,
        )
        self._items: tuple[Item, ...] = tuple(objects)
        furniture = [_furniture(thing) for thing in statics if _counts(thing)]
        doorways = [_doorway(opening) for opening in openings if opening.passable]
        self._fixed = (
            *sorted(furniture, key=lambda sight: sight.id),
            *sorted(doorways, key=lambda sight: sight.id),
        )
        counts = [2] * len(self._items) + [len(sight.points) for sight in self._fixed] + [2] * len(seats)
        self._first = np.concatenate(([0], np.cumsum(counts))).astype(np.int64)
        self._points = np.zeros((int(self._first[-1]), 3))
        names = [item.id for item in self._items] + [sight.id for sight in self._fixed] + [seat.name for seat in seats]
        self._own = np.array([scene.span.get(name, (0, 0)) for name in names], np.int64)
        begin = 2 * len(self._items)
        fixed = [point for sight in self._fixed for point in sight.points]
        self._points[begin : begin + len(fixed)] = np.array(fixed).reshape(-1, 3)
        self._spots = self._points[begin : begin + len(fixed)].T.copy()
        self._bodies = begin + len(fixed)
        self._reach = {seat.name: self._ranges(seat) for seat in seats}
        self._tops = np.array([0.4 * item.size[2] for item in self._items])
        self._clutter = np.array([item.clutter for item in self._items], np.bool_)
        self._near = np.zeros(len(self._items))
        self._version = -1
        self._apart: dict[tuple[str, float], tuple[int, Vec2, float]] = {}
        self._reach_version = dict.fromkeys(self._reach, -2)
        self._stood: list[Pose | None] = [None] * len(seats)
        for number, seat in enumerate(seats):
            self._points[self._bodies + 2 * number, 2] = 0.5 * seat.spec.height
            self._points[self._bodies + 2 * number + 1, 2] = 0.9 * seat.spec.height
        self._balls = np.array([_ball(sight.points) for sight in self._fixed]).reshape(-1, 4).T.copy()
        self._order = np.array(sorted(range(len(names)), key=names.__getitem__), np.int64)
        self._targets = {
            count: (self._points[: self._first[count]], self._first[: count + 1], self._own[:count])
            for count in (len(self._items), len(names))
        }
        self._every = np.arange(len(self._items))
        self._spheres: Any = None
        self._shown = -1
        self._records: list[Detection] = []
        self._sure = {seat.name: np.zeros((3, len(fixed))) for seat in seats}
        self._moves = 0
        self._looks = {seat.name: _Look() for seat in seats}

    def detections(self, seat: Seat) -> tuple[Detection, ...]:
        """What the seat's detector reports now, by id; the same records as long as neither eye nor world changes."""
        self._refresh()
        moved = False
        for number, other in enumerate(self._seats):
            if self._stood[number] is not other.pose:
                self._stood[number] = pose = other.pose
                row = self._bodies + 2 * number
                self._points[row, 0] = self._points[row + 1, 0] = pose.x
                self._points[row, 1] = self._points[row + 1, 1] = pose.y
                moved = True
        if moved:
            self._moves += 1
        look, pose, version = self._looks[seat.name], seat.pose, (self._moves, self._version, self._doors.changes)
        if look.version == version:
            return look.found
        if look.place != (pose.x, pose.y) or look.version[1:] != version[1:]:
            look.place, look.records = (pose.x, pose.y), {}
        look.version = version
        reach = self._within(seat)
        seen = self._see(seat, reach, len(reach), self._order, self._sure[seat.name]).tolist()
        eye = sight.eye(pose, seat.spec)
        look.found = tuple([look.records.get(index) or self._detection(index, eye, look.records) for index in seen])
        return look.found

    def _within(self, seat: Seat) -> Any:
        """How far each target is noticed [m], 0 for objects that are not in the episode."""
        reach = self._reach[seat.name]
        if self._reach_version[seat.name] != self._objects.roster:
            self._reach_version[seat.name] = self._objects.roster
            small = min(CLUTTER_RANGE_M, seat.spec.sight_range)
            reach[: len(self._items)] = np.where(self._clutter, small, seat.spec.sight_range) * self._objects.present
        return reach

    def in_view(self, seat: Seat, reach: float) -> tuple[str, ...]:
        """Ids of the objects that the seat has in view within ``reach`` [m] of its eye, or in its hand."""
        self._refresh()
        count = len(self._items)
        if not count:
            return ()
        if not self._any_near(seat, reach):
            return ()
        np.multiply(self._objects.present, reach, out=self._near)
        seen = set(self._see(seat, self._near, count, self._every, self._sure[seat.name]).tolist())
        if not seen and not seat.holding:
            return ()
        return tuple(item.id for item in self._items if item.number in seen or item.held_by == seat.name)

    def _any_near(self, seat: Seat, reach: float) -> bool:
        """Whether any object's centre is within ``reach`` [m] of the eye; worked out anew after a long enough way."""
        x, y, z = sight.eye(seat.pose, seat.spec)
        version, there, spare = self._apart.get((seat.name, reach), (-1, (x, y), 0.0))
        if version != self._version or math.dist(there, (x, y)) >= spare:
            spare = sight.nearest(x, y, z, self._objects.positions) - reach - _ROUNDING_M
            self._apart[seat.name, reach] = self._version, (x, y), spare
            return bool(spare <= 0.0)
        return False

    def _see(self, seat: Seat, reach: Any, count: int, order: Any, sure: Any) -> Any:
        scene, view = self._scene, sight.camera(seat.pose, seat.spec)
        small, (points, first, own) = len(self._items), self._targets[count]
        if self._spheres is None:
            self._spheres = np.vstack([scene.pos[scene.walls].T, scene.radius[scene.walls]])
        solids = scene.half, scene.pos, scene.mat, scene.radius, scene.walls, self._spheres, scene.loose
        return glance.see(view, reach, small, points, first, own, self._spots, self._balls, *solids, sure, order)

    def _refresh(self) -> None:
        if self._version == self._objects.changes:
            return
        self._version = self._objects.changes
        end = 2 * len(self._items)
        self._points[0:end:2] = self._points[1:end:2] = self._objects.positions
        self._points[1:end:2, 2] += self._tops

    def _ranges(self, seat: Seat) -> Any:
        reach = np.full(len(self._own), seat.spec.sight_range)
        for number, other in enumerate(self._seats, len(reach) - len(self._seats)):
            reach[number] = 0.0 if other is seat else max(BODY_RANGE_M, seat.spec.sight_range)
        return reach

    def _detection(self, index: int, eye: Vec3, records: dict[int, Detection]) -> Detection:
        """A new record, which is kept in ``records`` unless it is of a body."""
        if index < len(self._items):
            records[index] = found = _of_item(self._items[index], eye)
            return found
        place = index - len(self._items)
        if place < len(self._fixed):
            records[index] = found = self._of_fixed(place, eye)
            return found
        return _of_body(self._seats[place - len(self._fixed)], eye)

    def _of_fixed(self, place: int, eye: Vec3) -> Detection:
        """A copy of the record that fits from everywhere, with its distance."""
        if self._shown != self._doors.changes:
            self._shown = self._doors.changes
            self._records = [self._record(thing) for thing in self._fixed]
        found: Detection = copy(self._records[place])
        force_setattr(found, "distance", math.dist(eye, found.position))  # nobody else has seen it yet
        return found

    def _record(self, thing: Sight) -> Detection:
        leaf = self._doors.get(thing.id)
        return Detection(
            id=thing.id,
            kind=thing.kind,
            family=thing.family,  # type: ignore[arg-type]
            position=thing.position,
            size=thing.size,
            yaw=thing.yaw,
            distance=math.nan,
            state="" if leaf is None else "open" if leaf.open else "closed",
        )


def _of_item(item: Item, eye: Vec3) -> Detection:
    return Detection(
        id=item.id,
        kind=item.kind,
        family="object",
        position=item.position,
        size=item.size,
        yaw=item.yaw,
        distance=math.dist(eye, item.position),
        support=item.support,
        held_by=item.held_by,
    )


def _of_body(other: Seat, eye: Vec3) -> Detection:
    pose: Pose = other.pose
    position = (pose.x, pose.y, other.spec.height / 2)
    human = other.name == HUMAN
    return Detection(
        id=other.name,
        kind="person" if human else other.spec.name,
        family="person" if human else "robot",
        position=position,
        size=(2 * other.spec.radius, 2 * other.spec.radius, other.spec.height),
        yaw=pose.yaw,
        distance=math.dist(eye, position),
    )


def _ball(points: Sequence[Vec3]) -> tuple[float, float, float, float]:
    """Middle and radius [m] of a ball around the points, a little larger than it need be."""
    x, y, z = (0.5 * (min(axis) + max(axis)) for axis in zip(*points, strict=True))
    return x, y, z, max(math.dist((x, y, z), point) for point in points) + _ROUNDING_M


def _counts(thing: Thing) -> bool:
    """Small things that lie about are scenery, not furniture."""
    return not thing.parent or catalog.kind(thing.kind).receptacle


def _furniture(thing: Thing) -> Sight:
    kind = catalog.kind(thing.kind)
    w, d, h = (extent / 2 for extent in thing.size)
    local: list[Vec3] = [(0.0, 0.0, 0.0), (0.0, 0.0, h + _PROUD_M)]
    for surface in kind.surfaces(thing.size):
        if not surface.inside:
            local.append((surface.centre[0], surface.centre[1], surface.centre[2] + _PROUD_M))
    local += [(sx * _INSET * w, sy * _INSET * d, _INSET * h) for sx in (-1, 1) for sy in (-1, 1)]
    if kind.openable:
        local.append((0.0, d + _PROUD_M, 0.0))
    points = tuple(to_house(point, thing.centre, thing.yaw) for point in local)
    return Sight(thing.id, thing.kind, "furniture", thing.centre, thing.size, thing.yaw, points)


def _doorway(opening: Opening) -> Sight:
    (ax, ay), (bx, by) = opening.a, opening.b
    middle = ((ax + bx) / 2, (ay + by) / 2, _DOORWAY_HEIGHT_M)
    size = (math.dist(opening.a, opening.b), WALL_M, opening.high - opening.low)
    yaw = math.atan2(by - ay, bx - ax)
    return Sight(opening.id, "doorway", "doorway", middle, size, yaw, (middle,))
