"""How a person reads a robot's message and answers it; knows nothing of where they are or of what they do meanwhile."""

from __future__ import annotations

import math

from hthor import seeds
from hthor.humans.parameters import Parameters
from hthor.types import Message, Reply

_SAME_M = 0.5


class Reader:
    """Notices, reads and answers messages, one after the other.

    ``message`` is the one that is shown, ``accepted`` the last that was confirmed; ``offered`` says whether any came.
    """

    def __init__(self, traits: Parameters, root: int, tick_s: float) -> None:
        self.traits, self.root, self.tick_s = traits, root, tick_s
        self.accepted: Message | None = None
        self.offered = False
        self.message: Message | None = None
        self._count = 0
        self._until = 0.0
        self._settled = -1

    @property
    def reading(self) -> bool:
        """Whether a message has come and is not dealt with."""
        return self.message is not None and self.message.id != self._settled

    def receive(self, tick: int, inbox: tuple[Message, ...]) -> None:
        """Look at the inbox; a message with the same content as the one being read is read on."""
        message = inbox[-1] if inbox else None
        if message is not None and (self.message is None or message.id != self.message.id):
            if not (self.reading and _same(message, self.message)):
                self._until = tick + self._duration() / self.tick_s
                self._count += 1
            self.offered = True
            self.message = message
        elif message is None:
            self.message = None

    def ready(self, tick: int) -> Message | None:
        """The message that was read and now wants an answer."""
        return self.message if self.reading and tick >= self._until else None

    def answer(self, message: Message, trust: float, useful: bool) -> Reply | None:
        """Confirm, decline, or None to leave it.

        Args:
            message: as `ready` gave it.
            trust: mean trust in the robots, 0 to 1.
            useful: whether the message could still help.
        """
        traits, number = self.traits, self._count
        self._settled = message.id
        logit = traits.a0 + traits.a_trust * (trust - 0.5)
        confirm = useful and self._draw("accept", number) < 1.0 / (1.0 + math.exp(-logit))
        if self._draw("slip", number) < traits.p_slip:
            confirm = not confirm
        elif not confirm and self._draw("ignore", number) < traits.p_ignore:
            return None
        if confirm:
            self.accepted = message
        return Reply(message=message.id, accept=confirm)

    def _duration(self) -> float:
        """Seconds that noticing and reading this message take."""
        return self.traits.t_read * math.exp(self.traits.read_sd * seeds.normal(self.root, "read", self._count))

    def _draw(self, what: str, number: int) -> float:
        return seeds.draw(self.root, what, number)


def _same(a: Message, b: Message | None) -> bool:
    if b is None or a.object != b.object:
        return False
    if a.position is None or b.position is None:
        return a.position is b.position and a.text == b.text
    return math.dist(a.position, b.position) < _SAME_M
