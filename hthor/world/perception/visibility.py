"""The objects, bodies, furniture and doorways that each seat has in view now."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from msgspec.structs import force_setattr

from hthor import rules
from hthor.geometry.ray_casting import Floats, Ints
from hthor.types import Detection, Opening, Pose, Sighting, Thing, Vec2, Vec3, is_person
from hthor.world.model.geom_index import GeomIndex
from hthor.world.perception import occlusion_kernel, view_frustum, visibility_kernel
from hthor.world.perception.landmarks import Landmark, landmarks, pack_targets
from hthor.world.perception.occluders import Occluders
from hthor.world.state.body_state import BodyState
from hthor.world.state.doors import Doors
from hthor.world.state.movable_object import MovableObject
from hthor.world.state.objects import Objects

_copy: Any = Detection.__copy__  # type: ignore[attr-defined]
BODY_RANGE_M = 3.0
"""[m] Every detector reports people and robots up to this distance, even if its own range is shorter."""
CLUTTER_RANGE_M = 2.0
"""[m] Detection range of small household objects that no task asks for; our choice, which keeps detections few."""
SMALL_M = 0.5
"""[m] Objects up to this length count as small objects in `hthor.types.Sighting.beside`; our choice."""
_ROUNDING_M = 1e-6
_NOT_SEEN = Sighting()


class _SeatView:
    """A seat's eye and its last detections; ``records`` are detections that are valid while the eye is at ``place``."""

    __slots__ = (
        "body",
        "clearance",
        "detections",
        "place",
        "records",
        "roster",
        "seen",
        "spots",
        "tangents",
        "targets",
        "version",
    )

    def __init__(self, body: BodyState, targets: Floats, spots: Floats) -> None:
        self.body, self.targets, self.spots = body, targets, spots
        self.tangents = view_frustum.half_fov_tangents(body.spec)
        self.version, self.place, self.roster = (-1, -1), (math.nan, math.nan), -1
        self.records: dict[int, Detection] = {}
        self.seen: list[int] = []
        self.detections: tuple[Detection, ...] = ()
        self.clearance: tuple[int, Vec2, float] = (-1, (0.0, 0.0), 0.0)


