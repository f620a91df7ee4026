"""How a participant notices and reads messages, one after the other."""

import math

from msgspec import Struct

from hthor import seeds
from hthor.humans.population.parameters import Parameters
from hthor.types import Message, is_person

REFERENCE_WORDS = 12
"""[words] Length of a message that takes ``t_read`` to read. Our choice."""
LEAST_WORDS = 4
"""[words] Shorter messages take as long as one of this length. Our choice: even a glance takes time."""
REREADING_SHARE = 0.5
"""[share] Part of the reading time for a text read before. Our choice: people recognise it, and look for changes."""
_SAME_M = 0.5
"""[m] Messages about the same object at positions this close say the same. Our choice."""


class Reading(Struct, kw_only=True):
    """A message, and how far the participant is with it.

    ``number`` counts the trial's messages from 1; ``since`` is the tick when it was shown, ``noticed`` and ``until``
    when reading begins and ends. ``again`` counts how often the same message was refused before.
    """

    message: Message
    number: int
    since: int
    noticed: float
    until: float
    again: int = 0
    answered: bool = False

    @property
    def words(self) -> int:
        """Length of the message [words]."""
        return len(self.message.text.split())


class MessageReader:
    """Notices and reads messages.

    The times of noticing and reading are log-normal, drawn for each message. When an equal message replaces a message,
    reading goes on; a message that was read before is read faster.

    ``now`` is the message on display, None when there is none; ``offered`` says whether any robot's message came that
    is an offer.
    """

    def __init__(self, traits: Parameters, root: int, tick_s: float) -> None:
        self.traits, self.root, self.tick_s = traits, root, tick_s
        self.now: Reading | None = None
        self.offered = False
        self._count = 0
        self._read: list[Message] = []
        self._refused: list[Message] = []

    def receive(self, tick: int, inbox: tuple[Message, ...]) -> None:
        """Look at the ``inbox``; its last message is on display."""
        message, now = inbox[-1] if inbox else None, self.now
        if message is None:
            self.now = None
        elif now is None or message.id != now.message.id:
            self.offered = self.offered or is_offer(message)
            if now is not None and not now.answered and is_same_message(message, now.message):
                now.message = message
            else:
                self.now = self._begin(tick, message)

    def is_reading(self, tick: int) -> bool:
        """Whether a message is being read at this tick."""
        now = self.now
        return now is not None and not now.answered and tick >= now.noticed

    def ready(self, tick: int) -> Reading | None:
        """The message that was read and now needs an answer."""
        now = self.now
        return now if now is not None and not now.answered and tick >= now.until else None

    def mark_answered(self, reading: Reading, accepted: bool) -> None:
        """Note that a message was answered or ignored, so that it is not new any more."""
        self.mark_read(reading)
        if not accepted:
            self._refused.append(reading.message)

    def mark_read(self, reading: Reading) -> None:
        """Note that a message was read that is not accepted or declined, so that it is not new any more."""
        reading.answered = True
        self._read.append(reading.message)

    def _begin(self, tick: int, message: Message) -> Reading:
        self._count += 1
        number, traits = self._count, self.traits
        notice = traits.t_notice * self._spread("notice", number)
        words = max(LEAST_WORDS, len(message.text.split()))
        read = traits.t_read * words / REFERENCE_WORDS * self._spread("read", number)
        if any(is_same_message(message, old) for old in self._read):
            read *= REREADING_SHARE
        noticed = tick + notice / self.tick_s
        again = sum(is_same_message(message, old) for old in self._refused)
        until = noticed + read / self.tick_s
        return Reading(message=message, number=number, since=tick, noticed=noticed, until=until, again=again)

    def _spread(self, what: str, number: int) -> float:
        return math.exp(self.traits.read_sd * seeds.normal(self.root, what, number))


def is_remark(message: Message) -> bool:
    """Whether a message only tells something: from a person, or in answer to a question, and without a place."""
    return message.position is None and (is_person(message.sender) or message.answers is not None)


def is_offer(message: Message) -> bool:
    """Whether a message is a robot's offer of help, not a question or a remark."""
    return not (message.question or is_person(message.sender) or is_remark(message))


def is_same_message(a: Message, b: Message) -> bool:
    """Whether two messages say the same: about the same object, at about the same place."""
    if b.object != a.object:
        return False
    if a.position is None or b.position is None:
        return a.position is b.position and a.text == b.text
    return math.dist(a.position, b.position) < _SAME_M
