"""The records that rooms hand to one another; knows nothing of engines, scoring or files.

Frames and units, everywhere in hthor: metres, radians, seconds; the *house frame* is MuJoCo's world frame (x right,
y forward, z up). A body's ``yaw`` is its heading, counter-clockwise from +x. A thing's ``yaw`` turns its *local
frame* (origin at the centre of its bounding box, front towards +y) counter-clockwise about z.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, Protocol

from msgspec import Struct

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Vec2 = tuple[float, float]
Vec3 = tuple[float, float, float]
Rgba = tuple[float, float, float, float]

HUMAN = "human"
"""The person's seat. Robots sit at ``robot``, ``robot2``, ``robot3`` ..."""


# ---------------------------------------------------------------------------------------------------- places and things


class Pose(Struct, frozen=True, kw_only=True):
    """A body's place and gaze: ``x``, ``y`` [m] house frame, ``yaw`` [rad], camera ``pitch`` [rad], up positive."""

    x: float
    y: float
    yaw: float = 0.0
    pitch: float = 0.0


class Part(Struct, frozen=True, kw_only=True):
    """One solid of a thing, in the thing's local frame.

    ``half`` [m] holds the half extents of its bounding box: (r, r, half height) of an upright cylinder, (r, r, r) of a
    sphere. ``axis`` is the direction of a cylinder. ``moves`` names the `Joint` that it moves with, empty for none.
    """

    shape: Literal["box", "cylinder", "sphere"]
    centre: Vec3
    half: Vec3
    rgba: Rgba
    axis: Literal["x", "y", "z"] = "z"
    moves: str = ""


class Surface(Struct, frozen=True, kw_only=True):
    """A flat place of a thing where objects can rest, in the thing's local frame.

    ``centre`` [m] is the middle of the surface, ``half`` [m] its half extents along local x and y, ``clearance`` [m]
    the free height above it. ``inside`` marks a surface that only an open door gives access to. ``moves`` names the
    `Joint` that it moves with, as a drawer's floor does; ``centre`` is then where it is while closed.
    """

    name: str
    centre: Vec3
    half: Vec2
    clearance: float
    inside: bool = False
    moves: str = ""


class Joint(Struct, frozen=True, kw_only=True):
    """How a door turns or a drawer slides, in the thing's local frame; 0 is closed, ``travel`` open.

    A hinge turns by ``travel`` [rad] about the unit vector ``axis`` through ``anchor`` [m], right-handed; a slide goes
    ``travel`` [m] along ``axis``. All joints of a thing move together.
    """

    name: str
    kind: Literal["hinge", "slide"]
    anchor: Vec3
    axis: Vec3
    travel: float


class Thing(Struct, frozen=True, kw_only=True):
    """A piece of furniture or a small object of a house, as its file places it.

    ``centre`` [m] house frame is the middle of the bounding box, ``size`` [m] its extents along the thing's local
    x (width), y (depth) and z (height) axes. ``variant`` picks one of its kind's finishes; it changes looks only.
    """

    id: str
    kind: str
    asset: str
    variant: int = 0
    centre: Vec3
    size: Vec3
    yaw: float
    room: str = ""
    parent: str = ""


class Room(Struct, frozen=True, kw_only=True):
    """A room: ``kind`` is one of kitchen, living_room, bedroom, bathroom; ``polygon`` [m] runs counter-clockwise."""

    id: str
    kind: str
    name: str
    polygon: tuple[Vec2, ...]
    floor: str = ""


class Wall(Struct, frozen=True, kw_only=True):
    """One quad of wall seen from ``room`` (or "exterior"), from ``a`` to ``b`` [m], ``height`` [m] tall."""

    id: str
    room: str
    a: Vec2
    b: Vec2
    height: float
    material: str = ""
    rgb: Vec3 | None = None


class Opening(Struct, frozen=True, kw_only=True):
    """A hole in a wall: the floor segment ``a`` to ``b`` [m] and the heights ``low`` and ``high`` [m] it spans.

    A ``passable`` one is an open doorway; the closed outside door and every window are not. In an ``openable`` one
    hangs a leaf that stands open when a trial begins; in other doorways there is none. ``asset`` is what fills it.
    """

    id: str
    kind: Literal["door", "window"]
    rooms: tuple[str, str]
    a: Vec2
    b: Vec2
    low: float
    high: float
    passable: bool
    openable: bool = False
    asset: str = ""


