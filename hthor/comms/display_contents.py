"""What a person sees on their display now: a message, and a map of directions and distances from where they are."""

from collections.abc import Callable, Sequence

from hthor.comms.display import DisplayState
from hthor.comms.mailbox import Mailbox
from hthor.geometry.plane import turn
from hthor.types import Display, DisplayMap, MapBody, MapPlace, Pose
from hthor.types.events import Sent

_DECIMALS = 3
"""Positions on the map are given to the millimetre."""


_NOTHING = Display()


def display_contents(state: DisplayState, mailbox: Mailbox, pose: Callable[[str], Pose]) -> Display:
    """What a display shows; ``pose`` gives the present pose of a seat's body, house frame."""
    if state.message is None:
        return _NOTHING
    return Display(
        message=mailbox.message(state.message.message) if state.on["panel"] else None,
        map=relative_map(pose(state.seat), state.confirmed, pose) if state.on["map"] else None,
    )


def relative_map(person: Pose, confirmed: Sequence[Sent], pose: Callable[[str], Pose]) -> DisplayMap:
    """The map of a person who has confirmed some messages.

    Args:
        person: their pose, house frame; the map turns with their head.
        confirmed: the messages, as in `hthor.comms.display.DisplayState`.
        pose: gives the present pose of a seat's body, house frame.
    """

    bodies, places = [], []
    x, y, away = person.x, person.y, -person.gaze
    for seat in sorted({message.seat for message in confirmed}):
        body = pose(seat)
        forward, left = turn((body.x - x, body.y - y), away)
        bodies.append(MapBody(seat=seat, forward=round(forward, _DECIMALS), left=round(left, _DECIMALS)))
    for one in confirmed:
        if one.position is not None:
            forward, left = turn((one.position[0] - x, one.position[1] - y), away)
            forward, left = round(forward, _DECIMALS), round(left, _DECIMALS)
            places.append(MapPlace(message=one.message, sender=one.seat, object=one.object, forward=forward, left=left))
    return DisplayMap(bodies=tuple(bodies), places=tuple(places))
