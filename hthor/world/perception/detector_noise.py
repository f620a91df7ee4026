"""The errors of a detector: objects overlooked, objects seen where they are not.

The errors depend on the trial's seed, the seat, the second of time (a *glimpse*) and the object, not on how often the
detector is read. Within a glimpse:

- each object in view is independently overlooked with probability ``miss``, for the whole glimpse; a second later it is
  drawn again. Furniture, doorways, people, robots and the object that the seat itself holds are never overlooked.
- with probability ``false_alarm``, one object that is not in view and is of a kind that tasks ask for is reported at a
  wrong place: on a surface of a piece of furniture in view, unhidden and within the detector's range. If there is no
  such surface or object, there is no false alarm. The report looks like any other; only another glimpse can show that
  it is false.
- reported positions of objects have a normal error of ``position_sigma`` along each axis.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence

import msgspec

from hthor import catalog, rules, seeds
from hthor.errors import HthorError
from hthor.geometry.plane import to_house
from hthor.types import BodySpec, Detection, DetectorSpec, Vec3, detector_specs
from hthor.world.model.geom_index import GeomIndex
from hthor.world.perception import view_frustum
from hthor.world.state.body_state import BodyState
from hthor.world.state.movable_object import MovableObject
from hthor.world.state.support_surfaces import SupportSurface, SupportSurfaces

GLIMPSE_TICKS = round(1.0 / rules.TICK_S)
"""[ticks] How long an error persists: a detector that errs in one frame also errs in the next. Our choice: 1 s."""
_POSITION_TRIES = 4
_SURFACE_SHARE = 0.8


def assign_detectors(
    robots: Sequence[str], bodies: Mapping[str, BodySpec], given: Iterable[DetectorSpec | str]
) -> dict[str, DetectorSpec]:
    """Each robot's detector.

    Args:
        robots: their seats. bodies: the body in each seat, which declares its own detector.
        given: the trial's detectors, in the robots' order: records, or texts for `hthor.types.detector_specs.parse`.

    Raises:
        HthorError: when there are more detectors than robots, or a detector's text cannot be read.
    """
    wanted = list(given)
    if len(wanted) > len(robots):
        raise HthorError(f"{len(wanted)} detectors for {len(robots)} robots; give at most one for each, in their order")
    wanted += [detector_specs.OWN] * (len(robots) - len(wanted))
    own = {
        seat: bodies[seat].detector if one == detector_specs.OWN else one
        for seat, one in zip(robots, wanted, strict=True)
    }
    return {seat: one if isinstance(one, DetectorSpec) else detector_specs.parse(one) for seat, one in own.items()}


class NoisyDetector:
    """The errors of one seat's detector."""

    def __init__(self, spec: DetectorSpec, seat: BodyState, scene: GeomIndex, places: SupportSurfaces) -> None:
        self._spec, self._seat, self._scene, self._places = spec, seat, scene, places

    def report(
        self, found: Sequence[Detection], items: Iterable[MovableObject], seed: int, tick: int
    ) -> tuple[Detection, ...]:
        """The detections that the detector reports, with its errors, by id.

        Args:
            found: the detections of an ideal detector. items: all objects of the world. seed: of the trial. tick: now.
        """
        spec, root = self._spec, seeds.derive(seed, "detector", self._seat.name, tick // GLIMPSE_TICKS)
        kept = [self._seen(detection, root) for detection in found if not self._missed(detection, root)]
        if spec.false_alarm and seeds.draw(root, "false alarm") < spec.false_alarm:
            kept += self._phantom(found, items, root)
        return tuple(sorted(kept, key=lambda detection: detection.id))

    def _missed(self, detection: Detection, root: int) -> bool:
        loose = detection.family == "object" and detection.id != self._seat.holding
        return loose and seeds.draw(root, "miss", detection.id) < self._spec.miss

    def _seen(self, detection: Detection, root: int) -> Detection:
        sigma = self._spec.position_sigma
        if detection.family != "object" or detection.id == self._seat.holding or not sigma:
            return detection
        x, y, z = (
            value + sigma * seeds.normal(root, "position", detection.id, axis)
            for axis, value in enumerate(detection.position)
        )
        return msgspec.structs.replace(detection, position=(x, y, z), distance=self._distance((x, y, z)))

    def _phantom(self, found: Sequence[Detection], items: Iterable[MovableObject], root: int) -> list[Detection]:
        """The false alarm: at most one object, at a place where it is not."""
        seen = {detection.id for detection in found}
        absent = [item for item in items if _is_target(item) and item.id not in seen and item.id != self._seat.holding]
        if not absent:
            return []
        item = min(absent, key=lambda item: seeds.draw(root, "which", item.id))
        furniture = [detection.id for detection in found if detection.family == "furniture"]
        for place, position in self._spots(furniture, item, root):
            if self._plain(position):
                return [
                    Detection(
                        id=item.id,
                        kind=item.kind,
                        family="object",
                        position=position,
                        size=item.size,
                        yaw=place.yaw,
                        distance=self._distance(position),
                        support=place.thing,
                    )
                ]
        return []

    def _spots(self, furniture: Iterable[str], item: MovableObject, root: int) -> Iterator[tuple[SupportSurface, Vec3]]:
        """Places for the object on furniture in view, in an order that is drawn for the glimpse."""
        places = [
            (seeds.draw(root, "where", thing, number), place)
            for thing in furniture
            for number, place in enumerate(self._places.of(thing))
            if not place.inside
        ]
        for mark, place in sorted(places, key=lambda pair: pair[0]):
            for attempt in range(_POSITION_TRIES):
                u, v = (
                    _SURFACE_SHARE * half * (2.0 * seeds.draw(root, "spot", repr(mark), attempt, axis) - 1.0)
                    for axis, half in enumerate(place.half)
                )
                yield place, to_house((u, v, item.size[2] / 2), place.centre, place.yaw)

    def _plain(self, point: Vec3) -> bool:
        """Whether a point is within range, in the field of view and unhidden."""
        pose, body = self._seat.pose, self._seat.spec
        view = view_frustum.view_vector(pose, body)
        offset = tuple(point[axis] - float(view[axis]) for axis in range(3))
        ahead, left, up = (sum(offset[axis] * float(view[row + axis]) for axis in range(3)) for row in (3, 6, 9))
        if self._distance(point) > body.sight_range or ahead <= 0.0:
            return False
        if abs(left) > ahead * float(view[12]) or abs(up) > ahead * float(view[13]):
            return False
        return not self._scene.hidden(view_frustum.eye_position(pose, body), point)

    def _distance(self, point: Vec3) -> float:
        return math.dist(view_frustum.eye_position(self._seat.pose, self._seat.spec), point)


def _is_target(item: MovableObject) -> bool:
    return item.present and item.kind in catalog.TARGETS
