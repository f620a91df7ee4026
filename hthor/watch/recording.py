"""What the page that shows a trial is given: who took part, where everything was at every tick, what happened.

The page reads it as JSON. Nothing in it depends on when or where it was made.
"""

from __future__ import annotations

import base64
from collections.abc import Sequence

from msgspec import Struct

from hthor import jsonio
from hthor.types import Vec2, Vec3

SCHEMA = "hthor.watch/1"


class Seat(Struct, frozen=True, kw_only=True):
    """Somebody who took part.

    Attributes:
        name: who that is, in words. colour: of their path, such as "#0072B2".
        eye: [m] height of the eye. own: the numbers of body and head in the house's file.
        fov: [rad] horizontal and vertical field of view; None for a person at a page, which has one of its own.
    """

    seat: str
    name: str
    person: bool
    colour: str
    eye: float
    height: float
    own: tuple[int, ...]
    fov: Vec2 | None


class Track(Struct, frozen=True, kw_only=True):
    """Where one part was that moved, or that stood anywhere.

    A part stays where it is until the next tick that is listed.

    Attributes:
        part: its number in the house's file.
        ticks: at which its place changed, each as the difference to the one before.
        poses: seven lists, for x, y and z [mm] and the quaternion w, x, y and z [1/32767], each value as the difference
            to the one before.
    """

    part: int
    ticks: list[int]
    poses: list[list[int]]


class Line(Struct, frozen=True, kw_only=True):
    """An event, in a sentence; ``minor`` ones happen too often for the timeline."""

    tick: int
    seat: str
    kind: str
    words: str
    minor: bool


class Letter(Struct, frozen=True, kw_only=True):
    """A message: ``position`` [m] is where its sender believes the ``object``; ``picture`` a JPEG file in base64."""

    message: int
    sender: str
    text: str
    question: bool
    object: str
    position: Vec3 | None
    picture: str


class Screen(Struct, frozen=True, kw_only=True):
    """What a person's display shows from a tick on.

    Attributes:
        panel: the number of the message on the panel; None while it is hidden.
        answer: what the person has just answered to it, "confirmed", "declined" or "answered"; empty before.
        map: the numbers of the confirmed messages on the map; None while it is hidden.
    """

    tick: int
    panel: int | None
    answer: str
    map: tuple[int, ...] | None


class RoomPlan(Struct, frozen=True, kw_only=True):
    """A room and its floor [m]."""

    name: str
    polygon: tuple[Vec2, ...]


class Recording(Struct, frozen=True, kw_only=True):
    """A whole trial.

    Attributes:
        run, key, task: the name of the run's folder, the trial's key and its task's id.
        ticks: the trial's length. tick_s, time_limit: [s].
        outcome: how the trial ended, a phrase for each thing to say.
        height: [m] of the rooms.
        screens: by person, see `Screen`; the first is at tick 0.
        hands: for every seat, what it has in hand from a tick on; empty for nothing.
    """

    schema: str = SCHEMA
    run: str
    key: str
    task: str
    instruction: str
    outcome: tuple[str, ...]
    ticks: int
    tick_s: float
    time_limit: float
    height: float
    rooms: tuple[RoomPlan, ...]
    seats: tuple[Seat, ...]
    tracks: tuple[Track, ...]
    events: tuple[Line, ...]
    messages: tuple[Letter, ...]
    screens: dict[str, tuple[Screen, ...]]
    hands: dict[str, tuple[tuple[int, str], ...]]


def encode(recording: Recording) -> bytes:
    """The recording as JSON; the same recording gives the same bytes."""
    return jsonio.canonical(recording)


def make_track(part: int, ticks: Sequence[int], poses: Sequence[Sequence[int]]) -> Track:
    """The track of a part that was at ``poses``, seven whole numbers each, from these rising ``ticks`` on."""
    columns = [list(map(int, column)) for column in zip(*poses, strict=True)]
    return Track(part=part, ticks=_differences(list(ticks)), poses=list(map(_differences, columns)))


def picture(jpeg: bytes) -> str:
    """A JPEG file as text."""
    return base64.b64encode(jpeg).decode()


def _differences(values: list[int]) -> list[int]:
    return [value - before for value, before in zip(values, [0, *values[:-1]], strict=True)]