class HouseSpec(Struct, frozen=True, kw_only=True):
    """A floor plan with everything in it. ``sha256`` is the hash of the file's canonical JSON."""

    id: str
    sha256: str
    rooms: tuple[Room, ...]
    walls: tuple[Wall, ...]
    openings: tuple[Opening, ...]
    things: tuple[Thing, ...]
    height: float
    start: Pose


# ----------------------------------------------------------------------------------------------------- bodies and tasks


class BodySpec(Struct, frozen=True, kw_only=True):
    """What a body can do, of a robot or of the person's avatar.

    ``eye`` [m] is the camera's height; ``fov`` [rad] its horizontal and vertical field of view; ``sight_range`` [m]
    bounds what its detector reports, ``scan_range`` [m] its range scan. ``reach`` [m] is horizontal, from the body's
    axis; ``reach_low`` and ``reach_high`` [m] bound the height of a grasp; ``strength`` [kg] what it can lift.
    ``handling`` [s] is how long pick, place, open and close take. ``pitch_limit`` [rad] bounds the camera either way.
    ``detector`` is how its detector errs unless a trial says otherwise, as `hthor.detectors.read` reads it.
    """

    name: str
    title: str
    radius: float
    height: float
    eye: float
    fov: Vec2
    speed: float
    turn_rate: float
    sight_range: float
    scan_range: float
    scan_beams: int
    pitch_limit: float
    capabilities: frozenset[Literal["navigate", "pick", "open"]]
    reach: float = 0.0
    reach_low: float = 0.0
    reach_high: float = 0.0
    strength: float = 0.0
    handling: float = 1.0
    detector: str = "ideal"


class RobotSpec(BodySpec, frozen=True, kw_only=True):
    """A robot's body, one file each in ``hthor/world/robots``."""


class Placement(Struct, frozen=True, kw_only=True):
    """Where an object starts: ``position`` [m] of its centre, and what it rests ``on`` or lies ``in``."""

    id: str
    kind: str
    position: Vec3
    yaw: float = 0.0
    support: str = ""
    relation: Literal["on", "in"] = "on"


class Goal(Struct, frozen=True, kw_only=True):
    """What ends a task well: find or place ``target`` (an object's id); ``destination`` is a thing's *kind*."""

    target: str
    relation: Literal["find", "on", "in"]
    destination: str = ""


class TaskSpec(Struct, frozen=True, kw_only=True):
    """One task, as frozen data; ``t_star`` [s] is the least time by the shortest path."""

    id: str
    kind: str
    house: str
    house_sha256: str
    human_start: Pose
    robot_starts: tuple[Pose, ...]
    objects: tuple[Placement, ...]
    goal: Goal
    instruction: str
    time_limit: float
    t_star: float


class AgentRef(Struct, frozen=True, kw_only=True):
    """Which mind a robot has: a name, where it was loaded from, and the hash of its code."""

    name: str
    source: str
    sha256: str
    privileges: tuple[str, ...] = ()


class RobotSeat(Struct, frozen=True, kw_only=True):
    """One robot of a trial: its body and its mind. ``detector`` as `hthor.detectors.read` reads it.

    ``robot_sha256`` is the hash of a user's own robot file, empty for a robot that ships with hthor.
    """

    seat: str
    robot: str
    agent: AgentRef
    detector: str = "own"
    robot_sha256: str = ""


class TrialSpec(Struct, frozen=True, kw_only=True):
    """Everything that decides a trial's course; its content hash is the trial's key.

    ``assets_sha256`` is the hash of the furniture pack that the robots' pictures show, empty for our own furniture.
    """

    task: TaskSpec
    robots: tuple[RobotSeat, ...]
    human: str
    human_sha256: str
    participant: int
    index: int
    seed: int
    suite_sha256: str
    rules_sha256: str
    code_sha256: str
    assets_sha256: str = ""


# ------------------------------------------------------------------------------------------------------------ messages

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


# ------------------------------------------------------------------------------------------------------------- sensing


