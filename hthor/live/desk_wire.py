"""The messages between the server of a live session and the experimenter's page: JSON objects in both directions."""

from __future__ import annotations

import msgspec
from msgspec import Struct

from hthor.live import wire
from hthor.types import Vec2
from hthor.types.events import Event

# -------------------------------------------------------------------------------------------------------- from the page


class Pause(Struct, frozen=True, kw_only=True, tag="pause"):
    """Let time stand still."""

    reason: str = ""


class GoOn(Struct, frozen=True, kw_only=True, tag="go_on"):
    """Let time go on."""


class Void(Struct, frozen=True, kw_only=True, tag="void"):
    """End the trial; it does not count, and is repeated as another attempt."""

    reason: str


class Adoption(Struct, frozen=True, kw_only=True, tag="adoption"):
    """Correct whether the person in a ``seat`` adopted a suggestion in a ``trial`` (its key); None excludes them."""

    trial: str
    seat: str
    adopted: bool | None
    reason: str


FromDesk = Pause | GoOn | Void | Adoption
"""What the experimenter may do."""


# ---------------------------------------------------------------------------------------------------------- to the page


class RoomPlan(Struct, frozen=True, kw_only=True):
    """A room and its floor [m]."""

    name: str
    polygon: tuple[Vec2, ...]


class Plan(Struct, frozen=True, kw_only=True, tag="plan"):
    """The trial that is going on, or comes next; ``attempt`` counts how often it was voided before."""

    trial: int
    attempt: int
    task: str
    instruction: str
    time_limit: float
    seats: tuple[str, ...]
    rooms: tuple[RoomPlan, ...]


class Person(Struct, frozen=True, kw_only=True):
    """Where a body is [m], where it looks [rad], and how its page is: away for so long [s], the time of a message there
    and back [ms], and the pictures that it draws [1/s]; None without a page.
    """

    seat: str
    x: float
    y: float
    yaw: float
    away_s: float | None
    round_trip_ms: int | None
    frames: int | None


class Watch(Struct, frozen=True, kw_only=True, tag="watch"):
    """The trial now; ``factor`` is its time by wall-clock time."""

    tick: int
    paused: str
    factor: float
    people: tuple[Person, ...]


class Happened(Struct, frozen=True, kw_only=True, tag="happened"):
    """An event of the trial: its tick, seat and kind, and what else its record says."""

    tick: int
    seat: str
    kind: str
    words: str


class PlayedTrial(Struct, frozen=True, kw_only=True):
    """A trial that is over: its key, whether its goal was met, why it does not count, and each person's adoption."""

    key: str
    task: str
    index: int
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


ToDesk = Plan | Watch | Happened | Played | Refused
"""What the server sends."""

_FROM_DESK: msgspec.json.Decoder[FromDesk] = msgspec.json.Decoder(FromDesk)


def decode(text: str) -> FromDesk:
    """A message of the page; errors as in `hthor.live.wire.read`."""
    return wire.read(text, _FROM_DESK)


def happened(event: Event) -> Happened:
    """An event in a line."""
    fields = msgspec.to_builtins(event)
    rest = {name: value for name, value in fields.items() if name not in ("tick", "seat", "kind")}
    words = ", ".join(f"{name} {value}" for name, value in rest.items())
    return Happened(tick=event.tick, seat=event.seat, kind=event.kind, words=words)
