"""The sensors of a seat, the records that they read, and the specifications of these sensors.

A new sensor is a method of `Senses` and a property of `SensorReadings`; `hthor.world.sensors` measures it in
a method of the same name. The wire, the clocks and the tests find it in `READINGS`.
"""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeAlias, get_type_hints

from msgspec import Struct

from hthor.types.house import Pose, Vec3

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats: TypeAlias = NDArray[np.float64]
    RgbImage: TypeAlias = NDArray[np.uint8]
    DepthImage: TypeAlias = NDArray[np.float32]
    LabelImage: TypeAlias = NDArray[np.int32]
else:  # readings are sent to agents' processes without their arrays, which are sent separately
    Floats = RgbImage = DepthImage = LabelImage = Any


class Detection(Struct, frozen=True, kw_only=True):
    """One thing in view: an object, a piece of furniture, a doorway, a person or a robot.

    Attributes:
        id: of the thing, or the seat of a person or robot. kind: such as "mug" or "fridge", or a robot's name.
        position: [m], house frame, of its centre. size: [m] along its own x, y and z. yaw: [rad] its heading.
        distance: [m] from the eye to ``position``.
        state: "open" or "closed" for a thing that opens, else empty.
        support: id of the thing that an object rests on or in, if the sensor can tell.
        held_by: the seat that has it in hand. bearers: all seats that hold it by a handle.
    """

    id: str
    kind: str
    family: Literal["object", "furniture", "doorway", "person", "robot"]
    position: Vec3
    size: Vec3
    yaw: float
    distance: float
    state: str = ""
    support: str = ""
    held_by: str = ""
    bearers: tuple[str, ...] = ()


class Scan(Struct, frozen=True, kw_only=True):
    """A range scan: for each of N bearings, the distance to the first thing that would stop this body.

    Walls, furniture and shut doors stop it; people, robots and movable objects are not in the scan.

    Attributes:
        origin: the pose from which the scan was taken; its ``yaw`` is that of the head.
        bearings: (N,) float64 [rad], relative to that heading, left positive.
        ranges: (N,) float64 [m] from the body's axis; ``limit`` where the beam met nothing.
        limit: [m] the sensor's range.
        tops: (N,) float64 [m], heights of the things that the beams met, by which a table differs from a wall; infinite
            for walls and where a beam met nothing.
        beyond: (N,) float64 [m], distance to the first thing too tall to look over, as people see a wall behind a
            table; ``limit`` where there is none. None from a robot's sensor, which cannot look over things.
    """

    origin: Pose
    bearings: Floats
    ranges: Floats
    limit: float
    tops: Floats | None = None
    beyond: Floats | None = None


class CameraSpec(Struct, frozen=True, kw_only=True):
    """The size and field of view of a seat's pictures; `hthor.types.cameras.parse` makes this record from a name.

    ``size`` is (width, height) [pixels], None for the body's own. ``fov`` [rad] is the horizontal field of view of the
    pictures, None for the body's own. Detectors always use the body's field of view.
    """

    name: str = "own"
    size: tuple[int, int] | None = None
    fov: float | None = None


class Camera(Struct, frozen=True, kw_only=True):
    """A pinhole camera by OpenCV's convention: in its frame x is right, y down, z along the optical axis.

    ``size`` is (width, height) [pixels]. ``matrix`` (3, 3) float64 holds the intrinsics [pixels]; the centre of the
    pixel in column i and row j is at (i, j). ``pose`` (4, 4) float64 takes points [m] from the camera's frame to the
    house frame. Nothing nearer than ``near`` or farther than ``far`` [m] is in the picture; where there is nothing,
    the depth is ``far``. A pixel (i, j) of depth d shows the point ``pose @ [*(inv(matrix) @ [i, j, 1]) * d, 1]``.
    """

    size: tuple[int, int]
    matrix: Floats
    pose: Floats
    near: float
    far: float


