"""The mailbox of a trial: robots send messages, the person accepts or declines them.

A message is first "sent", then "shown" to the person, and ends as "accepted" (accepted), "declined" or "covered"; a
message that is never answered stays sent or shown. At most one message is open: a new one, from any robot, covers it.
"""

import math
import unicodedata
from collections.abc import Sequence
from typing import Any

from hthor import rules
from hthor.types import HUMAN, Event, Message, Receipt, Reply, Send, Status, Vec3
from hthor.types.observations import ImageSource

_OPEN = ("sent", "shown")
_NAME_MAX = 80
"""How many characters the name of a message's object may have."""
_READ_FACTOR = 8
"""A text is read only up to this many times the limit, so that a very long text costs no more."""


class Mailbox:
    """Keeps every message that the seats ``robots`` send in a trial.

    It never raises: an invalid message or reply is refused, with a reason.
    """

    def __init__(self, robots: Sequence[str]) -> None:
        self._robots = tuple(robots)
        self._messages: list[Message] = []
        self._status: list[Receipt] = []
        self._last: dict[str, int] = {}
        self._changed: set[str] = set()

    def send(self, tick: int, sender: str, send: Send, image: ImageSource = None) -> tuple[Event, ...]:
        """Put a message in the person's inbox; it covers the open message.

        Args:
            image: renders the sender's own frame of this tick when called; it is not called here.

        Returns:
            "covered" for the message that was open, then "sent"; or one "refused" with its reason.
        """
        reason = self._send_refusal(sender, send)
        if reason:
            return (self._refused(tick, sender, reason),)
        events = self._cover(tick, sender)
        number = len(self._messages)
        written, cut = clean_text(send.text, rules.TEXT_MAX)
        name, _ = clean_text(send.object, _NAME_MAX)
        position = None if send.position is None else parse_point(send.position)
        self._messages.append(
            Message(id=number, sender=sender, tick=tick, text=written, object=name, position=position, image=image)
        )
        self._status.append(Receipt(message=number, status="sent", tick=tick))
        self._last[sender] = number
        self._changed.update((HUMAN, sender))
        data: dict[str, Any] = {"message": number, "text": written, "object": name, "position": _plain(position)}
        if cut:
            data["cut"] = cut
        return (*events, Event(tick=tick, seat=sender, kind="sent", data=data))

    def inbox(self, seat: str) -> tuple[Message, ...]:
        """The open message, for the person; empty for robots. Reading it resets `changed`."""
        if seat != HUMAN:
            return ()
        self._changed.discard(seat)
        number = self._open()
        return () if number is None else (self._messages[number],)

    def shown(self, tick: int) -> tuple[Event, ...]:
        """Record that the person was shown the inbox."""
        number = self._open()
        if number is None or self._status[number].status != "sent":
            return ()
        return (self._set_status(tick, number, "shown", HUMAN),)

    def reply(self, tick: int, seat: str, reply: Reply) -> tuple[Event, ...]:
        """Record the person's answer: "accepted" (accepted) or "declined"; or "refused", with a reason."""
        reason = self._reply_refusal(seat, reply)
        if reason:
            return (self._refused(tick, seat, reason, message=reply.message),)
        return (self._set_status(tick, reply.message, "accepted" if reply.accept else "declined", seat),)

    def receipt(self, seat: str) -> Receipt | None:
        """The status of this robot's last message, None before its first. Reading it resets `changed`."""
        number = self._last.get(seat)
        if number is None:
            return None
        self._changed.discard(seat)
        return self._status[number]

    def changed(self, seat: str) -> bool:
        """Whether the person's inbox, or the robot's receipt, has changed since this seat last read it."""
        return seat in self._changed

    @property
    def messages(self) -> tuple[tuple[Message, Receipt], ...]:
        """Every message sent so far, with its status."""
        return tuple(zip(self._messages, self._status, strict=True))

    def _open(self) -> int | None:
        number = len(self._messages) - 1
        return number if number >= 0 and self._status[number].status in _OPEN else None

    def _cover(self, tick: int, sender: str) -> tuple[Event, ...]:
        number = self._open()
        if number is None:
            return ()
        return (self._set_status(tick, number, "covered", sender, by=number + 1),)

    def _set_status(self, tick: int, number: int, status: Status, seat: str, **more: int) -> Event:
        """Move a message on to its next status."""
        self._status[number] = Receipt(message=number, status=status, tick=tick)
        sender = self._messages[number].sender
        if self._last[sender] == number:
            self._changed.add(sender)
        return Event(tick=tick, seat=seat, kind=status, data={"message": number, "sender": sender, **more})

    def _send_refusal(self, sender: str, send: Send) -> str:
        if sender not in self._robots:
            return f"only robots send messages, this trial's are: {', '.join(self._robots) or 'none'}"
        written: tuple[Any, Any] = (send.text, send.object)
        if not all(isinstance(part, str) for part in written):
            return "text and object must be str"
        if send.position is not None and parse_point(send.position) is None:
            return "position must be None or three finite numbers x, y, z in metres of the house frame"
        return ""

    def _reply_refusal(self, seat: str, reply: Reply) -> str:
        if seat != HUMAN:
            return "only the person replies"
        number: Any = reply.message
        if not isinstance(number, int) or isinstance(number, bool) or not isinstance(reply.accept, bool):
            return "message must be a number and accept a bool"
        if not 0 <= number < len(self._messages):
            return "there is no such message"
        status = self._status[number].status
        return "" if status in _OPEN else f"the message is already {status}"

    @staticmethod
    def _refused(tick: int, seat: str, reason: str, message: object = None) -> Event:
        number = message if isinstance(message, int) else None
        data = {"reason": reason} if number is None else {"reason": reason, "message": number}
        return Event(tick=tick, seat=seat, kind="refused", data=data)


def _plain(position: Vec3 | None) -> list[float] | None:
    """A position for the log, to the millimetre."""
    return None if position is None else [round(number, 3) for number in position]


def clean_text(text: str, limit: int) -> tuple[str, int]:
    """The text on one line, without control and formatting characters, at most ``limit`` characters long.

    Returns:
        the text, and how many characters were cut from its end.
    """
    seen = text[: limit * _READ_FACTOR]
    spaced = "".join(" " if char.isspace() else char for char in seen)
    plain = " ".join("".join(char for char in spaced if unicodedata.category(char)[0] != "C").split())
    plain = unicodedata.normalize("NFC", plain)
    kept = plain[:limit].rstrip()
    return kept, len(plain) - len(kept) + len(text) - len(seen)


def parse_point(value: Any) -> Vec3 | None:
    """The three finite numbers of a position as plain floats, or None for any other value."""
    if isinstance(value, (str, bytes)) or not (isinstance(value, Sequence) or hasattr(value, "__array__")):
        return None
    try:
        x, y, z = (float(number) for number in value)
    except (TypeError, ValueError, OverflowError):
        return None
    return (x, y, z) if math.isfinite(x) and math.isfinite(y) and math.isfinite(z) else None