class Detection(Struct, frozen=True, kw_only=True):
    """One thing in view: an object, a piece of furniture, a doorway, a person or a robot.

    ``position`` [m] house frame is its centre, ``distance`` [m] from the eye. ``state`` is "open" or "closed" for what
    opens. ``support`` is the id of what an object rests on or in, where the sensor can tell.
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


class Scan(Struct, frozen=True, kw_only=True):
    """A range scan: for each of N bearings the way to the first thing that would stop this body.

    ``bearings`` (N,) float64 [rad] are relative to the heading, ``ranges`` (N,) float64 [m] from the body's axis, equal
    to ``limit`` [m] where nothing was met. ``tops`` (N,) float64 [m] are the heights of what was met, as a depth
    camera tells a wall from a table; infinite for walls and where nothing was met. ``origin`` is the pose it was taken
    from.
    """

    origin: Pose
    bearings: Any
    ranges: Any
    limit: float
    tops: Any = None


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
    """How a detector errs; see `hthor.world.detector`.

    ``miss`` is the chance that an object in view goes unreported, ``false_alarm`` that an object is reported where it
    is not, each drawn anew for every glimpse, a second of time. ``position_sigma`` [m] is the standard deviation of the
    reported positions of objects along each axis.
    """

    name: str
    miss: float = 0.0
    false_alarm: float = 0.0
    position_sigma: float = 0.0


class Senses(Protocol):
    """What a seat perceives at this tick, worked out only when asked; raises `StaleObservation` at a later tick."""

    def detections(self) -> tuple[Detection, ...]: ...
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
    """True state of an object or of an openable thing. ``support`` is what it rests on or in, ``held_by`` a seat."""

    id: str
    kind: str
    position: Vec3
    support: str = ""
    held_by: str = ""
    open: bool = False


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

    ``destination`` is the kind of the thing to place the target in or on, empty for a search. ``house`` is given only
    to a mind that declares the privilege ``house_map``; ``Observation.truth`` is filled only for ``object_poses``.
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


# ------------------------------------------------------------------------------------------------------------- actions


class Move(Struct, tag="move", frozen=True, kw_only=True):
    """Go ``forward`` and ``left`` [m] in the body's frame; the vector is at most 0.5 m long."""

    forward: float
    left: float = 0.0


class Rotate(Struct, tag="rotate", frozen=True, kw_only=True):
    """Turn by ``yaw`` [rad], left positive, and tilt the camera by ``pitch`` [rad], up positive."""

    yaw: float = 0.0
    pitch: float = 0.0


class Pick(Struct, tag="pick", frozen=True, kw_only=True):
    """Take the object with this id in hand."""

    object: str


class Place(Struct, tag="place", frozen=True, kw_only=True):
    """Put what is held on or in the thing ``on``, near ``position`` [m] house frame when given."""

    on: str
    position: Vec3 | None = None


class Drop(Struct, tag="drop", frozen=True, kw_only=True):
    """Let go of what is held, here: it falls, rolls, and settles on what is below the hand."""


class Open(Struct, tag="open", frozen=True, kw_only=True):
    """Open the thing with this id."""

    thing: str


class Close(Struct, tag="close", frozen=True, kw_only=True):
    """Close the thing with this id."""

    thing: str


class Wait(Struct, tag="wait", frozen=True, kw_only=True):
    """Stand still for ``seconds``, at least one tick."""

    seconds: float = 0.1


Motion = Move | Rotate | Pick | Place | Drop | Open | Close | Wait


class Send(Struct, tag="send", frozen=True, kw_only=True):
    """Send ``text`` with the sender's own picture, about ``object``, believed to be at ``position`` [m]."""

    text: str
    object: str = ""
    position: Vec3 | None = None


class Reply(Struct, tag="reply", frozen=True, kw_only=True):
    """Confirm (``accept``) or decline message number ``message``."""

    message: int
    accept: bool


class Action(Struct, frozen=True, kw_only=True):
    """One motion and one utterance; speaking never stops walking."""

    motion: Motion = Wait()
    say: Send | Reply | None = None


# ------------------------------------------------------------------------------------------------------------- outcomes


class Event(Struct, frozen=True, kw_only=True):
    """Something that happened: who, when, what."""

    tick: int
    seat: str
    kind: str
    data: dict[str, Any] = {}


class Snapshot(Struct, frozen=True, kw_only=True):
    """The truth at one tick, for the umpire and the log, never for a mind.

    ``in_view`` lists, for the person's seat, the objects that are in view within `rules.FIND_RANGE_M`.
    """

    tick: int
    poses: Mapping[str, Pose]
    things: Mapping[str, ThingState]
    in_view: Mapping[str, tuple[str, ...]]
    holding: Mapping[str, str]


class Mind(Protocol):
    """What sits in a seat: an agent or a human model."""

    def begin(self, briefing: Briefing) -> None: ...
    def act(self, observation: Observation) -> Action: ...
