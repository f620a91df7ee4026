"""Everything that can be looked at in one world, and who sees what of it now."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from msgspec.structs import force_setattr

from hthor import rules
from hthor.types import HUMAN, Detection, Opening, Pose, Sighting, Thing, Vec2, Vec3
from hthor.world.model.geom_index import GeomIndex
from hthor.world.perception import view_frustum, visibility_kernel, visible_fraction
from hthor.world.perception.landmarks import Landmark, landmarks, pack_targets
from hthor.world.perception.occluders import Occluders
from hthor.world.state.body_state import BodyState
from hthor.world.state.doors import Doors
from hthor.world.state.objects import MovableObject, Objects

_copy: Any = Detection.__copy__  # type: ignore[attr-defined]
BODY_RANGE_M = 3.0
"""People and robots are noticed at least this far away."""
CLUTTER_RANGE_M = 2.0
"""The many small things of a house that no task asks for are noticed within this."""
SMALL_M = 0.5
"""What is no longer than this is a small thing, one of many that one may overlook among the others."""
_ROUNDING_M = 1e-6
_NOT_SEEN = Sighting()


class _SeatView:
    """A seat's eye, and what it saw last: ``records`` are of what does not move, from ``place``."""

    __slots__ = ("found", "lens", "place", "records", "roster", "seat", "seen", "spare", "spots", "version", "wanted")

    def __init__(self, seat: BodyState, wanted: Any, spots: Any) -> None:
        self.seat, self.wanted, self.spots = seat, wanted, spots
        self.lens = view_frustum.half_fov_tangents(seat.spec)
        self.version, self.place, self.roster = (-1, -1), (math.nan, math.nan), -1
        self.records: dict[int, Detection] = {}
        self.seen: list[int] = []
        self.found: tuple[Detection, ...] = ()
        self.spare: tuple[int, Vec2, float] = (-1, (0.0, 0.0), 0.0)


