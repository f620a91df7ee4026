"""What an agent or a human model perceives and is told: messages, sensor readings, observations, briefings."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeAlias

from msgspec import Struct

from hthor.types.house import HouseSpec, Pose, Vec3
from hthor.types.specs import RELATIONS, BodySpec, Job

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats: TypeAlias = NDArray[np.float64]
    RgbImage: TypeAlias = NDArray[np.uint8]
    DepthImage: TypeAlias = NDArray[np.float32]
    LabelImage: TypeAlias = NDArray[np.int32]
    ImageSource: TypeAlias = Callable[[], RgbImage] | None
    SeatSenses: TypeAlias = "Senses"
else:  # these records cross to agents' processes: without arrays, which are sent apart, and without senses
    Floats = RgbImage = DepthImage = LabelImage = ImageSource = SeatSenses = Any

Status = Literal["sent", "shown", "confirmed", "declined", "covered"]


class Message(Struct, frozen=True, kw_only=True):
    """An image-text message from a robot to the person.

    Attributes:
        id: number of the message in its trial, from 0. sender: the robot's seat. tick: when it was sent.
        text: what it says, on one line, at most `rules.TEXT_MAX` characters.
        object: id or kind of what it is about, empty for nothing in particular.
        position: [m], house frame, where the sender believes ``object`` to be.
        image: when called, renders the sender's own view at the sending tick, (H, W, 3) uint8; None without a picture.
    """

    id: int
    sender: str
    tick: int
    text: str
    object: str = ""
    position: Vec3 | None = None
    image: ImageSource = None


class Receipt(Struct, frozen=True, kw_only=True):
    """The status of a robot's last message, by its number; ``tick`` is when that status began.

    A message is "sent", then "shown" to the person, and ends as "confirmed" (accepted), "declined", or "covered" by a
    newer one.
    """

    message: int
    status: Status
    tick: int


class Detection(Struct, frozen=True, kw_only=True):
    """One thing in view: an object, a piece of furniture, a doorway, a person or a robot.

    Attributes:
        id: of the thing, or the seat of a person or robot. kind: its kind, such as "mug", "fridge" or a robot's name.
        position: [m], house frame, of its centre. size: [m] along its own x, y and z. yaw: [rad] its heading.
        distance: [m] from the eye to ``position``.
        state: "open" or "closed" for what opens, else empty.
        support: id of what an object rests on or in, where the sensor can tell.
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
        origin: the pose it was taken from.
        bearings: (N,) float64 [rad], relative to the heading, left positive.
        ranges: (N,) float64 [m] from the body's axis; ``limit`` where nothing was met.
        limit: [m] the sensor's range.
        tops: (N,) float64 [m], heights of what was met, as a depth camera tells a table from a wall; infinite for walls
            and where nothing was met.
        beyond: (N,) float64 [m], distance to the first thing behind that is too tall to be looked over, as people see a
            wall over a table; ``limit`` where there is none. None from a robot's sensor, which does not look over.
    """

    origin: Pose
    bearings: Floats
    ranges: Floats
    limit: float
    tops: Floats | None = None
    beyond: Floats | None = None


class CameraSpec(Struct, frozen=True, kw_only=True):
    """Which pictures a seat's camera takes, as `hthor.types.cameras.parse` reads its name.

    ``size`` is (width, height) [pixels], None for the body's own. ``fov`` [rad] is the horizontal field of view of the
    pictures, None for the body's; what a detector reports goes by the body's alone.
    """

    name: str = "own"
    size: tuple[int, int] | None = None
    fov: float | None = None


class Camera(Struct, frozen=True, kw_only=True):
    """A pinhole camera by OpenCV's convention: in its frame x is right, y down, z along the optical axis.

    ``size`` is (width, height) [pixels]. ``matrix`` (3, 3) float64 holds the intrinsics [pixels]; the centre of the
    pixel in column i and row j is at (i, j). ``pose`` (4, 4) float64 takes points [m] from the camera's frame to the
    house frame. Nothing nearer than ``near`` or farther than ``far`` [m] is in the picture; where nothing is, the depth
    is ``far``. A pixel (i, j) of depth d shows the point ``pose @ [*(inv(matrix) @ [i, j, 1]) * d, 1]``.
    """

    size: tuple[int, int]
    matrix: Floats
    pose: Floats
    near: float
    far: float


class View(Struct, frozen=True, kw_only=True):
    """What a seat's camera takes at one moment: ``rgb`` (H, W, 3) uint8, ``depth`` (H, W) float32 [m] along the optical
    axis, ``segmentation`` (H, W) int32, indices into the world's list of names, -1 for nothing.
    """

    rgb: RgbImage
    depth: DepthImage
    segmentation: LabelImage
    camera: Camera


class DetectorSpec(Struct, frozen=True, kw_only=True):
    """How a detector errs; see `hthor.world.perception.detector_noise`.

    ``miss`` is the chance that an object in view goes unreported, ``false_alarm`` that an object is reported where it
    is not, each drawn independently for every second of time. ``position_sigma`` [m] is the standard deviation of the
    reported positions of objects along each axis.
    """

    name: str
    miss: float = 0.0
    false_alarm: float = 0.0
    position_sigma: float = 0.0


class Sighting(Struct, frozen=True, kw_only=True):
    """How visible one object is.

    Attributes:
        share: 0 to 1, the part of it that is in the field of view and not hidden.
        beside: how many other small objects in view appear close to it, as seen from the eye.
    """

    share: float = 0.0
    beside: int = 0


class Senses(Protocol):
    """A seat's sensors at one tick. Readings are computed when first asked for, then kept for the tick.

    Every method raises `hthor.errors.StaleObservation` once the world has moved on: read inside ``act``, and keep what
    you need of the readings. Positions are in the house frame [m]. Costs are those of one call in the profile "fast" on
    one processor core.
    """

    def detections(self) -> tuple[Detection, ...]:
        """Objects, furniture, doorways, people and robots in view and in range, by id, with the detector's errors.

        Costs some microseconds.
        """
        ...

    def sighting(self, id: str) -> Sighting:
        """How visible the object ``id`` is; a share of 0 for what is not in view or is no object.

        For human models only: it is not offered to robots that run in a process of their own.
        """
        ...

    def scan(self) -> Scan:
        """Ranges to walls, furniture and shut doors over the horizontal field of view. Costs some microseconds."""
        ...

    def rgb(self) -> RgbImage:
        """(H, W, 3) uint8, the seat's own camera. The first of the three pictures costs about a millisecond."""
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


