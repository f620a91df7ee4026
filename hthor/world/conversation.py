"""What the seats of a world say to each other, what is on people's displays, and everything that happened."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from hthor.comms import map_picture
from hthor.comms.display import Displays
from hthor.comms.display_contents import display_contents
from hthor.comms.mailbox import Mailbox
from hthor.errors import HthorError
from hthor.types import Display, Pose, is_person
from hthor.types.events import Event
from hthor.world import numbers


class Conversation:
    """The mailbox, the displays and the events of one episode; see `World` for each call.

    Args:
        seats: all seats, the people's first. pose: returns where a body is.

    Attributes:
        mail: the mailbox. displays: which parts of the people's displays are shown.
        events: everything that has happened since the last reset, in order.
    """

    def __init__(self, seats: Sequence[str], pose: Callable[[str], Pose]) -> None:
        self._seats, self._pose = tuple(seats), pose
        self.begin()

    def begin(self) -> None:
        """Begin an episode: nobody has said anything."""
        people = tuple(seat for seat in self._seats if is_person(seat))
        self.mail = Mailbox(self._seats[len(people) :], people)
        self.events: list[Event] = []
        self.displays = Displays(people, self.events)

    def note(self, events: Iterable[Event]) -> None:
        """Add events to `events`."""
        self.events.extend(events)

    def display(self, seat: str) -> Display:
        """See `World.display`."""
        state = self.displays.state(seat)
        if state is None:
            raise HthorError(f"{seat} has no display; only people have: {', '.join(self.displays.people)}")
        return display_contents(state, self.mail, self._pose)

    def map_view(self, seat: str, size: int = map_picture.SIZE_PX) -> NDArray[np.uint8]:
        """See `World.map_view`."""
        shown, side = self.display(seat).map, numbers.whole_number("size", size, 40, 4000)
        if shown is None:
            has = self.displays.state(seat)
            what = "it is hidden: show('map') shows it" if has and has.confirmed else "no message was confirmed yet"
            raise HthorError(f"there is no map on the display of {seat}; {what}")
        return map_picture.draw_map(shown, side)
