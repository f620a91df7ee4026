"""The messages between the server of a live session and the experimenter's page: JSON objects in both directions."""

from __future__ import annotations

import msgspec
from msgspec import Struct

from hthor.live import wire
from hthor.live.event_sentences import sentence
from hthor.types import Vec2
from hthor.types.events import Event

# -------------------------------------------------------------------------------------------------------- from the page


class Pause(Struct, frozen=True, kw_only=True, tag="pause"):
    """Let time stand still."""

    reason: str = ""


class GoOn(Struct, frozen=True, kw_only=True, tag="go_on"):
    """Let time go on."""


class Start(Struct, frozen=True, kw_only=True, tag="start"):
    """Begin the trial that everybody is ready for; needed only where a `Plan` says so."""


class Void(Struct, frozen=True, kw_only=True, tag="void"):
    """End the trial; it does not count, and is repeated as another attempt."""

    reason: str


class Repeat(Struct, frozen=True, kw_only=True, tag="repeat"):
    """Void a ``trial`` that is over (its key), and repeat it as another attempt when the session's others are over."""

    trial: str
    reason: str


class Look(Struct, frozen=True, kw_only=True, tag="look"):
    """Whether this page is to get the frames of the trial, `hthor.live.wire.encode_frame`, to draw what seats see."""

    on: bool


class AskForHeadset(Struct, frozen=True, kw_only=True, tag="ask_for_headset"):
    """Ask everybody at a page to enter VR, or no longer."""

    on: bool


class Adoption(Struct, frozen=True, kw_only=True, tag="adoption"):
    """Correct whether the person in a ``seat`` adopted a suggestion in a ``trial`` (its key); None excludes them."""

    trial: str
    seat: str
    adopted: bool | None
    reason: str


FromDesk = Start | Pause | GoOn | Void | Repeat | Look | AskForHeadset | Adoption
"""What the experimenter may do."""


# ---------------------------------------------------------------------------------------------------------- to the page


class RoomPlan(Struct, frozen=True, kw_only=True):
    """A room and its floor [m]."""

    name: str
    polygon: tuple[Vec2, ...]


class Eye(Struct, frozen=True, kw_only=True):
    """The eye of a seat: its height [m], and the numbers of its body and its head in the house's file.

    ``fov`` [rad]: horizontal and vertical field of view; None for somebody at a page, which has one of its own.
    """

    seat: str
    height: float
    own: tuple[int, ...]
    fov: Vec2 | None


class Plan(Struct, frozen=True, kw_only=True, tag="plan"):
    """The trial that is going on, or comes next.

    Attributes:
        attempt: how often it was voided before. starts: whether it waits for `Start`.
        file: the address of the house's glTF file, on this server; empty if nobody draws the house.
        eyes: of all seats, with a file.
    """

    trial: int
    attempt: int
    task: str
    instruction: str
    time_limit: float
    seats: tuple[str, ...]
    rooms: tuple[RoomPlan, ...]
    starts: bool = False
    file: str = ""
    eyes: tuple[Eye, ...] = ()


class Gathering(Struct, frozen=True, kw_only=True, tag="gathering"):
    """Who is ready for the trial, who is not, and whether it has begun."""

    ready: tuple[str, ...]
    missing: tuple[str, ...]
    begun: bool = False


class Person(Struct, frozen=True, kw_only=True):
    """Where a body is [m], where it looks [rad], and how its page is: away for so long [s], the time of a message there
    and back [ms], the pictures that it draws [1/s], and whether the person is in VR; None without a page.
    """

    seat: str
    x: float
    y: float
    yaw: float
    away_s: float | None
    round_trip_ms: int | None
    frames: int | None
    vr: bool | None


class Watch(Struct, frozen=True, kw_only=True, tag="watch"):
    """The trial now; ``factor`` is its time by wall-clock time."""

    tick: int
    paused: str
    factor: float
    people: tuple[Person, ...]


class TrialOver(Struct, frozen=True, kw_only=True, tag="trial_over"):
    """The trial is over: whether its goal was met, and why it does not count, if so. The next one is prepared."""

    met: bool
    voided: str


class Line(Struct, frozen=True, kw_only=True):
    """An event of the trial: its tick, seat and kind, and a sentence that says what happened."""

    tick: int
    seat: str
    kind: str
    words: str


class Happened(Struct, frozen=True, kw_only=True, tag="happened"):
    """What has happened since the last of these messages; a page that joins gets all of the trial so far in one."""

    events: tuple[Line, ...]


class Ways(Struct, frozen=True, kw_only=True, tag="ways"):
    """Where every seat has been so far [m], for a page that joins."""

    ways: dict[str, list[Vec2]]


class PlayedTrial(Struct, frozen=True, kw_only=True):
    """A trial that is over: its key, which attempt it was, whether its goal was met, why it does not count, and each
    person's adoption.
    """

    key: str
    task: str
    index: int
    attempt: int
    met: bool
    seconds: float
    voided: str
    adopted: dict[str, bool | None]
    corrections: tuple[str, ...]


class Played(Struct, frozen=True, kw_only=True, tag="played"):
    """All trials that are over."""

    trials: tuple[PlayedTrial, ...]


class Refused(Struct, frozen=True, kw_only=True, tag="refused"):
    """Why something cannot be done."""

    words: str


class SessionOver(Struct, frozen=True, kw_only=True, tag="session_over"):
    """The session is over; ``pages`` are the files of people's own pages in the run's ``folder``, by their seat."""

    folder: str
    pages: dict[str, str]


ToDesk = Plan | Gathering | Watch | TrialOver | Ways | Happened | Played | SessionOver | Refused | wire.HeadsetAsked
"""What the server sends."""

_FROM_DESK: msgspec.json.Decoder[FromDesk] = msgspec.json.Decoder(FromDesk)


def decode(text: str) -> FromDesk:
    """A message of the page; errors as in `hthor.live.wire.read`."""
    return wire.read(text, _FROM_DESK)


def line(event: Event) -> Line:
    """An event in a line."""
    return Line(tick=event.tick, seat=event.seat, kind=event.kind, words=sentence(event))