class Visibility:
    """Looks for objects, furniture, doorways and bodies, in one compiled call.

    Targets are numbered: the objects, then the bodies, then what never moves, furniture before doorways.
    """

    def __init__(
        self,
        scene: GeomIndex,
        objects: Objects,
        doors: Doors,
        statics: Iterable[Thing],
        openings: Iterable[Opening],
        seats: Sequence[BodyState],
    ) -> None:
        self._objects, self._doors, self._seats = objects, doors, seats
        self._items: tuple[MovableObject, ...] = tuple(objects)
        self._fixed = landmarks(statics, openings)
        moving = [item.id for item in self._items] + [seat.name for seat in seats]
        names = [*moving, *(landmark.id for landmark in self._fixed)]
        self._order = np.array(sorted(range(len(names)), key=names.__getitem__), np.int64)
        self._moving, self._count = len(moving), len(self._items)
        self._points = np.zeros((len(moving), 2, 3))
        self._flat = self._points.data.cast("B").cast("d")  # to write single numbers fast
        self._tops = np.array([0.4 * item.size[2] for item in self._items])
        self._clutter = np.array([item.clutter for item in self._items], np.bool_)
        self._small = np.array([max(item.size) <= SMALL_M for item in self._items], np.bool_)
        for number, seat in enumerate(seats, len(self._items)):
            self._points[number, :, 2] = 0.5 * seat.spec.height, 0.9 * seat.spec.height
        own = [scene.span.get(name, (0, 0)) for name in moving]
        self._balls, spots = pack_targets(self._fixed, scene.span)
        self._eyes = {
            seat.name: _SeatView(seat, np.column_stack([self._ranges(seat), own]), spots.copy()) for seat in seats
        }
        self._near = np.array([(0.0, *span) for span in own[: len(self._items)]]).reshape(-1, 3)
        self._nothing = np.zeros((7, 1)), np.zeros((6, 0)), np.arange(len(self._items))
        self._hiders = Occluders(scene)
        self._objects_then = self._doors_then = -1
        self._stood: list[Pose | None] = [None] * len(seats)
        self._records: list[Detection] = []
        self._world = self._moves = 0

    def detections(self, seat: BodyState) -> tuple[Detection, ...]:
        """What the seat's detector reports now, by id; the same records as long as neither eye nor world changes."""
        self._refresh()
        eye, version = self._eyes[seat.name], (self._world, self._moves)
        if eye.version != version:
            pose = seat.pose
            place = (pose.x, pose.y)
            if eye.place != place or eye.version[0] != self._world:
                eye.place, eye.records = place, {}
            eye.version = version
            self._look(eye, pose)
        return eye.found

    def sighting(self, seat: BodyState, id: str) -> Sighting:
        """How well the seat sees an object now; nothing of it for what it does not see, or what is no object."""
        self.detections(seat)
        item, eye = self._objects.get(id), self._eyes[seat.name]
        if item is None or item.number not in eye.seen:
            return _NOT_SEEN
        points = visible_fraction.sample_points(
            item.position, item.size, item.yaw, view_frustum.look_points(item.position, item.size)
        )
        self._near[:, 0] = self._objects.present & self._small
        hiders, pose = self._hiders, seat.pose
        share, beside = visible_fraction.measure(
            pose.x,
            pose.y,
            seat.spec.eye,
            pose.yaw,
            pose.pitch,
            *eye.lens,
            points,
            item.number,
            self._points[: self._count, 0],
            self._near,
            hiders.groups,
            hiders.spheres,
            hiders.boxes,
            hiders.firm,
            hiders.count,
        )
        return Sighting(share=share, beside=beside)

    def in_view(self, seat: BodyState) -> tuple[str, ...]:
        """Ids of the objects that the seat has in view within `rules.FIND_RANGE_M` of its eye, or in its hand."""
        self._refresh()
        eye = self._eyes[seat.name]
        if not self._count or not self._any_near(eye):
            return ()
        seen = self._seen_near(eye)
        if not seen and not seat.holding:
            return ()
        return tuple(item.id for item in self._items if item.number in seen or item.id == seat.holding)

    def _refresh(self) -> None:
        """Take over what has moved: ``_world`` counts changes of objects and doors, ``_moves`` those of poses."""
        objects, doors = self._objects, self._doors
        if self._objects_then != objects.changes:
            self._objects_then = objects.changes
            self._points[: self._count, 0] = self._points[: self._count, 1] = objects.positions
            self._points[: self._count, 1, 2] += self._tops
            self._world += 1
        if self._doors_then != doors.changes:
            self._doors_then = doors.changes
            self._records = [self._record(thing) for thing in self._fixed]
            self._world += 1
        stood = self._stood
        for number, other in enumerate(self._seats):
            if stood[number] is not other.pose:
                stood[number] = pose = other.pose
                at, flat = 6 * (self._count + number), self._flat
                flat[at] = flat[at + 3] = pose.x
                flat[at + 1] = flat[at + 4] = pose.y
                self._moves += 1

    def _look(self, eye: _SeatView, pose: Pose) -> None:
        """Bring what an eye sees up to date."""
        spec = eye.seat.spec
        if eye.roster != self._objects.roster:
            eye.roster = self._objects.roster
            reach = np.where(self._clutter, min(CLUTTER_RANGE_M, spec.sight_range), spec.sight_range)
            eye.wanted[: self._count, 0] = reach * self._objects.present
        every = self._points, eye.wanted, spec.sight_range, self._balls, eye.spots
        eye.seen = self._see(eye, *every, self._order)
        eye.found = self._reported(eye.seen, (pose.x, pose.y, spec.eye), eye.records)

    def _reported(self, seen: list[int], eye: Vec3, known: dict[int, Detection]) -> tuple[Detection, ...]:
        """A record of each target; those that are ``known`` from the same eye again, those of bodies always new."""
        found, moving, count, records = [], self._moving, self._count, self._records
        dist, anew = math.dist, not known
        for index in seen:
            if anew or (record := known.get(index)) is None:
                if index >= moving:
                    record = _copy(records[index - moving])
                    force_setattr(record, "distance", dist(eye, record.position))  # nobody else has seen it yet
                    known[index] = record
                elif index < count:
                    known[index] = record = _object_detection(self._items[index], eye)
                else:
                    record = _body_detection(self._seats[index - count], eye)
            found.append(record)
        return tuple(found)

    def _any_near(self, eye: _SeatView) -> bool:
        """Whether any object's centre is that near to the eye; worked out anew after a long enough way."""
        here = (eye.seat.pose.x, eye.seat.pose.y)
        version, there, spare = eye.spare
        if version != self._objects_then or math.dist(there, here) >= spare:
            apart = view_frustum.nearest_distance(*here, eye.seat.spec.eye, self._objects.positions)
            spare = apart - rules.FIND_RANGE_M - _ROUNDING_M
            eye.spare = self._objects_then, here, spare
            return bool(spare <= 0.0)
        return False

    def _seen_near(self, eye: _SeatView) -> set[int]:
        """Numbers of the objects in view that near: a look of its own, unless the eye has just looked at everything."""
        spec, pose = eye.seat.spec, eye.seat.pose
        if eye.version == (self._world, self._moves) and min(CLUTTER_RANGE_M, spec.sight_range) >= rules.FIND_RANGE_M:
            return {index for index in eye.seen if index < self._count and self._is_near(index, pose, spec.eye)}
        np.multiply(self._objects.present, rules.FIND_RANGE_M, out=self._near[:, 0])
        return set(self._see(eye, self._points[: self._count], self._near, 0.0, *self._nothing))

    def _see(
        self, eye: _SeatView, points: Any, wanted: Any, reach: float, balls: Any, spots: Any, order: Any
    ) -> list[int]:
        """Which of these targets an eye sees, as `glance.see` has it."""
        hiders, pose = self._hiders, eye.seat.pose
        if hiders.version != self._world:
            hiders.follow(self._world)
        wide, high = eye.lens
        seen: list[int] = visibility_kernel.visible_targets(
            pose.x,
            pose.y,
            eye.seat.spec.eye,
            pose.yaw,
            pose.pitch,
            wide,
            high,
            self._count,
            points,
            wanted,
            reach,
            balls,
            spots,
            hiders.groups,
            hiders.spheres,
            hiders.boxes,
            hiders.firm,
            hiders.count,
            order,
        ).tolist()
        return seen

    def _is_near(self, index: int, pose: Pose, height: float) -> bool:
        """The same sum as `glance` makes, so that both agree to the last bit."""
        x, y, z = self._items[index].position
        dx, dy, dz = x - pose.x, y - pose.y, z - height
        return dx * dx + dy * dy + dz * dz <= rules.FIND_RANGE_M * rules.FIND_RANGE_M

    def _ranges(self, seat: BodyState) -> Any:
        reach = np.full(self._moving, seat.spec.sight_range)
        for number, other in enumerate(self._seats, len(self._items)):
            reach[number] = 0.0 if other is seat else max(BODY_RANGE_M, seat.spec.sight_range)
        return reach

    def _record(self, thing: Landmark) -> Detection:
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


def _object_detection(item: MovableObject, eye: Vec3) -> Detection:
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
        bearers=item.bearers,
    )


def _body_detection(other: BodyState, eye: Vec3) -> Detection:
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
