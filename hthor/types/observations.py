"""Messages, and what a mind is told and perceives."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Protocol

from msgspec import Struct

from hthor.types.house import HouseSpec, Pose, Vec3
from hthor.types.specs import RELATIONS, BodySpec, Job

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Status = Literal["sent", "shown", "confirmed", "declined", "covered"]


class Message(Struct, frozen=True, kw_only=True):
    """An image-text message. ``position`` [m] is where the sender believes ``object`` to be.

    ``image`` is a callable that renders the sender's own frame at the sending tick, (H, W, 3) uint8, when called.
    """

    id: int
    sender: str
    tick: int
    text: str
    object: str = ""
    position: Vec3 | None = None
    image: Any = None


class Receipt(Struct, frozen=True, kw_only=True):
    """What became of the sender's last message; ``tick`` is when that status began."""

    message: int
    status: Status
    tick: int


class Detection(Struct, frozen=True, kw_only=True):
    """One thing in view: an object, a piece of furniture, a doorway, a person or a robot.

    ``position`` [m] house frame is its centre, ``distance`` [m] from the eye. ``state`` is "open" or "closed" for what
    opens. ``support`` is the id of what an object rests on or in, where the sensor can tell. ``held_by`` is the seat
    that has it in hand, ``bearers`` are all that hold it by a handle.
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
    """A range scan: for each of N bearings the way to the first thing that would stop this body.

    ``bearings`` (N,) float64 [rad] are relative to the heading, ``ranges`` (N,) float64 [m] from the body's axis, equal
    to ``limit`` [m] where nothing was met. ``tops`` (N,) float64 [m] are the heights of what was met, as a depth
    camera tells a wall from a table; infinite for walls and where nothing was met. ``beyond`` (N,) float64 [m] is the
    way to the first thing behind what was met that is too tall to be looked over, as people see walls over tables;
    ``limit`` where there is none, and None from a sensor that does not look over things. ``origin`` is the pose it was
    taken from.
    """

    origin: Pose
    bearings: Any
    ranges: Any
    limit: float
    tops: Any = None
    beyond: Any = None


class CameraSpec(Struct, frozen=True, kw_only=True):
    """Which pictures a seat's camera takes, as `hthor.types.cameras.parse` reads its name.

    ``size`` is (width, height) [pixels], None for the body's own. ``fov`` [rad] is the horizontal field of view of the
    pictures, None for the body's; what a detector reports goes by the body's alone.
    """

    name: str = "own"
    size: tuple[int, int] | None = None
    fov: float | None = None


class Camera(Struct, frozen=True, kw_only=True):
    """A camera as OpenCV counts: in its frame x is right, y down, z along the optical axis.

    ``size`` is (width, height) [pixels]. ``matrix`` (3, 3) float64 holds the intrinsics [pixels]; the centre of the
    pixel in column i and row j is at (i, j). ``pose`` (4, 4) float64 takes points [m] from the camera's frame to the
    house frame. Nothing nearer than ``near`` or farther than ``far`` [m] is in the picture; where nothing is, the depth
    is ``far``. A pixel (i, j) of depth d shows the point ``pose @ [*(inv(matrix) @ [i, j, 1]) * d, 1]``.
    """

    size: tuple[int, int]
    matrix: Any
    pose: Any
    near: float
    far: float


class View(Struct, frozen=True, kw_only=True):
    """One glance of a seat's camera: ``rgb`` (H, W, 3) uint8, ``depth`` (H, W) float32 [m] along the optical axis,
    ``segmentation`` (H, W) int32, indices into the world's list of names, -1 for nothing.
    """

    rgb: Any
    depth: Any
    segmentation: Any
    camera: Camera


class DetectorSpec(Struct, frozen=True, kw_only=True):
    """How a detector errs; see `hthor.world.perception.detector_noise`.

    ``miss`` is the chance that an object in view goes unreported, ``false_alarm`` that an object is reported where it
    is not, each drawn anew for every glimpse, a second of time. ``position_sigma`` [m] is the standard deviation of the
    reported positions of objects along each axis.
    """

    name: str
    miss: float = 0.0
    false_alarm: float = 0.0
    position_sigma: float = 0.0


class Sighting(Struct, frozen=True, kw_only=True):
    """How well one object is to be seen: the ``share`` of it that is in view, 0 to 1, neither hidden nor out of the
    field of view, and how many other small objects in view are close ``beside`` it, as the eye sees them.
    """

    share: float = 0.0
    beside: int = 0


class Senses(Protocol):
    """What a seat perceives at this tick, worked out only when asked; raises `StaleObservation` at a later tick.

    ``sighting`` of an object by its id is for human models: robots that run in a process of their own go without.
    """

    def detections(self) -> tuple[Detection, ...]: ...
    def sighting(self, id: str) -> Sighting: ...
    def scan(self) -> Scan: ...
    def rgb(self) -> NDArray[np.uint8]: ...
    def depth(self) -> NDArray[np.float32]: ...
    def segmentation(self) -> NDArray[np.int32]: ...
    def camera(self) -> Camera: ...


class Outcome(Struct, frozen=True, kw_only=True):
    """How the seat's last motion ended. ``reason`` is empty when ``ok``; ``by`` names the seat or thing in the way."""

    motion: str
    ok: bool
    reason: str = ""
    by: str = ""


