"""The mailbox of a trial: robots write to people, and people to robots and to one another.

Every person has one panel. A message is first "sent", then "shown" to each person that it is for, and ends there as
"accepted", "declined" or "covered"; one that is never answered stays sent or shown. At most one message is open on a
panel: a newer one, from anybody, covers it. Robots have no panel: a message to a robot is "shown" when the robot has
observed it. A question ends as "answered", by a yes or no on the panel or by a message that answers it; until then it
stays in the inbox, unless its sender asks the same seat something else, which covers it.
"""

import math
import unicodedata
from collections.abc import Iterable, Sequence
from typing import Any

from msgspec import Struct

from hthor import rules
from hthor.types import HUMAN, Message, Receipt, Reply, Send, Status, Vec3
from hthor.types.events import Accepted, Answered, Covered, Declined, Event, Refused, Sent, Shown
from hthor.types.observations import ImageSource

_OPEN = ("sent", "shown")
_NAME_MAX = 80
"""How many characters the name of a message's object may have."""
_READ_FACTOR = 8
"""A text is read only up to this many times the limit, so that a very long text costs no more."""


class MailboxState(Struct, frozen=True):
    """A copy of everything in a mailbox, from `Mailbox.save_state`."""

    messages: tuple[Message, ...]
    deliveries: dict[tuple[int, str], Receipt]
    inboxes: dict[str, tuple[int, ...]]
    receipts: dict[str, Receipt]
    new_mail: frozenset[str]
    new_receipts: frozenset[str]


