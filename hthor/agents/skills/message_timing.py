"""When to send a message for the first time or again, and its text."""

import math
from collections.abc import Mapping, Sequence

from hthor.types import Briefing, Detection, Observation, Receipt

AGAIN_S = 10.0
"""Pause after a message that was declined or replaced by a newer one [s]."""
ASIDE_M = 2.0
"""How far from furniture a robot waits [m]: a person who opens a fridge needs the floor in front of it."""
APART_M = 1.3
"""How far from the target a robot waits [m]: out of the person's way, and close enough to see it."""
_HOLLOW = ("bathtub", "fridge", "garbage_can", "sink")


class MessageTiming:
    """Decides when to send messages about one thing: once, and again some time after a message was declined.

    Args:
        most: the largest number of messages.
        repeat_s: time after which a message is sent again whatever became of it [s].
    """

    def __init__(self, briefing: Briefing, most: int, repeat_s: float = math.inf) -> None:
        self.most, self.sent = most, 0
        self._again, self._repeat = round(AGAIN_S / briefing.tick_s), repeat_s / briefing.tick_s
        self._mark = 0

    def due(self, tick: int, receipt: Receipt | None) -> bool:
        """Whether a message is due, given the receipt of the last message."""
        if self.sent == 0:
            return True
        if self.sent >= self.most or tick < self._mark + self._again:
            return False
        if tick >= self._mark + self._repeat:
            return True
        if receipt is None:
            return False
        return receipt.status in ("declined", "covered") and tick >= receipt.tick + self._again

    def note(self, tick: int) -> None:
        """Note that a message was sent at this tick."""
        self.sent, self._mark = self.sent + 1, tick


def kind_title(kind: str) -> str:
    """A kind's name in a sentence, such as "the dining table"."""
    return "the " + kind.replace("_", " ")


def place_phrase(kind: str) -> str:
    """Where something is that lies on or in a thing of this kind, such as "on the dining table"."""
    return f"{'in' if kind in _HOLLOW else 'on'} {kind_title(kind)}"


def sighting_text(seen: Detection, kinds: Mapping[str, str]) -> str:
    """The text about an object in view; ``kinds`` gives the kind of each piece of furniture the robot knows."""
    where = f" {place_phrase(kinds[seen.support])}" if seen.support in kinds else ""
    return f"I found {kind_title(seen.kind)}{where} in front of me."


def find_detection(observation: Observation, name: str) -> Detection | None:
    """The object of this id, when it is in view."""
    return next((seen for seen in observation.detections if seen.id == name and seen.family == "object"), None)


def look_inside_text(kind: str, wanted: Sequence[str]) -> str:
    """The request of a robot that cannot open the thing of this ``kind``, to look inside for ``wanted`` kinds."""
    things = " and ".join(dict.fromkeys(kind_title(name) for name in wanted))
    return f"I cannot open {kind_title(kind)} in front of me. Please look inside for {things}."


def help_carry_text(kind: str, held: bool) -> str:
    """The request to help carry a thing of this kind; ``held``: the robot has one end already."""
    return f"Please help me carry {kind_title(kind)}: {'I have one end' if held else 'take one end, I take the other'}."
