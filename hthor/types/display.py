"""What the map on a person's display shows: directions and distances, never a floor plan or a path."""

from msgspec import Struct


class MapBody(Struct, frozen=True, kw_only=True):
    """Where the sender of a confirmed message is now: ``forward`` and ``left`` of the person [m].

    The frame is that of the person's head: they are at (0, 0) and look along ``forward``.
    """

    seat: str
    forward: float
    left: float


class MapPlace(Struct, frozen=True, kw_only=True):
    """The place that confirmed message number ``message`` names, in the frame of `MapBody` [m].

    Attributes:
        sender: the seat that sent it. object: id or kind of the thing that it is about, empty for none.
    """

    message: int
    sender: str
    forward: float
    left: float
    object: str = ""


class DisplayMap(Struct, frozen=True, kw_only=True):
    """The map on a person's display, as of one moment: ``bodies`` by seat, ``places`` by message."""

    bodies: tuple[MapBody, ...] = ()
    places: tuple[MapPlace, ...] = ()
