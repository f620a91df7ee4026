"""What an agent or a human model is given: messages, observations, briefings."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from msgspec import Struct

from hthor.types.house import HouseSpec, Pose, Vec3
from hthor.types.sensors import Camera, DepthImage, Detection, LabelImage, RgbImage, Scan, Senses
from hthor.types.specs import RELATIONS, BodySpec, Job

if TYPE_CHECKING:
    ImageSource: TypeAlias = Callable[[], RgbImage] | None
    SeatSenses: TypeAlias = Senses
else:  # an observation crosses to an agent's process without its senses and images, which are asked for there
    ImageSource = SeatSenses = Any

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
