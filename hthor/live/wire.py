"""The messages between the server of a live session and the page that a person has open.

A page connects with the WebSocket sub-protocol `VERSION`, and joins with the token of its seat. Then both sides send
JSON objects, whose ``type`` says which of these records they are, and binary frames: the page sends `Steering` in every
picture that it draws, and the server sends `encode_frame` in every step of the trial.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping
from typing import Any, NamedTuple, TypeVar

import msgspec
import numpy as np
from msgspec import Struct

from hthor import rules
from hthor.types import (
    Close,
    DisplayMap,
    Drive,
    Drop,
    Open,
    Outcome,
    Pick,
    Place,
    Ready,
    Reply,
    Send,
    Show,
    Vec3,
)

VERSION = "hthor.live.2"
"""The sub-protocol. A page of another version is refused with a sentence."""
LARGEST = 16_384
"""[bytes] No message of a page is larger; one that is ends its connection."""

PRACTICE = -1
"""The number of the practice among a session's trials, which count from 0."""

HandMotion = Pick | Place | Drop | Open | Close
"""The motions of the hands; walking and looking come as `Steering`."""

# -------------------------------------------------------------------------------------------------------- from a page


class Join(Struct, frozen=True, kw_only=True, tag="join"):
    """The first message of a page: which seat it is for."""

    token: str


class Begin(Struct, frozen=True, kw_only=True, tag="begin"):
    """The person has read the task, and the trial may begin."""

    trial: int


class Act(Struct, frozen=True, kw_only=True, tag="act"):
    """The hands, the buttons and the words of the person.

    Attributes:
        number: counts the acts of the seat from 1. A page sends an act again until it is acknowledged; the server
            carries each out once.
    """

    number: int
    motion: HandMotion | None = None
    say: Reply | Send | None = None
    signals: tuple[Show | Ready, ...] = ()


class Rate(Struct, frozen=True, kw_only=True, tag="rate"):
    """The person's trust in the robots after a trial, from `rules.TRUST_MIN` to `rules.TRUST_MAX`."""

    trial: int
    value: int


class Skip(Struct, frozen=True, kw_only=True, tag="skip"):
    """The person does not want to practise any longer, or at all; ``trial`` is the practice's number."""

    trial: int


class Ping(Struct, frozen=True, kw_only=True, tag="ping"):
    """Answered by `Pong`.

    Attributes:
        frames: [1/s] how many pictures the page draws. round_trip: [s] of the last ping.
        vr: whether the person is in VR. off: whether they have taken the headset off, its system's menu hides the
            house, or they have left VR and not said that they go on at the desk.
    """

    sent: float
    frames: float = 0.0
    round_trip: float = 0.0
    vr: bool = False
    off: bool = False


FromPage = Join | Begin | Act | Rate | Skip | Ping
"""What a page may send."""


class Hand(NamedTuple):
    """The hand of somebody with a headset: its ``place`` [m] and the unit vector that it points along, house frame."""

    place: Vec3
    direction: Vec3


class Steering(NamedTuple):
    """The stick, the head and the hand of the person; newer ones replace older ones.

    ``number`` counts them; the server's frames say which one took effect last. ``hand`` is the hand that acts; None for
    somebody at a desk, whose hand is where they look.
    """

    number: int
    drive: Drive
    hand: Hand | None = None


# ---------------------------------------------------------------------------------------------------------- to a page


class Welcome(Struct, frozen=True, kw_only=True, tag="welcome"):
    """The answer to `Join`.

    Attributes:
        seat: the person's. acts: the number of the last act that was carried out; the page counts on from it.
        server: differs when the server was started once more; acts that were sent to the last one are lost.
    """

    seat: str
    acts: int
    server: str
    version: str = VERSION


class Problem(Struct, frozen=True, kw_only=True, tag="problem"):
    """Why the connection ends, in words for the person or the experimenter."""

    words: str


class Body(Struct, frozen=True, kw_only=True):
    """A body of the trial: ``radius`` and ``height`` [m], ``reach`` [m], ``speed`` [m/s] and ``turn_rate`` [rad/s]."""

    seat: str
    name: str
    radius: float
    height: float
    eye: float
    reach: float
    speed: float
    turn_rate: float