class ThingState(Struct, frozen=True, kw_only=True):
    """True state of an object or of an openable thing. ``support`` is what it rests on or in, ``held_by`` a seat.

    ``bearers`` are all seats that hold it by a handle; as long as they cannot lift it, ``held_by`` is empty.
    """

    id: str
    kind: str
    position: Vec3
    support: str = ""
    held_by: str = ""
    open: bool = False
    bearers: tuple[str, ...] = ()


class Observation(Struct, frozen=True, kw_only=True):
    """What a mind is given when it is asked to act.

    A mind is asked when its body is free for a new motion (``idle``) and whenever its mail changes (``idle`` may then
    be false, and only ``say`` is heeded). The pictures, the scan and the detections are worked out on first access
    and must be read during ``act``: an observation kept for later raises `StaleObservation`.
    """

    tick: int
    pose: Pose
    idle: bool
    senses: Any
    room: str = ""
    holding: str = ""
    outcome: Outcome | None = None
    inbox: tuple[Message, ...] = ()
    receipt: Receipt | None = None
    truth: tuple[ThingState, ...] = ()

    @property
    def detections(self) -> tuple[Detection, ...]:
        found: tuple[Detection, ...] = self.senses.detections()
        return found

    @property
    def scan(self) -> Scan:
        scan: Scan = self.senses.scan()
        return scan

    @property
    def rgb(self) -> NDArray[np.uint8]:
        """(H, W, 3) uint8, the seat's own camera."""
        image: NDArray[np.uint8] = self.senses.rgb()
        return image

    @property
    def depth(self) -> NDArray[np.float32]:
        """(H, W) float32 [m] along the optical axis."""
        image: NDArray[np.float32] = self.senses.depth()
        return image

    @property
    def segmentation(self) -> NDArray[np.int32]:
        """(H, W) int32, an index into the world's list of names, -1 for nothing."""
        image: NDArray[np.int32] = self.senses.segmentation()
        return image

    @property
    def camera(self) -> Camera:
        """Where the seat's own camera is and how it projects: what the three pictures were taken with."""
        camera: Camera = self.senses.camera()
        return camera


class Briefing(Struct, frozen=True, kw_only=True):
    """What a mind is told before a trial.

    ``kind`` is the kind of task, ``jobs`` all there is to do; ``target``, ``destination`` (the kind of the thing to
    place the target in or on, empty for a search) and ``relation`` tell the first of them. ``crew`` holds every seat's
    body, one's own included. ``house`` is given only to a mind that declares the privilege ``house_map``;
    ``Observation.truth`` is filled only for ``object_poses``.
    """

    seat: str
    instruction: str
    target: str
    destination: str
    relation: str
    body: BodySpec
    tick_s: float
    time_limit: float
    teammates: tuple[str, ...] = ()
    privileges: tuple[str, ...] = ()
    house: HouseSpec | None = None
    kind: str = ""
    jobs: tuple[Job, ...] = ()
    crew: dict[str, BodySpec] = {}

    @property
    def todo(self) -> tuple[Job, ...]:
        """All there is to do; a briefing without a list of jobs stands for a single one."""
        if self.jobs:
            return self.jobs
        destinations = (self.destination,) if self.destination else ()
        relation = next((known for known in RELATIONS if known == self.relation), RELATIONS[0])
        return (Job(target=self.target, relation=relation, destinations=destinations),)
