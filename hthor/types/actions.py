"""What a mind may do and say."""

from __future__ import annotations

from msgspec import Struct

from hthor.types.house import Vec3


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