class TrialAhead(Struct, frozen=True, kw_only=True, tag="trial"):
    """The next trial, which begins when every person has sent `Begin`.

    Attributes:
        trial: its number in the session, from 0, of ``trials``; `PRACTICE` for the practice before them.
        practice: whether it is the practice. phases: whether the task has phases, which a person can end by a signal.
        house: the floor plan's name.
        instruction: the task in words. time_limit: [s].
        bodies: of all seats. file: the address of the house's glTF file, on this server. own: the numbers of what the
            person does not see of themselves in it, their body and their head.
    """

    trial: int
    trials: int
    house: str
    instruction: str
    time_limit: float
    bodies: tuple[Body, ...]
    file: str = ""
    own: tuple[int, ...] = ()
    practice: bool = False
    phases: bool = False


class Step(Struct, frozen=True, kw_only=True):
    """Something to try in the practice, in words.

    Attributes:
        actions: what its keys do, in the words of the page's ``keys.js``. done: whether the person has tried it.
    """

    name: str
    words: str
    actions: tuple[str, ...]
    done: bool = False


class HeadsetAsked(Struct, frozen=True, kw_only=True, tag="headset_asked"):
    """Whether the experimenter asks people to enter VR, which browsers let only the person do."""

    on: bool


class Steps(Struct, frozen=True, kw_only=True, tag="steps"):
    """What there is to try in the practice, whenever that changes; ``skipped``: whether the person sent `Skip`."""

    steps: tuple[Step, ...]
    skipped: bool = False


class Began(Struct, frozen=True, kw_only=True, tag="began"):
    """The trial has begun."""

    trial: int


class Now(Struct, frozen=True, kw_only=True, tag="now"):
    """The state of the person, whenever it changes.

    Attributes:
        tick: since when. holding: id of the object in hand, empty for none. busy: whether the hands are.
        outcome: how the last motion of the hands ended. room: the id of the room.
    """

    tick: int
    holding: str
    busy: bool
    room: str
    phase: str
    outcome: Outcome | None


class Choice(Struct, frozen=True, kw_only=True):
    """A motion of the hands that is offered, and its words."""

    words: str
    motion: HandMotion


class Choices(Struct, frozen=True, kw_only=True, tag="choices"):
    """What the hand would do now, and what would be opened or closed; None for nothing."""

    hand: Choice | None = None
    door: Choice | None = None


class Panel(Struct, frozen=True, kw_only=True, tag="panel"):
    """What the panel shows from now on; ``message`` None while it is hidden.

    ``picture`` says that a binary frame with the message's picture follows.
    """

    message: int | None
    sender: str = ""
    text: str = ""
    question: bool = False
    picture: bool = False


class Map(Struct, frozen=True, kw_only=True, tag="map"):
    """What the map shows from now on; None while it is hidden."""

    map: DisplayMap | None


class Acknowledged(Struct, frozen=True, kw_only=True, tag="acknowledged"):
    """The acts up to this number were carried out."""

    act: int


class Paused(Struct, frozen=True, kw_only=True, tag="paused"):
    """The trial's time stands still; ``reason`` in words, empty when it goes on."""

    reason: str


class Ended(Struct, frozen=True, kw_only=True, tag="ended"):
    """The trial is over. ``rate``: whether the person is asked for their trust now."""

    trial: int
    met: bool
    voided: str
    rate: bool


class Over(Struct, frozen=True, kw_only=True, tag="over"):
    """The session is over.

    Attributes:
        page: the address of the person's own page on this server; empty for none. making: whether it is being made.
    """

    trials: int
    page: str = ""
    making: bool = False


class Pong(Struct, frozen=True, kw_only=True, tag="pong"):
    """The answer to a `Ping`, with its time."""

    sent: float


ToPage = (
    Welcome
    | Problem
    | TrialAhead
    | HeadsetAsked
    | Steps
    | Began
    | Now
    | Choices
    | Panel
    | Map
    | Acknowledged
    | Paused
    | Ended
    | Over
    | Pong
)
"""What the server sends."""

_TO_PAGE = msgspec.json.Encoder()
_FROM_PAGE: msgspec.json.Decoder[FromPage] = msgspec.json.Decoder(FromPage)
_Message = TypeVar("_Message")
_STEERING, _HAND = struct.Struct("<BIffff"), struct.Struct("<ffffff")
_HEAD = struct.Struct("<BIBIfffff")
_NUMBER, _ROW = struct.Struct("<H"), struct.Struct("<H7h")
_STEER, _FRAME, _PICTURE = 1, 2, 3