class Mailbox:
    """Keeps every message of a trial, and its status for each seat that it is for.

    It never raises: an invalid message or reply is refused, with a reason.

    Args:
        robots: the seats of the robots. people: the seats of the people.
    """

    def __init__(self, robots: Sequence[str], people: Sequence[str] = (HUMAN,)) -> None:
        self._people, self._robots = tuple(people), tuple(robots)
        self.load_state(MailboxState((), {}, dict.fromkeys((*people, *robots), ()), {}, frozenset(), frozenset()))

    def send(self, tick: int, sender: str, send: Send, image: ImageSource = None) -> tuple[Event, ...]:
        """Put a message in the inboxes of those that it is for.

        Args:
            image: renders the sender's own frame of this tick when called; it is not called here.

        Returns:
            "answered" for the question that it answers, "covered" for every message that it covers, then "sent"; or one
            "refused" with its reason.
        """
        reason = self._send_refusal(sender, send)
        if reason:
            return (self._refused(tick, sender, reason),)
        number, readers = len(self._messages), self._readers(sender, send)
        events: list[Event] = [] if send.answers is None else [self._answered(tick, send.answers, sender)]
        for reader in readers:
            events += self._cover(tick, sender, reader, number, send.question)
        text, cut = clean_text(send.text, rules.TEXT_MAX)
        name, _ = clean_text(send.object, _NAME_MAX)
        position = None if send.position is None else parse_point(send.position)
        message = Message(
            id=number,
            sender=sender,
            tick=tick,
            text=text,
            object=name,
            position=position,
            image=image,
            to=send.to if send.answers is None else readers[0],
            question=send.question,
            answers=send.answers,
        )
        self._messages.append(message)
        for reader in readers:
            self._deliveries[number, reader] = Receipt(message=number, status="sent", tick=tick, by=reader)
            self._inboxes[reader] = (*self._inboxes[reader], number)
            self._new_mail.add(reader)
        self._receipts[sender] = self._deliveries[number, readers[0]]
        self._new_receipts.add(sender)
        return (*events, _sent(message, cut))

    def inbox(self, seat: str) -> tuple[Message, ...]:
        """A person's open message; a robot's new messages and its open questions. Reading it resets `changed`."""
        self._new_mail.discard(seat)
        inbox = self._inboxes.get(seat)
        return tuple(self._messages[number] for number in inbox) if inbox else ()

    def shown(self, tick: int, seat: str = HUMAN) -> tuple[Event, ...]:
        """Record that the seat was shown its inbox; messages that ask a robot for nothing leave it."""
        inbox = self._inboxes[seat]
        unread = [number for number in inbox if self._deliveries[number, seat].status == "sent"]
        if seat in self._robots:
            self._inboxes[seat] = tuple(number for number in inbox if self._messages[number].question)
        for number in unread:
            self._set_status(tick, number, seat, "shown")
        return tuple(Shown(tick=tick, seat=seat, message=number, sender=self._sender(number)) for number in unread)

    def reply(self, tick: int, seat: str, reply: Reply) -> tuple[Event, ...]:
        """Record a person's answer: "accepted", "declined", "answered" for a question; or "refused", with a reason."""
        reason = self._reply_refusal(seat, reply)
        if reason:
            return (self._refused(tick, seat, reason, message=reply.message),)
        number = reply.message
        if self._messages[number].question:
            return (self._answered(tick, number, seat, reply.accept),)
        self._set_status(tick, number, seat, "accepted" if reply.accept else "declined")
        answer = Accepted if reply.accept else Declined
        return (answer(tick=tick, seat=seat, message=number, sender=self._sender(number)),)

    def message(self, number: int) -> Message:
        """The message with this number."""
        return self._messages[number]

    def receipt(self, seat: str) -> Receipt | None:
        """The latest status of this seat's last message, None before its first. Reading it resets `changed`."""
        self._new_receipts.discard(seat)
        return self._receipts.get(seat)

    def changed(self, seat: str) -> bool:
        """Whether the seat's inbox or receipt has changed since the seat last read it."""
        return seat in self._new_mail or seat in self._new_receipts

    @property
    def messages(self) -> tuple[tuple[Message, Receipt], ...]:
        """Every message sent so far, with its status for each seat that it is for."""
        return tuple((self._messages[number], receipt) for (number, _), receipt in self._deliveries.items())

    def save_state(self) -> MailboxState:
        """A copy of everything in the mailbox."""
        return MailboxState(
            tuple(self._messages),
            dict(self._deliveries),
            dict(self._inboxes),
            dict(self._receipts),
            frozenset(self._new_mail),
            frozenset(self._new_receipts),
        )

    def load_state(self, state: MailboxState) -> None:
        """Continue from a copy of this mailbox or of another one with the same seats."""
        self._messages = list(state.messages)
        self._deliveries, self._inboxes = dict(state.deliveries), dict(state.inboxes)
        self._receipts = dict(state.receipts)
        self._new_mail, self._new_receipts = set(state.new_mail), set(state.new_receipts)

    def _readers(self, sender: str, send: Send) -> tuple[str, ...]:
        """The seats that a message is for, in order."""
        if send.to:
            return (send.to,)
        if send.answers is not None:
            return (self._messages[send.answers].sender,)
        everybody = self._people if sender in self._robots else (*self._people, *self._robots)
        return tuple(seat for seat in everybody if seat != sender)

    def _sender(self, number: int) -> str:
        return self._messages[number].sender

    def _answered(self, tick: int, number: int, seat: str, yes: bool | None = None) -> Answered:
        """Record that the seat answered a question; ``yes`` is None if its answer is a message."""
        self._set_status(tick, number, seat, "answered", yes)
        return Answered(tick=tick, seat=seat, message=number, sender=self._sender(number), yes=yes)

    def _cover(self, tick: int, sender: str, reader: str, by: int, question: bool) -> Iterable[Covered]:
        """Take away what a new message covers: a person's open message, a robot's open question of the same sender."""
        named = reader if len(self._people) > 1 else ""
        for number in self._inboxes[reader]:
            asked = self._sender(number)
            same = question and self._messages[number].question and asked == sender
            if reader in self._people or same:
                self._set_status(tick, number, reader, "covered")
                yield Covered(tick=tick, seat=sender, message=number, sender=asked, by=by, reader=named)

    def _set_status(self, tick: int, number: int, reader: str, status: Status, yes: bool | None = None) -> None:
        """Move a message on to its next status for one reader."""
        receipt = Receipt(message=number, status=status, tick=tick, by=reader, yes=yes)
        self._deliveries[number, reader] = receipt
        if status not in _OPEN:
            self._inboxes[reader] = tuple(other for other in self._inboxes[reader] if other != number)
        sender = self._sender(number)
        if self._receipts[sender].message == number:
            self._receipts[sender] = receipt
            self._new_receipts.add(sender)

    def _send_refusal(self, sender: str, send: Send) -> str:
        seats = (*self._people, *self._robots)
        if sender not in seats:
            return f"{sender} is no seat of this trial; its seats are {', '.join(seats)}"
        to: Any = send.to
        if not isinstance(to, str) or (to and (to not in seats or to == sender)):
            return f"'{to}' is no other seat of this trial; its seats are {', '.join(seats)}"
        written: tuple[Any, ...] = (send.text, send.object)
        if not all(isinstance(part, str) for part in written):
            return "text and object must be str"
        if send.position is not None and parse_point(send.position) is None:
            return "position must be None or three finite numbers x, y, z in metres of the house frame"
        question: Any = send.question
        if not isinstance(question, bool):
            return "question must be a bool"
        if send.answers is not None and (reason := self._answer_refusal(sender, send)):
            return reason
        readers = self._readers(sender, send)
        if not readers:
            return "nobody else is in this trial"
        return "robots write to people only" if sender in self._robots and readers[0] in self._robots else ""

    def _answer_refusal(self, sender: str, send: Send) -> str:
        number: Any = send.answers
        if not _is_number(number) or not 0 <= number < len(self._messages):
            return "there is no such question"
        question = self._messages[number]
        if not question.question or (number, sender) not in self._deliveries:
            return f"message {number} is no question to {sender}"
        if send.to not in ("", question.sender):
            return f"message {number} was asked by {question.sender}, not by {send.to}"
        status = self._deliveries[number, sender].status
        return "" if status in _OPEN else f"the question is already {status}"

    def _reply_refusal(self, seat: str, reply: Reply) -> str:
        if seat not in self._people:
            return "only people reply; a robot answers with a message"
        number: Any = reply.message
        if not _is_number(number) or not isinstance(reply.accept, bool):
            return "message must be a number and accept a bool"
        if (number, seat) not in self._deliveries:
            return "there is no such message"
        status = self._deliveries[number, seat].status
        return "" if status in _OPEN else f"the message is already {status}"

    @staticmethod
    def _refused(tick: int, seat: str, reason: str, message: Any = None) -> Refused:
        number = message if _is_number(message) else None
        return Refused(tick=tick, seat=seat, reason=reason, message=number)


def _sent(message: Message, cut: int) -> Sent:
    """The event that a message was sent; ``cut`` is how many characters its text lost."""
    return Sent(
        tick=message.tick,
        seat=message.sender,
        message=message.id,
        text=message.text,
        object=message.object,
        position=_to_millimetre(message.position),
        to=message.to,
        question=message.question,
        answers=message.answers,
        cut=cut,
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _to_millimetre(position: Vec3 | None) -> Vec3 | None:
    if position is None:
        return None
    x, y, z = position
    return round(x, 3), round(y, 3), round(z, 3)


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
