"""Messages of one seat of a `World`, and what is on a person's display."""

from collections.abc import Iterable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hthor.comms import map_picture
from hthor.errors import HthorError
from hthor.types import Display, Message, Receipt, Reply, Send, Show, Vec3, is_person
from hthor.types.events import Event, Refused
from hthor.world.actor.actor_world import ActorWorld


class SeatMessages:
    """One ``seat`` of a ``world`` as far as it sends, reads and answers messages."""

    def __init__(self, world: ActorWorld, seat: str) -> None:
        self._world, self.seat = world, seat

    def send(
        self,
        text: str,
        object: str = "",
        position: Vec3 | None = None,
        *,
        to: str = "",
        question: bool = False,
        answers: int | None = None,
    ) -> Receipt:
        """Send a message; a robot's has an image, its own view now.

        Args:
            text: its words. object: id or kind of the thing it is about. position: [m] where the sender believes it is.
            to, question, answers: as in `hthor.types.Send`.

        Raises:
            HthorError: when this seat may not send that, or an argument is invalid.
        """
        world = self._world
        send = Send(text=text, object=object, position=position, to=to, question=question, answers=answers)
        image = None if is_person(self.seat) else world.frame(self.seat)
        self._post(world.mail.send(world.tick, self.seat, send, image))
        receipt = world.mail.receipt(self.seat)
        assert receipt is not None
        return receipt

    def inbox(self) -> tuple[Message, ...]:
        """A person's open message; a robot's new messages and open questions. Reading sets their status to "shown"."""
        messages = self._world.mail.inbox(self.seat)
        if messages:
            self._post(self._world.mail.shown(self._world.tick, self.seat))
        return messages

    def reply(self, accept: bool, message: int | None = None) -> None:
        """Accept or decline a message: the one with number ``message``, or the open one if None.

        Raises:
            HthorError: when no message waits for an answer, or this seat may not reply.
        """
        if message is None:
            waiting = self.inbox()
            if not waiting:
                raise HthorError(f"there is no message for {self.seat} to answer")
            message = waiting[0].id
        self._post(self._world.mail.reply(self._world.tick, self.seat, Reply(message=message, accept=accept)))

    def receipt(self) -> Receipt | None:
        """The latest status of this seat's last message, see `hthor.types.Receipt`; None before any."""
        return self._world.mail.receipt(self.seat)

    @property
    def display(self) -> Display:
        """What a person's display shows now: the message on the panel, and the map after a confirmed message.

        Raises:
            HthorError: when this seat is a robot's.
        """
        return self._world.display(self.seat)

    def map_view(self, size: int = map_picture.SIZE_PX) -> NDArray[np.uint8]:
        """The picture of the map on this person's display, (size, size, 3) uint8, see `World.map_view`.

        Raises:
            HthorError: while no map is shown.
        """
        return self._world.map_view(self.seat, size)

    def show(self, what: Literal["panel", "map"]) -> None:
        """Show a part of this person's display again; nothing changes if it is shown.

        Raises:
            HthorError: when there is nothing to show yet, or this seat has no display.
        """
        self._set_display(what, on=True)

    def hide(self, what: Literal["panel", "map"]) -> None:
        """Hide a part of this person's display; nothing changes if it is hidden. Errors are those of `show`."""
        self._set_display(what, on=False)

    def _set_display(self, what: Literal["panel", "map"], *, on: bool) -> None:
        world = self._world
        self._post(world.displays.show(world.tick, self.seat, Show(what=what, on=on)))

    def _post(self, events: Iterable[Event]) -> None:
        for event in events:
            if isinstance(event, Refused):
                raise HthorError(f"{self.seat}: {event.reason}")
        self._world.note(events)