class Visibility:
    """Finds the objects, furniture, doorways and bodies that a seat sees, in one compiled call.

    Targets are numbered: first the objects, then the bodies, then furniture, then doorways.
    """

    def __init__(
        self,
        geoms: GeomIndex,
        objects: Objects,
        doors: Doors,
        statics: Iterable[Thing],
        openings: Iterable[Opening],
        seats: Sequence[BodyState],
    ) -> None:
        self._objects, self._doors, self._seats = objects, doors, seats
        self._items: tuple[MovableObject, ...] = tuple(objects)
        self._landmarks = landmarks(statics, openings)
        moving = [item.id for item in self._items] + [seat.name for seat in seats]
        names = [*moving, *(landmark.id for landmark in self._landmarks)]
        self._order = np.array(sorted(range(len(names)), key=names.__getitem__), np.int64)
        self._seen = np.empty(len(names) + 1, np.int64)
        self._seen_view = self._seen.data  # to read few numbers fast
        self._moving_count, self._object_count = len(moving), len(self._items)
        self._points = np.zeros((len(moving), 2, 3))
        self._flat_points = self._points.data.cast("B").cast("d")  # to write single numbers fast
        self._top_offsets = np.array([0.4 * item.size[2] for item in self._items])
        self._clutter = np.array([item.clutter for item in self._items], np.bool_)
        self._small = np.array([max(item.size) <= SMALL_M for item in self._items], np.bool_)
        for number, seat in enumerate(seats, len(self._items)):
            self._points[number, :, 2] = 0.5 * seat.spec.height, 0.9 * seat.spec.height
        own = [geoms.span.get(name, (0, 0)) for name in moving]
        self._balls, spots = pack_targets(self._landmarks, geoms.span)
        self._views = {
            seat.name: _SeatView(seat, np.column_stack([self._ranges(seat), own]), spots.copy()) for seat in seats
        }
        self._near_ranges = np.array([(0.0, *span) for span in own[: len(self._items)]]).reshape(-1, 3)
        self._no_landmarks = np.zeros((7, 1)), np.zeros((6, 0)), np.arange(len(self._items))
        self._occluders = Occluders(geoms)
        self._objects_version = self._doors_version = -1
        self._last_poses: list[Pose | None] = [None] * len(seats)
        self._landmark_records: list[Detection] = []
        self._world_version = self._pose_version = 0

    def detections(self, seat: BodyState) -> tuple[Detection, ...]:
        """Detections of the seat's detector now, by id; the same records as long as neither eye nor world changes."""
        self._refresh()
        view, version = self._views[seat.name], (self._world_version, self._pose_version)
        if view.version != version:
            pose = seat.pose
            place = (pose.x, pose.y)
            if view.place != place or view.version[0] != self._world_version:
                view.place, view.records = place, {}
            view.version = version
            self._look(view, pose)
        return view.detections

    def sighting(self, seat: BodyState, id: str) -> Sighting:
        """How visible an object is to the seat now; a share of 0 if it is not in view or not an object."""
        self.detections(seat)
        item, view = self._objects.get(id), self._views[seat.name]
        if item is None or item.number not in view.seen:
            return _NOT_SEEN
        points = occlusion_kernel.sample_points(
            item.position, item.size, item.yaw, view_frustum.look_points(item.position, item.size)
        )
        self._near_ranges[:, 0] = self._objects.present & self._small
        share, beside = occlusion_kernel.measure(
            *self._eye_numbers(view),
            points,
            item.number,
            self._points[: self._object_count, 0],
            self._near_ranges,
            *self._occluders.arrays,
        )
        return Sighting(share=share, beside=beside)

    def in_view(self, seat: BodyState) -> tuple[str, ...]:
        """Ids of the objects in the seat's hand, or in its view within `rules.FIND_RANGE_M` of its eye."""
        self._refresh()
        view = self._views[seat.name]
        if not self._object_count or not self._any_near(view):
            return ()
        seen = self._seen_near(view)
        if not seen and not seat.holding:
            return ()
        return tuple(item.id for item in self._items if item.number in seen or item.id == seat.holding)

    def _refresh(self) -> None:
        """Copy the poses that changed, and increase the versions of the world (objects, doors) and of the poses."""
        objects, doors = self._objects, self._doors
        if self._objects_version != objects.changes:
            self._objects_version = objects.changes
            self._points[: self._object_count, 0] = self._points[: self._object_count, 1] = objects.positions
            self._points[: self._object_count, 1, 2] += self._top_offsets
            self._world_version += 1
        if self._doors_version != doors.changes:
            self._doors_version = doors.changes
            self._landmark_records = [self._landmark_detection(thing) for thing in self._landmarks]
            self._world_version += 1
        stood = self._last_poses
        for number, other in enumerate(self._seats):
            if stood[number] is not other.pose:
                stood[number] = pose = other.pose
                at, flat = 6 * (self._object_count + number), self._flat_points
                flat[at] = flat[at + 3] = pose.x
                flat[at + 1] = flat[at + 4] = pose.y
                self._pose_version += 1

    def _look(self, view: _SeatView, pose: Pose) -> None:
        """Update the detections of an eye."""
        spec = view.body.spec
        if view.roster != self._objects.roster:
            view.roster = self._objects.roster
            reach = np.where(self._clutter, min(CLUTTER_RANGE_M, spec.sight_range), spec.sight_range)
            view.targets[: self._object_count, 0] = reach * self._objects.present
        targets = self._points, view.targets, spec.sight_range, self._balls, view.spots
        view.seen = self._see(view, *targets, self._order)
        view.detections = self._reported(view.seen, (pose.x, pose.y, spec.eye), view.records)

    def _reported(self, seen: list[int], eye: Vec3, known: dict[int, Detection]) -> tuple[Detection, ...]:
        """A detection for each target: the ``known`` record from the same place if any; always a new one for a body."""
        found, moving, count, records = [], self._moving_count, self._object_count, self._landmark_records
        dist, from_new_place = math.dist, not known
        for index in seen:
            if from_new_place or (record := known.get(index)) is None:
                if index >= moving:
                    record = _copy(records[index - moving])
                    force_setattr(record, "distance", dist(eye, record.position))  # a private copy
                    known[index] = record
                elif index < count:
                    known[index] = record = _object_detection(self._items[index], eye)
                else:
                    record = _body_detection(self._seats[index - count], eye)
            found.append(record)
        return tuple(found)

    def _any_near(self, view: _SeatView) -> bool:
        """Whether any object's centre is within `rules.FIND_RANGE_M`; recomputed once the eye has moved far enough."""
        here = (view.body.pose.x, view.body.pose.y)
        version, there, clearance = view.clearance
        if version != self._objects_version or math.dist(there, here) >= clearance:
            distance = view_frustum.nearest_distance(*here, view.body.spec.eye, self._objects.positions)
            clearance = distance - rules.FIND_RANGE_M - _ROUNDING_M
            view.clearance = self._objects_version, here, clearance
            return bool(clearance <= 0.0)
        return False

    def _seen_near(self, view: _SeatView) -> set[int]:
        """Numbers of the objects in view within `rules.FIND_RANGE_M`, from the last detections if up to date."""
        spec, pose = view.body.spec, view.body.pose
        if (
            view.version == (self._world_version, self._pose_version)
            and min(CLUTTER_RANGE_M, spec.sight_range) >= rules.FIND_RANGE_M
        ):
            return {index for index in view.seen if index < self._object_count and self._is_near(index, pose, spec.eye)}
        np.multiply(self._objects.present, rules.FIND_RANGE_M, out=self._near_ranges[:, 0])
        return set(self._see(view, self._points[: self._object_count], self._near_ranges, 0.0, *self._no_landmarks))

    def _see(
        self, view: _SeatView, points: Floats, wanted: Floats, reach: float, balls: Floats, spots: Floats, order: Ints
    ) -> list[int]:
        """The targets that an eye sees; see `hthor.world.perception.visibility_kernel.visible_targets`."""
        if self._occluders.version != self._world_version:
            self._occluders.follow(self._world_version)
        targets = self._object_count, points, wanted, reach, balls, spots
        eye = self._eye_numbers(view)
        count = visibility_kernel.visible_targets(*eye, *targets, *self._occluders.arrays, order, self._seen)
        return self._seen_view[:count].tolist()

    @staticmethod
    def _eye_numbers(view: _SeatView) -> tuple[float, float, float, float, float, float, float]:
        """Position [m], heading and pitch [rad] of an eye, and the tangents of half its fields of view."""
        pose = view.body.pose
        return (pose.x, pose.y, view.body.spec.eye, pose.gaze, pose.pitch, *view.tangents)

    def _is_near(self, index: int, pose: Pose, height: float) -> bool:
        """Whether an object is within range of the eye; the sum is that of the kernel, so that both agree bitwise."""
        x, y, z = self._items[index].position
        dx, dy, dz = x - pose.x, y - pose.y, z - height
        return dx * dx + dy * dy + dz * dz <= rules.FIND_RANGE_M * rules.FIND_RANGE_M

    def _ranges(self, seat: BodyState) -> Floats:
        reach = np.full(self._moving_count, seat.spec.sight_range)
        for number, other in enumerate(self._seats, len(self._items)):
            reach[number] = 0.0 if other is seat else max(BODY_RANGE_M, seat.spec.sight_range)
        return reach

    def _landmark_detection(self, thing: Landmark) -> Detection:
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
    person = is_person(other.name)
    return Detection(
        id=other.name,
        kind="person" if person else other.spec.name,
        family="person" if person else "robot",
        position=position,
        size=(2 * other.spec.radius, 2 * other.spec.radius, other.spec.height),
        yaw=pose.yaw,
        distance=math.dist(eye, position),
    )
