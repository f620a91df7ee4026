"""The actions of agents and human models: one motion and one utterance at a time."""

from typing import Protocol, TypeVar

import msgspec
from msgspec import Struct

from hthor.types.house import Vec3
from hthor.types.signals import Signal

SUBTICKS = 6
"""Steps of a tick in which a body that drives is moved: 60 a second, about as often as a headset shows a picture."""


class Move(Struct, tag="move", frozen=True, kw_only=True):
    """Walk by ``forward`` and ``left`` [m] in the body's frame, at the body's speed.

    The vector is at most `rules.MOVE_MAX_M` long. The body slides along an obstacle that it meets at an angle. Where it
    cannot slide it stops, and the outcome names the obstacle.
    """

    forward: float
    left: float = 0.0


class Rotate(Struct, tag="rotate", frozen=True, kw_only=True):
    """Turn by ``yaw`` [rad], left positive, at most a full turn; tilt the camera by ``pitch`` [rad], up positive."""

    yaw: float = 0.0
    pitch: float = 0.0


class Pick(Struct, tag="pick", frozen=True, kw_only=True):
    """Pick up the object with this id; it must be in reach, in front of the body, in sight, and not too heavy."""

    object: str


class Place(Struct, tag="place", frozen=True, kw_only=True):
    """Put the held object on or in the thing ``on`` (an id); near ``position`` [m], house frame, if that is given."""

    on: str
    position: Vec3 | None = None


class Drop(Struct, tag="drop", frozen=True, kw_only=True):
    """Let go of the held object: it falls, may roll, and comes to rest on whatever is below the hand."""


class Open(Struct, tag="open", frozen=True, kw_only=True):
    """Open the thing or door with this id; it must be in reach and in sight."""

    thing: str


class Close(Struct, tag="close", frozen=True, kw_only=True):
    """Close the thing or door with this id; it must be in reach and in sight."""

    thing: str


class Wait(Struct, tag="wait", frozen=True, kw_only=True):
    """Stand still for ``seconds`` [s], at most an hour; rounded up to whole ticks, at least one tick."""

    seconds: float = 0.1


class Drive(Struct, tag="drive", frozen=True, kw_only=True):
    """Keep going at this velocity, and hold the head like this, until another motion replaces it.

    It never ends by itself and is never refused: a velocity beyond the body's speed is shortened to it, and a number
    that is not finite counts as 0. In every step of `SUBTICKS` to a tick the body moves as far as the house and
    other bodies let it, sliding along what it meets, as in a `Move`. A person's head points where ``yaw`` and ``pitch``
    say at once, and the body turns after it at its turn rate; a robot, which has no neck, turns at its turn rate and
    tilts its camera within its limit. While the hands are busy, only the head moves.

    Attributes:
        forward, left: [m/s] velocity, in the frame of ``yaw``.
        yaw: [rad] heading of the head, house frame, counter-clockwise from +x. pitch: [rad] up positive.
    """

    forward: float = 0.0
    left: float = 0.0
    yaw: float = 0.0
    pitch: float = 0.0


Motion = Move | Rotate | Pick | Place | Drop | Open | Close | Wait | Drive


class Send(Struct, tag="send", frozen=True, kw_only=True):
    """A message: text, and from a robot a picture of what it sees now.

    Attributes:
        text: its words.
        object: the id or kind of the thing that the message is about, empty for none.
        position: [m], house frame, where the sender believes that thing to be.
        to: the seat that it is for; empty for all people from a robot, and for everybody else from a person.
        question: whether it asks for an answer: yes or no (`Reply`), or a message with ``answers``.
        answers: the number of the question that it answers.
    """

    text: str
    object: str = ""
    position: Vec3 | None = None
    to: str = ""
    question: bool = False
    answers: int | None = None


class Reply(Struct, tag="reply", frozen=True, kw_only=True):
    """A person's answer to message number ``message``: accept or decline it; for a question, yes or no."""

    message: int
    accept: bool


class Action(Struct, frozen=True, kw_only=True):
    """One motion, at most one utterance, and any signals; only the motion occupies the body."""

    motion: Motion = Wait()
    say: Send | Reply | None = None
    signals: tuple[Signal, ...] = ()


class _Acting(Protocol):
    @property
    def say(self) -> Send | Reply | None: ...
    @property
    def signals(self) -> tuple[Signal, ...]: ...


_AnyAction = TypeVar("_AnyAction", bound=_Acting)


def merge_actions(before: _AnyAction, after: _AnyAction) -> _AnyAction:
    """What two actions of a seat for the same tick come to: ``after``, with the words of ``before`` if it says nothing,
    and with the signals of both.
    """
    say, signals = after.say or before.say, before.signals + after.signals
    return msgspec.structs.replace(after, say=say, signals=signals)  # type: ignore[type-var]  # a record like all types
