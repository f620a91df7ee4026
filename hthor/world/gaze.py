"""Everything that can be looked at in one world, and who sees what of it now; knows nothing of minds or goals."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import catalog
from hthor.geometry import to_house
from hthor.houses.solids import WALL_M
from hthor.types import HUMAN, Detection, Opening, Pose, Thing, Vec3
from hthor.world import sight
from hthor.world.doors import Doors
from hthor.world.objects import Item, Objects
from hthor.world.scene import Scene
from hthor.world.seats import Seat

BODY_RANGE_M = 3.0
"""People and robots are noticed at least this far away."""
_DOORWAY_HEIGHT_M = 1.0
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
        self._scene, self._objects, self._doors, self._seats = scene, objects, doors, seats
        self._items: tuple[Item, ...] = tuple(objects)
        furniture = [_furniture(thing) for thing in statics if _counts(thing)]
        doorways = [_doorway(opening) for opening in openings if opening.passable]
        self._fixed = (*sorted(furniture, key=lambda sight: sight.id), *sorted(doorways, key=lambda sight: sight.id))
        counts = [2] * len(self._items) + [len(sight.points) for sight in self._fixed] + [2] * len(seats)
        self._first = np.concatenate(([0], np.cumsum(counts))).astype(np.int64)
        self._points = np.zeros((int(self._first[-1]), 3))
        names = [item.id for item in self._items] + [sight.id for sight in self._fixed] + [seat.name for seat in seats]
        self._own = np.array([scene.span.get(name, (0, 0)) for name in names], np.int64)
        begin = 2 * len(self._items)
        fixed = [point for sight in self._fixed for point in sight.points]
        self._points[begin : begin + len(fixed)] = np.array(fixed).reshape(-1, 3)
        self._bodies = begin + len(fixed)
        self._reach = {seat.name: self._ranges(seat) for seat in seats}
        self._present = np.zeros(len(self._items), np.bool_)
        self._near = np.zeros(len(self._items))
        self._version = -1

    def detections(self, seat: Seat) -> tuple[Detection, ...]:
        """What the seat's detector reports now, by id."""
        self._refresh()
        for number, other in enumerate(self._seats):
            row, pose, height = self._bodies + 2 * number, other.pose, other.spec.height
            self._points[row] = (pose.x, pose.y, 0.5 * height)
            self._points[row + 1] = (pose.x, pose.y, 0.9 * height)
        reach = self._reach[seat.name]
        reach[: len(self._items)] = np.where(self._present, seat.spec.sight_range, 0.0)
        seen = self._see(seat, reach, len(reach))
        found = [self._detection(index, seat) for index in seen.nonzero()[0].tolist()]
        return tuple(sorted(found, key=lambda detection: detection.id))

    def in_view(self, seat: Seat, reach: float) -> tuple[str, ...]:
        """Ids of the objects that the seat has in view within ``reach`` [m] of its eye, or in its hand."""
        self._refresh()
        count = len(self._items)
        if not count:
            return ()
        np.multiply(self._present, reach, out=self._near)
        seen = self._see(seat, self._near, count)
        if not seen.any() and not seat.holding:
            return ()
        return tuple(
            item.id for item, visible in zip(self._items, seen, strict=True) if visible or item.held_by == seat.name
        )

    def _see(self, seat: Seat, reach: Any, count: int) -> Any:
        scene, points = self._scene, self._points[: self._first[count]]
        view = sight.camera(seat.pose, seat.spec)
        small, first, own = len(self._items), self._first[: count + 1], self._own[:count]
        solids = scene.half, scene.pos, scene.mat, scene.radius, scene.ids
        return sight.see(view, reach, small, points, first, own, *solids)

    def _refresh(self) -> None:
        if self._version == self._objects.changes:
            return
        self._version = self._objects.changes
        for index, item in enumerate(self._items):
            self._present[index] = item.present
            self._points[2 * index : 2 * index + 2] = sight.points(item.position, item.size)

    def _ranges(self, seat: Seat) -> Any:
        reach = np.full(len(self._own), seat.spec.sight_range)
        for number, other in enumerate(self._seats, len(reach) - len(self._seats)):
            reach[number] = 0.0 if other is seat else max(BODY_RANGE_M, seat.spec.sight_range)
        return reach

    def _detection(self, index: int, seat: Seat) -> Detection:
        if index < len(self._items):
            return _of_item(self._items[index], seat)
        index -= len(self._items)
        if index < len(self._fixed):
            return self._of_fixed(self._fixed[index], seat)
        return _of_body(self._seats[index - len(self._fixed)], seat)

    def _of_fixed(self, thing: Sight, seat: Seat) -> Detection:
        leaf = self._doors.get(thing.id)
        state = "" if leaf is None else "open" if leaf.open else "closed"
        return Detection(
            id=thing.id,
            kind=thing.kind,
            family=thing.family,  # type: ignore[arg-type]
            position=thing.position,
            size=thing.size,
            yaw=thing.yaw,
            distance=_distance(seat, thing.position),
            state=state,
        )


def _distance(seat: Seat, point: Vec3) -> float:
    return math.dist(sight.eye(seat.pose, seat.spec), point)


def _of_item(item: Item, seat: Seat) -> Detection:
    return Detection(
        id=item.id,
        kind=item.kind,
        family="object",
        position=item.position,
        size=item.size,
        yaw=item.yaw,
        distance=_distance(seat, item.position),
        support=item.support,
        held_by=item.held_by,
    )


def _of_body(other: Seat, seat: Seat) -> Detection:
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
        distance=_distance(seat, position),
    )


def _counts(thing: Thing) -> bool:
    """Small things that lie about on others are scenery, not furniture."""
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
