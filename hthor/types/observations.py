"""The input of an agent or a human model: messages, observations, briefings."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from msgspec import Struct

from hthor.types.display import DisplayMap
from hthor.types.house import HUMAN, HouseSpec, Pose, Vec3
from hthor.types.sensors import RgbImage, Senses, SensorReadings
from hthor.types.specs import RELATIONS, BodySpec, Job

if TYPE_CHECKING:
    ImageSource: TypeAlias = Callable[[], RgbImage] | None
    SeatSenses: TypeAlias = Senses
else:  # an observation is sent to an agent's process without its senses and images, which that process requests
    ImageSource = SeatSenses = Any

Status = Literal["sent", "shown", "accepted", "declined", "covered", "answered"]


class Message(Struct, frozen=True, kw_only=True):
    """A message: from a robot to people, from a person to robots or other people.

    Attributes:
        id: number of the message in its trial, from 0. sender: its seat. tick: when it was sent.
        text: its words, on one line, at most `rules.TEXT_MAX` characters.
        object: id or kind of the thing that the message is about, empty for none.
        position: [m], house frame, where the sender believes ``object`` to be.
        image: when called, renders what a robot saw at the tick of sending, (H, W, 3) uint8; None without a picture.
        to: the seat that it is for, empty if it is for everybody, as `Send.to` says.
        question: whether it asks for an answer. answers: the number of the question that it answers.
    """

    id: int
    sender: str
    tick: int
    text: str
    object: str = ""
    position: Vec3 | None = None
    image: ImageSource = None
    to: str = ""
    question: bool = False
    answers: int | None = None


class Display(Struct, frozen=True, kw_only=True):
    """What a person's display shows at one moment; both parts can be hidden and shown again, see `Show`.

    Attributes:
        message: the message on the panel; None while the panel is hidden, or before the first message.
        map: where the senders of confirmed messages and the places that they named are, seen from the person; None
            while the map is hidden, or before the first confirmed message.
    """

    message: Message | None = None
    map: DisplayMap | None = None


class Receipt(Struct, frozen=True, kw_only=True):
    """The status of a seat's last message, for one of its readers.

    A message is "sent", then "shown". Its last status is "accepted", "declined", "answered" (for a question), or
    "covered" (replaced by a newer message).

    Attributes:
        message: its number. status: its status; tick: when this status began. by: the reader's seat.
        yes: the answer to a question; None while there is none, or if the answer is a message.
    """

    message: int
    status: Status
    tick: int
    by: str = HUMAN
    yes: bool | None = None


class Outcome(Struct, frozen=True, kw_only=True):
    """How a seat's last motion ended; ``motion`` is the motion's name, such as "move".

    ``reason`` says why the motion failed, empty when ``ok``; ``by`` is the seat, thing or "wall" that was in the way.
    """

    motion: str
    ok: bool
    reason: str = ""
    by: str = ""


class ThingState(Struct, frozen=True, kw_only=True):
    """True state of an object or of an openable thing.

    ``support`` is the id of the thing that it rests on or in, ``held_by`` the seat that has it in hand. ``bearers`` are
    all seats that hold it by a handle; as long as they cannot lift it, ``held_by`` is empty.
    """

    id: str
    kind: str
    position: Vec3
    support: str = ""
    held_by: str = ""
    open: bool = False
    bearers: tuple[str, ...] = ()


class Observation(SensorReadings, Struct, frozen=True, kw_only=True):
    """The input of an agent or a human model that has to act; see `Mind.act`.

    Attributes:
        tick: ticks since the trial began. pose: of the seat's body, house frame.
        idle: whether the body is free for a new motion; if not, only ``Action.say`` takes effect.
        senses: the seat's sensors, which the properties of `SensorReadings` read.
        room: id of the room that the body is in; between rooms, of the room that it was in last.
        holding: id of the object that the body has in hand or holds by a handle; empty for none.
        outcome: how the last motion ended; None before any motion has ended.
        inbox: a person's open message, at most one; a robot's new messages and its open questions.
        receipt: the status of the seat's last message, for the reader whose status changed last; None before its first.
        truth: true states of all objects, only for agents that declare the privilege ``object_poses``; empty in phases
            before the task itself, in which everybody knows only what they see.
        display: what a person's display shows; None for robots, which have none.
        phase: name of the phase of the task, see `Briefing.phases`; empty in the task itself.
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
    display: Display | None = None
    phase: str = ""


class PhaseBriefing(Struct, frozen=True, kw_only=True):
    """What is said before a trial about a phase: its name, what to do in it, and its time limit [s]."""

    name: str
    instruction: str
    time_limit: float


class Briefing(Struct, frozen=True, kw_only=True):
    """The information that an agent or a human model gets before a trial.

    Attributes:
        seat: its own seat. body: its own body. teammates: all other seats. crew: the body in every seat, its own too.
        instruction: the task in words. kind: the task kind. time_limit: [s] of the task. tick_s: [s] of one tick.
        target, destination, relation: of the first job: the object's id (for "go", one of `WALKERS`), the kind of thing
            to place it in or on or to go to (empty for a search), and "find", "on", "in", "at", "back" or "go".
        jobs: all jobs of the task. The relation "back" says that the object belongs where it was in an earlier phase.
        phases: what comes before the task itself, in order; empty for most tasks. A phase ends early when every seat
            has sent the signal `Ready`.
        privileges: declared and granted. house: the floor plan, only with the privilege ``house_map``.
        labels: the kind of what each number of a segmentation stands for, only with the privilege ``pixel_labels``:
            of things and objects as in detections, "floor", "ceiling", "wall", "door", "window", "person", a robot's
            name; "ground", "outdoors" and "roof".
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
    phases: tuple[PhaseBriefing, ...] = ()
    labels: tuple[str, ...] = ()

    @property
    def todo(self) -> tuple[Job, ...]:
        """All jobs of the task; a briefing without a list of jobs describes a single job."""
        if self.jobs:
            return self.jobs
        destinations = (self.destination,) if self.destination else ()
        relation = next((known for known in RELATIONS if known == self.relation), RELATIONS[0])
        return (Job(target=self.target, relation=relation, destinations=destinations),)
