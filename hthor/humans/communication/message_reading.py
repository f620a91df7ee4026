"""How a person notices and reads robots' messages, one after the other."""

from __future__ import annotations

import math

from msgspec import Struct

from hthor import seeds
from hthor.humans.population.parameters import Parameters
from hthor.types import Message

_SAME_M = 0.5
WORDS, FEWEST = 12, 4
"""Words of the message that ``t_read`` is for, and of the shortest that is worth counting: a glance takes its time."""
KNOWN = 0.5
"""Share of that time for a text that was read before. Ours: people recognise it, and look for what is new."""


class Reading(Struct, kw_only=True):
    """A message and how it is dealt with.

    ``number`` counts the trial's messages from 1, for chance; ``since`` [tick] is when it was shown, ``noticed`` and
    ``until`` when reading begins and is over. ``again`` counts how often the same was refused before.
    """

    message: Message
    number: int
    since: int
    noticed: float
    until: float
    again: int = 0
    settled: bool = False

    @property
    def words(self) -> int:
        """How long it is."""
        return len(self.message.text.split())


class Reader:
    """Notices and reads what comes.

    People notice a message after a while, and read it then; both times are log-normal, with their own luck for each
    message. The same offer, of the same thing at about the same place, is read on when it replaces itself, and read
    faster when it comes again.

    ``now`` is the message that is shown, None without one; ``offered`` says whether any came.
    """

    def __init__(self, traits: Parameters, root: int, tick_s: float) -> None:
        self.traits, self.root, self.tick_s = traits, root, tick_s
        self.now: Reading | None = None
        self.offered = False
        self._count = 0
        self._read: list[Message] = []
        self._refused: list[Message] = []

    def receive(self, tick: int, inbox: tuple[Message, ...]) -> None:
        """Look at the inbox; a message with the same content as the one being read is read on."""
        message, now = inbox[-1] if inbox else None, self.now
        if message is None:
            self.now = None
        elif now is None or message.id != now.message.id:
            self.offered = True
            if now is not None and not now.settled and same(message, now.message):
                now.message = message
            else:
                self.now = self._begin(tick, message)

    def reads(self, tick: int) -> bool:
        """Whether the person is reading just now."""
        now = self.now
        return now is not None and not now.settled and tick >= now.noticed

    def ready(self, tick: int) -> Reading | None:
        """The message that was read and now wants an answer."""
        now = self.now
        return now if now is not None and not now.settled and tick >= now.until else None

    def settle(self, reading: Reading, accepted: bool) -> None:
        """The message was answered, or left; whatever comes of it, it is not new any more."""
        reading.settled = True
        self._read.append(reading.message)
        if not accepted:
            self._refused.append(reading.message)

    def _begin(self, tick: int, message: Message) -> Reading:
        self._count += 1
        number, traits = self._count, self.traits
        notice = traits.t_notice * self._luck("notice", number)
        read = traits.t_read * max(FEWEST, len(message.text.split())) / WORDS * self._luck("read", number)
        if any(same(message, old) for old in self._read):
            read *= KNOWN
        noticed = tick + notice / self.tick_s
        again = sum(same(message, old) for old in self._refused)
        until = noticed + read / self.tick_s
        return Reading(message=message, number=number, since=tick, noticed=noticed, until=until, again=again)

    def _luck(self, what: str, number: int) -> float:
        return math.exp(self.traits.read_sd * seeds.normal(self.root, what, number))


def same(a: Message, b: Message) -> bool:
    """Whether two messages say the same thing: of the same object, at about the same place."""
    if b.object != a.object:
        return False
    if a.position is None or b.position is None:
        return a.position is b.position and a.text == b.text
    return math.dist(a.position, b.position) < _SAME_M
