"""The actions of agents and human models: one motion and one utterance at a time."""

from msgspec import Struct

from hthor.types.house import Vec3


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


Motion = Move | Rotate | Pick | Place | Drop | Open | Close | Wait


class Send(Struct, tag="send", frozen=True, kw_only=True):
    """A robot's message to the person: ``text`` and a picture of what the sender sees now.

    ``object`` is the id or kind of the thing that the message is about; ``position`` [m], house frame, is where the
    sender believes that thing to be.
    """

    text: str
    object: str = ""
    position: Vec3 | None = None


class Reply(Struct, tag="reply", frozen=True, kw_only=True):
    """The person's answer to message number ``message``: accept it or decline it."""

    message: int
    accept: bool


class Action(Struct, frozen=True, kw_only=True):
    """One motion and at most one utterance; an utterance never interrupts a motion."""

    motion: Motion = Wait()
    say: Send | Reply | None = None