class Malformed(ValueError):
    """A message of a page that is none."""


def decode(text: str) -> FromPage:
    """A JSON message of a person's page; errors as in `read`."""
    return read(text, _FROM_PAGE)


def read(text: str, decoder: msgspec.json.Decoder[_Message]) -> _Message:
    """A JSON message of a page.

    Raises:
        Malformed: says what is wrong.
    """
    try:
        return decoder.decode(text)
    except (msgspec.MsgspecError, UnicodeError, RecursionError) as error:
        raise Malformed(str(error)) from None


def decode_steering(data: bytes) -> Steering:
    """A binary frame of a page.

    Raises:
        Malformed: when it is none, or a number in it is not finite.
    """
    sizes = _STEERING.size, _STEERING.size + _HAND.size
    if len(data) not in sizes or data[0] != _STEER:
        raise Malformed(f"a binary frame has {sizes[0]} or {sizes[1]} bytes and begins with {_STEER}")
    _, number, *drive = _STEERING.unpack_from(data)
    hand = _HAND.unpack_from(data, _STEERING.size) if len(data) == sizes[1] else ()
    if not all(map(math.isfinite, (*drive, *hand))):
        raise Malformed("a number of the steering is not finite")
    forward, left, yaw, pitch = drive
    return Steering(
        number,
        Drive(forward=forward, left=left, yaw=yaw, pitch=pitch),
        Hand((hand[0], hand[1], hand[2]), (hand[3], hand[4], hand[5])) if hand else None,
    )


def encode_steering(steering: Steering) -> bytes:
    """A binary frame of a page, as `decode_steering` reads it; for clients in Python."""
    drive, hand = steering.drive, steering.hand
    head = _STEERING.pack(_STEER, steering.number, drive.forward, drive.left, drive.yaw, drive.pitch)
    return head if hand is None else head + _HAND.pack(*hand.place, *hand.direction)


def encode(message: Struct) -> str:
    """A message of the server's, for a person's page or the experimenter's, as JSON."""
    return _TO_PAGE.encode(message).decode()


class FrameHead(NamedTuple):
    """What a frame says about the person that it is for.

    ``tick`` and ``step`` count the time of the trial; ``steering`` is the number of the page's last `Steering` that
    took effect; x, y [m], yaw of the body, and yaw and pitch of the head [rad].
    """

    tick: int
    step: int
    steering: int
    x: float
    y: float
    yaw: float
    gaze: float
    pitch: float


def round_poses(poses: Any) -> Any:
    """Poses (P, 7) of position [m] and quaternion as they are in frames, (P, 7) int16: millimetres, and parts of 32767.

    What is farther than 32 m from the origin is not in the house, and is put there.
    """
    rounded = np.empty(poses.shape, np.int16)
    rounded[:, :3] = np.clip(np.round(poses[:, :3] * 1000.0), -32767, 32767)
    rounded[:, 3:] = np.round(poses[:, 3:] * 32767.0)
    return rounded


def encode_frame(head: FrameHead, moved: Mapping[int, bytes]) -> bytes:
    """Where the person is, and what has moved since the last frame that this page got.

    Args:
        moved: by its number, a row of `round_poses`.

    Returns:
        little-endian: 2 (u8), tick (u32), step (u8), steering (u32), five f32 of `FrameHead`; then for everything that
        has moved its number (u16) and seven i16.
    """
    rows = b"".join(_NUMBER.pack(number) + row for number, row in moved.items())
    return _HEAD.pack(_FRAME, *head) + rows


def decode_frame(data: bytes) -> tuple[FrameHead, dict[int, tuple[int, ...]]]:
    """A frame, as `encode_frame` packs it; for clients in Python."""
    head = FrameHead(*_HEAD.unpack_from(data)[1:])
    rows = (_ROW.unpack_from(data, at) for at in range(_HEAD.size, len(data), _ROW.size))
    return head, {row[0]: row[1:] for row in rows}


def encode_picture(message: int, jpeg: bytes) -> bytes:
    """The picture of a message: 3 (u8), the message's number (u32), and a JPEG file."""
    return struct.pack("<BI", _PICTURE, message) + jpeg


def is_rating(value: int) -> bool:
    """Whether a number is a rating of trust."""
    return rules.TRUST_MIN <= value <= rules.TRUST_MAX
