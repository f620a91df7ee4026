"""Events of bodies and hands in the world."""

from hthor.types.events.entry import LogEntry


class Picked(LogEntry, frozen=True, kw_only=True, tag="picked"):
    """The seat took an object in hand.

    Attributes:
        object: its id.
    """

    object: str


class Placed(LogEntry, frozen=True, kw_only=True, tag="placed"):
    """The seat put down the object in its hand.

    Attributes:
        object: its id.
        on: the id of the furniture that it was placed on or in, or "floor".
    """

    object: str
    on: str


class Dropped(LogEntry, frozen=True, kw_only=True, tag="dropped"):
    """The seat let the object in its hand fall.

    Attributes:
        object: its id.
    """

    object: str


class Opened(LogEntry, frozen=True, kw_only=True, tag="opened"):
    """The seat opened a piece of furniture or a door.

    Attributes:
        thing: its id.
    """

    thing: str


class Closed(LogEntry, frozen=True, kw_only=True, tag="closed"):
    """The seat closed a piece of furniture or a door.

    Attributes:
        thing: its id.
    """

    thing: str


class Held(LogEntry, frozen=True, kw_only=True, tag="held"):
    """The seat took hold of a handle of a thing that is too heavy for it alone.

    Attributes:
        object: the thing's id.
    """

    object: str


class Lifted(LogEntry, frozen=True, kw_only=True, tag="lifted"):
    """With the seat's help there were enough bearers, and a heavy thing rose.

    Attributes:
        object: the thing's id.
        bearers: the seats that hold it, in the order in which they took hold.
    """

    object: str
    bearers: tuple[str, ...]


class Lowered(LogEntry, frozen=True, kw_only=True, tag="lowered"):
    """The seat let go of a thing that was carried, and it was put down; nobody holds it any more.

    Attributes:
        object: the thing's id.
        bearers: the seats that had held it, in the order in which they took hold.
    """

    object: str
    bearers: tuple[str, ...]


class Released(LogEntry, frozen=True, kw_only=True, tag="released"):
    """The seat let go of a handle; the thing stays where it is.

    Attributes:
        object: the thing's id.
    """

    object: str


class Blocked(LogEntry, frozen=True, kw_only=True, tag="blocked"):
    """A move of the seat's body ended early at something in the house.

    Attributes:
        by: the id of the furniture or door that was in the way, or "wall".
    """

    by: str


class InWay(LogEntry, frozen=True, kw_only=True, tag="in_way"):
    """From this tick on another body hindered a move of the seat's body; once per move.

    Attributes:
        by: the other body's seat.
    """

    by: str


class Refused(LogEntry, frozen=True, kw_only=True, tag="refused"):
    """A motion, a message or an answer of the seat was not possible.

    Attributes:
        reason: why.
        motion: which motion, such as "pick"; empty for a message or an answer.
        message: the number of the message that could not be answered.
    """

    reason: str
    motion: str = ""
    message: int | None = None
