"""Events of the mailbox: what became of each message."""

from typing import Literal

from msgspec import UNSET, UnsetType

from hthor.types.events.entry import LogEntry
from hthor.types.house import Vec3


class Sent(LogEntry, frozen=True, kw_only=True, tag="sent"):
    """The seat sent a message. `Answered` and `Covered`, for the messages that it answers and covers, come before.

    Attributes:
        message: its number in the trial, from 0.
        text: its words, on one line, at most `rules.TEXT_MAX` characters.
        object: id or kind of the thing that it is about, empty for none.
        position: [m], house frame, to the millimetre, where the sender believes that thing to be.
        to: the seat that it is for, empty if it is for everybody that the sender may write to.
        question: whether it asks for an answer.
        answers: the number of the question that it answers.
        cut: how many characters were cut from the end of its text.
        off: [m] distance from the claimed to the nearest true position when it was sent, see `hthor.comms.claims`; null
            if there is no such thing at all, absent if the message claims nothing.
    """

    message: int
    text: str
    object: str = ""
    position: Vec3 | None = None
    to: str = ""
    question: bool = False
    answers: int | None = None
    cut: int = 0
    off: float | UnsetType | None = UNSET


class Shown(LogEntry, frozen=True, kw_only=True, tag="shown"):
    """The seat saw a message for the first time.

    Attributes:
        message: its number.
        sender: the seat that sent it.
    """

    message: int
    sender: str


class Accepted(LogEntry, frozen=True, kw_only=True, tag="accepted"):
    """The person in the seat accepted a message.

    Attributes:
        message: its number.
        sender: the seat that sent it.
    """

    message: int
    sender: str


class Declined(LogEntry, frozen=True, kw_only=True, tag="declined"):
    """The person in the seat declined a message.

    Attributes:
        message: its number.
        sender: the seat that sent it.
    """

    message: int
    sender: str


class Covered(LogEntry, frozen=True, kw_only=True, tag="covered"):
    """The seat sent a newer message, and an older one that was still open is not shown any more.

    Attributes:
        message: the number of the older message.
        sender: the seat that had sent it.
        by: the number of the newer message.
        reader: the seat that the older message was for, in trials with several people.
    """

    message: int
    sender: str
    by: int
    reader: str = ""


class Answered(LogEntry, frozen=True, kw_only=True, tag="answered"):
    """The seat answered a question.

    Attributes:
        message: the number of the question.
        sender: the seat that asked it.
        yes: the answer; absent if the answer is a message, the next `Sent`.
    """

    message: int
    sender: str
    yes: bool | None = None


class Displayed(LogEntry, frozen=True, kw_only=True, tag="displayed"):
    """The person in the seat showed or hid a part of their display.

    What the display does by itself has no event of its own: the panel is shown from `Sent` of a message for the person
    until their answer, and the map from their first `Accepted` on. `hthor.comms.display` works out when each was shown.

    Attributes:
        what: "panel" or "map".
        on: whether it is shown from this tick on, or hidden.
        message: the number of the message on the panel; for the map, of the message confirmed last.
    """

    what: Literal["panel", "map"]
    on: bool
    message: int


MessageEvent = Shown | Accepted | Declined | Covered | Answered
"""What became of a message."""