class View(Struct, frozen=True, kw_only=True):
    """Pictures of a seat's camera at one tick: ``rgb`` (H, W, 3) uint8, ``depth`` (H, W) float32 [m] along the optical
    axis, ``segmentation`` (H, W) int32, indices into the world's list of names, -1 for nothing.
    """

    rgb: RgbImage
    depth: DepthImage
    segmentation: LabelImage
    camera: Camera


class DetectorSpec(Struct, frozen=True, kw_only=True):
    """The error rates of a detector; see `hthor.world.perception.detector_noise`.

    ``miss`` is the probability that an object in view is not reported, ``false_alarm`` the probability that an object
    is reported where it is not; both are drawn independently for every second of time. ``position_sigma`` [m] is the
    standard deviation of the reported positions of objects along each axis.
    """

    name: str
    miss: float = 0.0
    false_alarm: float = 0.0
    position_sigma: float = 0.0


class Sighting(Struct, frozen=True, kw_only=True):
    """How visible one object is.

    Attributes:
        share: 0 to 1, the part of the object that is in the field of view and not hidden.
        beside: number of other small objects in view that appear close to it from the eye.
    """

    share: float = 0.0
    beside: int = 0


class Senses(Protocol):
    """A seat's sensors at one tick. Each reading is computed at its first use and then kept for the tick.

    Every method raises `hthor.errors.StaleObservation` after the tick has ended: read sensors inside ``act``, and keep
    the readings that you need. Positions are in the house frame [m]. Costs are those of one call in the profile "fast"
    on one processor core.
    """

    def detections(self) -> tuple[Detection, ...]:
        """Objects, furniture, doorways, people and robots in view and in range, by id, with the detector's errors.

        Costs some microseconds.
        """
        ...

    def sighting(self, id: str) -> Sighting:
        """How visible the object ``id`` is; a share of 0 if it is not in view or not an object.

        For human models only: robots that run in a process of their own cannot call it.
        """
        ...

    def scan(self) -> Scan:
        """Ranges to walls, furniture and shut doors over the horizontal field of view. Costs some microseconds."""
        ...

    def rgb(self) -> RgbImage:
        """(H, W, 3) uint8, from the seat's camera. A tick's first picture costs about a millisecond."""
        ...

    def depth(self) -> DepthImage:
        """(H, W) float32 [m] along the optical axis; `Camera.far` where there is nothing."""
        ...

    def segmentation(self) -> LabelImage:
        """(H, W) int32, indices into the world's list of names, which each episode shuffles; -1 for nothing."""
        ...

    def camera(self) -> Camera:
        """The intrinsics and the pose of the camera that takes the three pictures."""
        ...


class SensorReadings:
    """The sensors of `Senses` that take no argument, as properties of an `hthor.types.Observation`."""

    __slots__ = ()
    if TYPE_CHECKING:

        @property
        def senses(self) -> Senses: ...

    @property
    def detections(self) -> tuple[Detection, ...]:
        """The detector's detections, by id; see `Senses.detections`."""
        return self.senses.detections()

    @property
    def scan(self) -> Scan:
        """The range scan; see `Scan`."""
        return self.senses.scan()

    @property
    def rgb(self) -> RgbImage:
        """(H, W, 3) uint8, the seat's own camera."""
        return self.senses.rgb()

    @property
    def depth(self) -> DepthImage:
        """(H, W) float32 [m] along the optical axis."""
        return self.senses.depth()

    @property
    def segmentation(self) -> LabelImage:
        """(H, W) int32, indices into the world's list of names, -1 for nothing."""
        return self.senses.segmentation()

    @property
    def camera(self) -> Camera:
        """The intrinsics and the pose of the camera that takes the three pictures."""
        return self.senses.camera()


READINGS: dict[str, Any] = {
    name: get_type_hints(method)["return"]
    for name, method in inspect.getmembers(Senses, inspect.isfunction)
    if not name.startswith("_") and len(inspect.signature(method).parameters) == 1
}
"""The sensors that a robot in a process of its own can read: those that take no argument, by name, with the types of
their readings; `Any` for an array."""