class Outcome(Struct, frozen=True, kw_only=True):
    """How a seat's last motion ended: ``motion`` is its name, such as "move".

    ``reason`` says why it failed, empty when ``ok``; ``by`` names the seat, thing or "wall" in the way.
    """

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
    """What an agent or a human model is given when it is asked to act; see `Mind.act`.

    Attributes:
        tick: ticks since the trial began. pose: of the seat's body, house frame.
        idle: whether the body is free for a new motion; otherwise only ``Action.say`` takes effect.
        senses: the seat's sensors, which the properties below read.
        room: id of the room that the body is in, the last one while it is between rooms.
        holding: id of the object in hand, or held by a handle; empty for none.
        outcome: how the last motion ended; None before any has.
        inbox: the open message, for the person only. receipt: the status of the robot's last message.
        truth: true states of all objects, only for agents that declare the privilege ``object_poses``.
    """

    tick: int
    pose: Pose
    idle: bool
    senses: SeatSenses
    room: str = ""
    holding: str = ""
    outcome: Outcome | None = None
    inbox: tuple[Message, ...] = ()
    receipt: Receipt | None = None
    truth: tuple[ThingState, ...] = ()

    @property
    def detections(self) -> tuple[Detection, ...]:
        """What the detector reports, by id; see `Senses.detections`."""
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


class Briefing(Struct, frozen=True, kw_only=True):
    """What an agent or a human model is told before a trial.

    Attributes:
        seat: its own seat. body: its own body. teammates: all other seats. crew: every seat's body, its own included.
        instruction: the task in words. kind: the task kind. time_limit: [s] of the trial. tick_s: [s] of one tick.
        target, destination, relation: the first job: the object's id, the kind of thing to place it in or on (empty for
            a search), and "find", "on", "in" or "at".
        jobs: everything there is to do.
        privileges: what it declared and was granted. house: the floor plan, only with the privilege ``house_map``.
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
